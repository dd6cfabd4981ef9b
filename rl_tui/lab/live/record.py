"""All that is needed to come back to where a playground was: small, and free of arrays."""

from __future__ import annotations

from dataclasses import dataclass, field

from rl_tui.lab.live.until import Breakpoints
from rl_tui.lab.timeline.branches import RunRecord


@dataclass(frozen=True, slots=True)
class Record:
    """The runs of a playground, and what a person had set there."""

    lanes: tuple[RunRecord, ...]
    """The runs side by side, at least one."""
    shown: int = 0
    """The number of the run shown."""
    breakpoints: Breakpoints = field(default_factory=Breakpoints)
    """Where the run shown is to stop."""
    speed: float | None = None
    """The wanted steps a second, None for as fast as it goes."""
