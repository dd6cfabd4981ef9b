"""Whether two pictures are of one run, so that its axes and columns may stay as they are."""

from __future__ import annotations

from rl_tui.lab.live.snapshot import Snapshot


def is_new_run(before: Snapshot | None, now: Snapshot) -> bool:
    """Tell whether a run began between ``before`` and ``now``: neither a way back nor a look at a lane.

    A way back leaves its first branch as long as it was; a run that starts again has a new one.
    """
    if before is None or before.lane != now.lane:
        return False
    first, was = now.timeline.branches[0], before.timeline.branches[0]
    return before.recipe != now.recipe or first.end < was.end
