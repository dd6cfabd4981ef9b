"""Checkpoints: states of a run to return to, in bounded memory, and the way to another step or episode."""

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


# The way to another place


class Target:
    """A place on a branch: the state after ``step`` steps, or where ``episode`` (from 1) begins.

    ``branch`` is the number of the branch, and ``end`` how far it has come: no target lies further.
    """

    def __init__(self, branch: int, end: int, *, step: int | None = None, episode: int | None = None) -> None:
        self.branch = branch
        """The number of the branch."""
        self.step = None if step is None else max(0, min(step, end))
        """How many steps were taken there; None where it is the beginning of an episode."""
        self.last_step = end if self.step is None else self.step
        """The step at which a seek ends at the latest."""
        self.last_episode = UNLIMITED if episode is None else max(0, episode - 1)
        """How many episodes are finished there."""

    def is_ahead_of(self, step: int, episodes: int, begins_episode: bool) -> bool:
        """Return True if a run that stands there is at the target, or comes there when it advances."""
        if self.step is not None:
            return step <= self.step
        return episodes < self.last_episode or (episodes == self.last_episode and begins_episode)


@dataclass(frozen=True, slots=True, eq=False)
class Seek:
    """The way of a run to another place."""

    run: Run
    """The run that is brought to the target."""
    target: Target
    """Where it is brought."""
    origin: int
    """The step from which it started."""

    @property
    def done(self) -> bool:
        """Whether the run has reached the target, or the end of the branch."""
        run, target = self.run, self.target
        return run.step >= target.last_step or run.learner.episodes >= target.last_episode

    @property
    def progress(self) -> tuple[int, int]:
        """How many steps are done, and of how many at most."""
        return self.run.step - self.origin, self.target.last_step - self.origin


# Memory limits


@dataclass(frozen=True, slots=True)
class Limits:
    """What one lane may keep, of which there are four at the most.

    ``checkpoints`` and ``samples`` are bytes of the branch in force, ``checkpoints_left`` and
    ``samples_left`` those of all others together. ``branches`` and ``changes``, in all of them together, are
    None where only the session file limits them.
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
    """Return what is in force in this process."""
    return KIOSK if in_kiosk() else USUAL


# Checkpoints


MOST: Final = 256
MOST_LEFT: Final = 32  # of a branch that is not in force
FIRST_SPACING: Final = 0.05
_LEAST: Final = 2
_NEAR: Final = 4
_step: Final = attrgetter("step")
_LARGE: Final = 16 * 2**20  # of such states only one is kept that is near


class Checkpoints:
    """States along one branch, about evenly apart in the time it takes to compute from one to the next.

    Where there are too many, or they take too much memory, the ``spacing``, in seconds of computing, doubles,
    and every other goes: one for each that comes, from the first on. So there are always about as many, and
    the memory that one leaves is taken by the next: half of them gone at once would leave holes in the heap.
    A few more, those left by the last seeks, make the next one short.
    """

    def __init__(self) -> None:
        self.spacing = FIRST_SPACING
        self._states: list[RunState] = []
        self._thinned = 0  # how many have gone since the spacing doubled
        self._near: deque[RunState] = deque(maxlen=_NEAR)

    def __len__(self) -> int:
        """Return how many there are."""
        return len(self._states)

    @property
    def nbytes(self) -> int:
        """How much memory they take, with the worlds that they share."""
        return sum(state.nbytes for state in self._states) + self._nbytes_of_worlds

    @property
    def _nbytes_of_worlds(self) -> int:
        """How much memory their worlds take, but for the last one's, which is in use all the same."""
        worlds = {id(state.edited.world): state.edited.world for state in self._states[:-1]}
        if self._states:
            worlds.pop(id(self._states[-1].edited.world), None)
        return sum(world.nbytes for world in worlds.values())

    def add(self, state: RunState) -> None:
        """Keep ``state``; some others may go for it."""
        insort(self._states, state, key=_step)
        while len(self._states) > self._room(state.nbytes):
            self._drop_next()

    def _room(self, nbytes: int) -> int:
        """Return how many states there may be of so many bytes each, besides the worlds that they share."""
        left = limits().checkpoints - self._nbytes_of_worlds
        return max(_LEAST, min(MOST, left // max(1, nbytes)))

    def _drop_next(self) -> None:
        """Drop the next of every other state; where all have been passed, begin again at the first."""
        if self._thinned == 0 or 2 * (self._thinned + 1) >= len(self._states):
            self._thinned = 0
            self.spacing *= 2
        self._thinned += 1
        del self._states[self._thinned]

    def any_between(self, after: int, step: int) -> bool:
        """Tell whether one that is kept for good is beyond ``after``, but not beyond ``step``."""
        place = bisect_right(self._states, step, key=_step)
        return place > 0 and self._states[place - 1].step > after

    def add_near(self, state: RunState) -> None:
        """Keep ``state`` for a while: the run has just been about there."""
        if state.nbytes > _LARGE:
            self._near.clear()
        self._near.append(state)

    def last_before(self, target: Target) -> RunState | None:
        """Return the last state from which ``target`` is still ahead, None for the seed."""
        known = (*self._states, *self._near)
        ahead = (each for each in known if target.is_ahead_of(each.step, each.episodes, each.begins_episode))
        return max(ahead, key=_step, default=None)

    def up_to(self, step: int, entries: int) -> Checkpoints:
        """Return those not beyond ``step`` to which at most so many journal entries were applied."""
        shared = Checkpoints()
        shared.spacing, shared._thinned = self.spacing, self._thinned
        shared._states = [each for each in self._states if each.step <= step and len(each.journal) <= entries]
        return shared

    def thin_out(self, branches: int) -> None:
        """Keep a few only, or none of very large ones: their branch is one of ``branches`` that were left."""
        self._near.clear()
        while len(self._states) > MOST_LEFT or self.nbytes > limits().checkpoints_left // branches:
            self._states = self._states[::2] if len(self._states) > 1 else []
            self._thinned = 0
            self.spacing *= 2
