"""Users' agents without a loop: their common shapes, and the loop around them."""
