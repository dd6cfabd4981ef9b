"""The microscope: the last step in detail."""
