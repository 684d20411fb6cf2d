"""Doing tasks: in this process, in several, on many machines; and keeping what they give."""
