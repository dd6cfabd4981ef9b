"""What of results is drawn: curves of training, and the cells of a sweep."""
