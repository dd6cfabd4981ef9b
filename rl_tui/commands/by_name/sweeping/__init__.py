"""Commands for many settings at once, and for pictures of what came of them."""
