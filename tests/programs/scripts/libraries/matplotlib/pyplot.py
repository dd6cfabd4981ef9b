"""Where most scripts draw."""

from drawn import Drawn, subplots

__all__ = ["subplots"]


def __getattr__(name):
    return getattr(Drawn(), name)
