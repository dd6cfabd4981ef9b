"""Refusing environments that are too large for tables, before anything of their size is made."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

from rl_tui.common.limits import MOST_ACTIONS, MOST_PAIRS, MOST_STATES
from rl_tui.worlds.sections.world_section import WorldRefusedError

_FAR_TOO_MANY: Final = 10**15


def combinations(sizes: Iterable[int]) -> int:
    """Return how many combinations parts of these sizes have; of more than 10^15 it stops counting."""
    product = 1
    for size in sizes:
        product *= size
        if product > _FAR_TOO_MANY:
            break
    return product


def check_sizes(name: str, states: int, actions: int, key: str) -> None:
    """Raise WorldRefusedError, at ``key``, where the environment ``name`` has too many states or actions."""
    for what, count, most in (
        ("states", states, MOST_STATES),
        ("actions", actions, MOST_ACTIONS),
        ("pairs of a state and an action", states * actions, MOST_PAIRS),
    ):
        if count > most:
            number = f"{count:,}" if count < _FAR_TOO_MANY else "more than 10^15"
            found = f"{number} {what} of {name}"
            raise WorldRefusedError((key,), found, f"at most {most:,}")
