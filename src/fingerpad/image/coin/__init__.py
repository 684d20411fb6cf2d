"""Find a coin of known diameter in a picture."""
