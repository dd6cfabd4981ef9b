"""Runs side by side, as a snapshot shows them."""

from __future__ import annotations

from dataclasses import dataclass

from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.runs.results import RunResults
from rl_tui.runs.timeline.run_names import LanePast
from rl_tui.worlds.mdp.space import FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class LaneView:
    """One of several runs, as the others show it."""

    name: str
    """How this run differs, in a few words."""
    algorithm: str
    """Id of the current algorithm."""
    hyperparameters: Hyperparameters
    step: int
    """Steps taken."""
    episodes: int
    """Finished episodes."""
    q: FloatArray
    """A copy of the estimates, `[P]`, empty for a large world."""
    results: RunResults
    past: LanePast | None = None
    """Recipe and changes of the run, or None if unknown."""


@dataclass(frozen=True, slots=True, eq=False)
class RunGroupView:
    """All runs side by side."""

    lanes: tuple[LaneView, ...] = ()
    """All runs, including the visible one, empty if there is only one."""
    shown: int = 0
    """Index of the visible run."""
    beside: int | None = None
    """Index of the second visible run, or None."""
