"""Whether Hertz theory holds for a finger at an angle, and what the model adds to the uncertainty."""
