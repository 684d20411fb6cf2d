"""Changing a study by program: its manifest, drafts of what is not complete, and what it still lacks."""
