"""What people decide about what the program measured: kept with who and when, and applied."""
