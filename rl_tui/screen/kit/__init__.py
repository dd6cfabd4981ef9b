"""Base classes and shared parts of panels."""
