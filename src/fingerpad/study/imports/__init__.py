"""Files from elsewhere: what new ones are and what is stated of them, and ellipses of other programs."""
