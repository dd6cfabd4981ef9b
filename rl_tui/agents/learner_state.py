"""All that a learner is at one step, to come back to."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.agents.kernels.stop import Stop
from rl_tui.agents.last_step import Author
from rl_tui.worlds.mdp.space import FiniteSpace

Arrays = tuple[Any, ...]


class Planned(NamedTuple):
    """How many of the steps and of the episodes so far were a planner's: backups and sweeps."""

    steps: int
    sweeps: int


@dataclass(frozen=True, slots=True, eq=False)
class LearnerState:
    """All that a learner is at one step; the arrays are copies, but for those of the world, ``space``.

    Of an array of the memory only the beginning may be there: see :func:`put_back`.
    """

    space: FiniteSpace
    algorithm: str
    hyperparameters: Hyperparameters
    memory: Arrays
    rule: Arrays
    drift: Arrays
    position: Arrays
    record: Arrays
    streams: tuple[Any, ...]
    planned: Planned
    author: Author
    came_to_rest: bool
    world_since: int
    stop: Stop

    @property
    def nbytes(self) -> int:
        """How much memory the copies take."""
        parts = (self.memory, self.rule, self.drift, self.position, self.record)
        return sum(array.nbytes for part in parts for array in part)


def arrays_of(parts: Iterable[Any]) -> Arrays:
    """Return those of ``parts`` that are arrays: what a policy has learned."""
    return tuple(part for part in parts if isinstance(part, np.ndarray))


def copies(arrays: Iterable[Any]) -> Arrays:
    """Return copies of ``arrays``."""
    return tuple(array.copy() for array in arrays)


def put_back(arrays: Iterable[Any], kept: Arrays) -> None:
    """Write the ``kept`` beginning back into each of ``arrays``, [n]; the rest of it is not in use."""
    for array, copy in zip(arrays, kept, strict=True):
        array[: len(copy)] = copy
