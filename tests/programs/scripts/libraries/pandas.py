"""Nothing of it is really done."""

from drawn import Drawn


def __getattr__(name):
    return getattr(Drawn(), name)
