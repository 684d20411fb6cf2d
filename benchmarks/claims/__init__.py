"""Tables of the documentation, one module each."""
