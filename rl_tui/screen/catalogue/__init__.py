"""The catalogue of scenarios and saved sessions."""
