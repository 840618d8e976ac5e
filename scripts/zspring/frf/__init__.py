"""First-order FRF by stepped sine with controlled response."""
