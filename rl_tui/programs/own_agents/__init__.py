"""Users' agents without a loop: their shapes, and the loop around them."""
