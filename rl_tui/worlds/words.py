"""Words that every room writes alike."""

from __future__ import annotations


def counted(count: int, thing: str) -> str:
    """Return how many things there are: ``1 step``, ``1,200 steps``."""
    return f"{count:,} {thing}{'' if count == 1 else 's'}"
