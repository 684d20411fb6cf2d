"""What a study comes to: rows, summaries, and the files that hold them."""
