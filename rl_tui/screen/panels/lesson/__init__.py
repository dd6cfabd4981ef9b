"""The lesson beside the world: its pages, what they ask, and how that stands."""
