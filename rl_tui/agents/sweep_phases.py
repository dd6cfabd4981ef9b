"""What a sweep does to the policy of a planner that keeps one."""

from __future__ import annotations

from typing import Final, Literal

SweepPhase = Literal["evaluation", "improvement"]

SWEEP_PHASES: Final[tuple[SweepPhase, ...]] = ("evaluation", "improvement")
"""All of them; kernels number them by their places."""
