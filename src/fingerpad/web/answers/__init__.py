"""What the API answers: the models behind the OpenAPI document and the types of the page's scripts.

Every key is required, so that the page finds what the types promise; what may be missing is null. Lengths of
a picture are pairs (row, column) in pixels.
"""
