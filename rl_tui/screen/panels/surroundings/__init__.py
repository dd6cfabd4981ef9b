"""What is drawn around a map that is no place: labels of rows and columns, and a body above it."""
