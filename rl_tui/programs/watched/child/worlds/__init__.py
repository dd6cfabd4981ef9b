"""Worlds of a program's own: classes with reset and step that are not environments of Gymnasium."""
