"""A study: from its manifest to one row per observation and one summary per finger and angle."""
