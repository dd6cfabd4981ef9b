"""The real program, killed at any moment, has kept what was done; ``tests/crashes.py`` does it more often."""

from __future__ import annotations

import pytest

pytest.importorskip("pty", reason="there are no pseudo-terminals here")

from crashes import ALLOWED_LOSS, crashes


def test_a_kill_loses_no_more_than_a_second() -> None:
    done = list(crashes(3, seed=5))
    assert sum(each.actions for each in done) > 0
    assert max(each.lost for each in done) <= ALLOWED_LOSS
