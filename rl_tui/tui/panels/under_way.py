"""Which episode a run is in, as every screen counts them."""

from __future__ import annotations

from rl_tui.lab.live.snapshot import Phase, Snapshot


def episode_under_way(snapshot: Snapshot) -> int:
    """Return the number, from 1, of the episode under way; of a planner that of its sweep.

    Where one has just ended it is the one that comes next, and the last one where none does.
    """
    return snapshot.episodes + (snapshot.phase not in (Phase.SPENT, Phase.DONE))
