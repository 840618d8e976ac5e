"""Where the rods stick, slide partly and slide all along: a map over frequency and amplitude."""
