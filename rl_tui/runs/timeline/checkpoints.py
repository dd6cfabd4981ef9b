"""Stored states of a run in bounded memory, and the target of a seek."""

from __future__ import annotations

from bisect import bisect_right, insort
from collections import deque
from dataclasses import dataclass
from operator import attrgetter
from typing import TYPE_CHECKING, Final

from rl_tui.common.kiosk import in_kiosk
from rl_tui.runs.recipe import UNLIMITED

if TYPE_CHECKING:
    from rl_tui.runs.run import Run, RunState


# Target of a seek


class Target:
    """A position on a branch, at most `end`: after `step` steps, or at the beginning of `episode`."""

    def __init__(self, branch: int, end: int, *, step: int | None = None, episode: int | None = None) -> None:
        self.branch = branch
        self.step = None if step is None else max(0, min(step, end))
        """Steps taken at the target, or None if it is the beginning of an episode."""
        self.last_step = end if self.step is None else self.step
        """Latest step of a seek."""
        self.last_episode = UNLIMITED if episode is None else max(0, episode - 1)
        """Episodes finished at the target."""

    def is_ahead_of(self, step: int, episodes: int, begins_episode: bool) -> bool:
        """Return True if a run from this position can reach the target."""
        if self.step is not None:
            return step <= self.step
        return episodes < self.last_episode or (episodes == self.last_episode and begins_episode)


@dataclass(frozen=True, slots=True, eq=False)
class Seek:
    """A run on its way to a target."""

    run: Run
    """The run that is moved."""
    target: Target
    origin: int
    """Step at which it started."""

    @property
    def done(self) -> bool:
        """True at the target or at the end of the branch."""
        run, target = self.run, self.target
        return run.step >= target.last_step or run.learner.episodes >= target.last_episode

    @property
    def progress(self) -> tuple[int, int]:
        """Steps done, and the largest number to do."""
        return self.run.step - self.origin, self.target.last_step - self.origin


# Memory limits


@dataclass(frozen=True, slots=True)
class Limits:
    """Memory limits of one run, of which there are at most four.

    `checkpoints` and `samples` are bytes for the current branch, `…_left` for all others together. None for
    `branches` or `changes` leaves only the limits of a session file.
    """

    checkpoints: int
    checkpoints_left: int
    samples: int
    samples_left: int
    branches: int | None = None
    changes: int | None = None


USUAL: Final = Limits(256 * 2**20, 128 * 2**20, 32 * 2**20, 64 * 2**20)
KIOSK: Final = Limits(8 * 2**20, 4 * 2**20, 2 * 2**20, 2 * 2**20, branches=50, changes=5_000)


def limits() -> Limits:
    """Return the limits of this process."""
    return KIOSK if in_kiosk() else USUAL


# Checkpoints


MOST: Final = 256
MOST_LEFT: Final = 32  # for a branch that is not current
FIRST_SPACING: Final = 0.05
_LEAST: Final = 2
_NEAR: Final = 4
_step: Final = attrgetter("step")
_LARGE: Final = 16 * 2**20  # only one state of this size is stored as near


class Checkpoints:
    """States at about equal intervals of computing time, and those of the last seeks.

    If they are too many or too large, the `spacing` (seconds of computing) doubles. Every other state is then
    dropped, one for each new state, which reuses its memory.
    """

    def __init__(self) -> None:
        self.spacing = FIRST_SPACING
        self._states: list[RunState] = []
        self._thinned = 0  # dropped since the spacing doubled
        self._near: deque[RunState] = deque(maxlen=_NEAR)

    def __len__(self) -> int:
        """Return the number of states."""
        return len(self._states)

    @property
    def nbytes(self) -> int:
        """Memory in bytes, including shared worlds."""
        return sum(state.nbytes for state in self._states) + self._nbytes_of_worlds

    @property
    def _nbytes_of_worlds(self) -> int:
        """Memory of the worlds, without the last one, which is in use anyway."""
        worlds = {id(state.edited.world): state.edited.world for state in self._states[:-1]}
        if self._states:
            worlds.pop(id(self._states[-1].edited.world), None)
        return sum(world.nbytes for world in worlds.values())

    def add(self, state: RunState) -> None:
        """Store `state`. Others may be dropped."""
        insort(self._states, state, key=_step)
        while len(self._states) > self._room(state.nbytes):
            self._drop_next()

    def _room(self, nbytes: int) -> int:
        left = limits().checkpoints - self._nbytes_of_worlds
        return max(_LEAST, min(MOST, left // max(1, nbytes)))

    def _drop_next(self) -> None:
        if self._thinned == 0 or 2 * (self._thinned + 1) >= len(self._states):
            self._thinned = 0
            self.spacing *= 2
        self._thinned += 1
        del self._states[self._thinned]

    def any_between(self, after: int, step: int) -> bool:
        """Return True if a regular state lies in (after, step]."""
        place = bisect_right(self._states, step, key=_step)
        return place > 0 and self._states[place - 1].step > after

    def add_near(self, state: RunState) -> None:
        """Store `state` for a while, for short seeks."""
        if state.nbytes > _LARGE:
            self._near.clear()
        self._near.append(state)

    def last_before(self, target: Target) -> RunState | None:
        """Return the last state before `target`, or None for the seed."""
        known = (*self._states, *self._near)
        ahead = (each for each in known if target.is_ahead_of(each.step, each.episodes, each.begins_episode))
        return max(ahead, key=_step, default=None)

    def up_to(self, step: int, entries: int) -> Checkpoints:
        """Return the states up to `step` with at most `entries` journal entries."""
        shared = Checkpoints()
        shared.spacing, shared._thinned = self.spacing, self._thinned
        shared._states = [each for each in self._states if each.step <= step and len(each.journal) <= entries]
        return shared

    def thin_out(self, branches: int) -> None:
        """Keep few states of one of `branches` that are not current."""
        self._near.clear()
        while len(self._states) > MOST_LEFT or self.nbytes > limits().checkpoints_left // branches:
            self._states = self._states[::2] if len(self._states) > 1 else []
            self._thinned = 0
            self.spacing *= 2
