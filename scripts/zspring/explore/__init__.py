"""The models as WebAssembly and what hosts them in a browser or node: JavaScript that is no part of the Python."""
