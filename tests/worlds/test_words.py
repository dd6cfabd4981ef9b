from __future__ import annotations

from rl_tui.worlds.words import counted


def test_one_is_singular_and_thousands_have_commas() -> None:
    assert [counted(count, "run") for count in (0, 1, 1200)] == ["0 runs", "1 run", "1,200 runs"]
