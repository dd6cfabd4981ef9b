"""The panel of sliders and settings."""
