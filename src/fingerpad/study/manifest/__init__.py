"""The study manifest: a TOML file that says what was observed, and where images, sequences and curves lie."""
