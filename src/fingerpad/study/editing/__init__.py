"""Changing a study by program: its manifest and spreadsheet, and what it still lacks."""
