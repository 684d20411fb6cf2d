"""The bench: a local web page, and the JSON API under it, on which a lab measures, corrects and reads its study.

A face of the library: it asks `study`, `image`, `geometry` and `report`, and measures or computes nothing itself.
"""
