"""Co-simulation of one or two pantographs with a catenary."""
