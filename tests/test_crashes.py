"""The real program, killed at any moment, has kept what was done; ``tests/crashes.py`` does it more often."""

from __future__ import annotations

import pytest

pytest.importorskip("pty", reason="there are no pseudo-terminals here")

from crashes import crashes

# seconds; how much it is, tests/crashes.py measures, and other work on the machine shows in it
LONGEST = 20.0


def test_a_kill_loses_only_what_was_done_last() -> None:
    done = list(crashes(3, seed=5))
    assert sum(each.actions for each in done) > 0
    assert max(each.lost for each in done) <= LONGEST
