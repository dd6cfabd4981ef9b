"""The panel of a lesson: its pages, questions and progress."""
