"""Agents that people write, without a loop: the shapes they are taught in, and the loop around them."""
