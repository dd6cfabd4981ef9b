"""The real program saves its work even if killed."""

from __future__ import annotations

import pytest

pytest.importorskip("pty", reason="there are no pseudo-terminals here")

from crashes import ALLOWED_LOSS, crashes


@pytest.mark.exhaustive("kills it again and again")
def test_a_kill_loses_no_more_than_a_second() -> None:
    lost = []
    for _ in range(3):  # a busy machine may pause for a second, but not every time
        done = list(crashes(3, seed=5))
        assert sum(each.actions for each in done) > 0
        lost.append(max(each.lost for each in done))
        if lost[-1] <= ALLOWED_LOSS:
            return
    raise AssertionError(f"each time something older than {ALLOWED_LOSS} s was lost: {lost}")
