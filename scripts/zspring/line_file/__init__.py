"""An overhead line as a file: its form, the table that the catenary reads, and the command `zspring line`."""
