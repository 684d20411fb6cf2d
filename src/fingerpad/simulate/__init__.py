"""Render pictures of known truth."""
