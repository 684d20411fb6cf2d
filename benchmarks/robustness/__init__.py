"""Damaged files, kills, full disks, and mutants of the code."""
