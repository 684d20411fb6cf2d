"""A local page, and the API under it, on which a lab measures, corrects and reads its study.

A face of the library: it asks `study`, `image`, `geometry` and `report`, and computes nothing itself.
"""
