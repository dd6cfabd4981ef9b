"""What the actions and observations of well-known environments are called.

Gymnasium numbers them and names them only in its documentation. A class is known by its name, so that nothing
of Gymnasium need be imported.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Final

_ACTIONS: Final[Mapping[str, tuple[str, ...]]] = {
    "BlackjackEnv": ("stick", "hit"),
    "CartPoleEnv": ("left", "right"),
    "MountainCarEnv": ("left", "coast", "right"),
    "AcrobotEnv": ("-1", "0", "+1"),
}
# by part of an observation; empty: the part's own numbers
_PARTS: Final[Mapping[str, tuple[tuple[str, ...], ...]]] = {"BlackjackEnv": ((), (), ("no", "yes"))}
_TERMS: Final[Mapping[str, tuple[str, ...]]] = {
    "BlackjackEnv": ("sum", "dealer", "usable ace"),
    "CartPoleEnv": ("position", "velocity", "angle", "angular velocity"),
    "MountainCarEnv": ("position", "velocity"),
}


def action_names(environment: Any, first: int, actions: int) -> tuple[str, ...]:
    """Return the names of the ``actions`` of an unwrapped environment; their numbers if it is unknown."""
    names = _ACTIONS.get(type(environment).__name__, ())
    return names if len(names) == actions else tuple(str(first + action) for action in range(actions))


def told_part_names(environment: Any, sizes: Sequence[int]) -> Sequence[Sequence[str]]:
    """Return names for the parts of an observation, of so many values each; empty where none are known."""
    names = _PARTS.get(type(environment).__name__, ())
    fits = len(names) == len(sizes) and all(
        not part or len(part) == size for part, size in zip(names, sizes, strict=True)
    )
    return names if fits else [()] * len(sizes)


def part_terms(environment: Any) -> Sequence[str]:
    """Return what the parts of an observation are; empty where that is not known."""
    return _TERMS.get(type(environment).__name__, ())
