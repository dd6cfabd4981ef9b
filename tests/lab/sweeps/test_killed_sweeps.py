"""A sweep that is killed has kept what was finished; ``tests/sweep_kills.py`` kills more of them."""

from __future__ import annotations

import pytest
from sweep_kills import ALLOWED_LOSS, kills


@pytest.mark.process
def test_a_kill_loses_what_runs_and_a_quarter_second_at_most() -> None:
    lost = []
    for _ in range(3):  # a machine that does other things may stand still for a while, but not every time
        done = list(kills(4, seed=3, cells=60))
        assert sum(each.kept for each in done) > 0
        lost.append(max(each.lost for each in done))
        if lost[-1] <= ALLOWED_LOSS:
            return
    raise AssertionError(f"each time something older than {ALLOWED_LOSS} s was lost: {lost}")
