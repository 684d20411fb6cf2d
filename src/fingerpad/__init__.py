"""Contact mechanics of the human finger pad."""

__version__ = "0.1.0"
