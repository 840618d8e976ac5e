"""The published claims about the pantograph, one command each."""
