"""Whether two pictures are of one run, so that its axes and columns may stay as they are."""

from __future__ import annotations

from rl_tui.lab.snapshot import Snapshot


def is_another_run(before: Snapshot | None, now: Snapshot) -> bool:
    """Tell whether a run began between ``before`` and ``now``: neither a way back nor a look at a lane."""
    return before is not None and before.lane == now.lane and before.recipe != now.recipe
