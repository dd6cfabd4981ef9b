"""What is shown of runs side by side."""

from __future__ import annotations

from dataclasses import dataclass

from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.runs.results import RunResults
from rl_tui.runs.timeline.run_names import LanePast
from rl_tui.worlds.mdp.space import FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class LaneView:
    """One of several runs side by side, as far as it is shown beside the others."""

    name: str
    """In a few words, what is different here."""
    algorithm: str
    """The id of the algorithm in force."""
    hyperparameters: Hyperparameters
    """The hyper-parameters in force."""
    step: int
    """Steps taken."""
    episodes: int
    """Finished episodes."""
    q: FloatArray
    """[P], a copy of the estimates; of a large world empty."""
    results: RunResults
    """What the run has achieved."""
    past: LanePast | None = None
    """What it was made from and what was changed in it; None where that is not told."""


@dataclass(frozen=True, slots=True, eq=False)
class RunGroupView:
    """All runs side by side."""

    lanes: tuple[LaneView, ...] = ()
    """The runs, the one shown among them; empty where there is only one."""
    shown: int = 0
    """The place of the one shown, from 0."""
    beside: int | None = None
    """The place of the one that stands beside it, from 0; None where there is no other."""
