"""Simulators that share no model with the library: what they draw is known exactly."""
