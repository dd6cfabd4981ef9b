"""The microscope: the last step taken apart."""
