from __future__ import annotations

from dataclasses import replace

import pytest
from lane_samples import side_by_side
from samples import answered, bandit, look

from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.bandit import BanditFigures
from rl_tui.screen.panels.budget import BEST_ARM_PULLED, BudgetPanel, sum_decimals, sum_text


def drawn(snapshot: Snapshot | None, width: int = 54, height: int = 4, *, revealed: bool = False) -> str:
    panel = BudgetPanel(look())
    panel.snapshot = snapshot = answered(snapshot, revealed)
    rows = panel.picture(snapshot, width, height)
    assert [row.cell_length for row in rows] == [width] * height
    return "\n".join(row.text.rstrip() for row in rows)


def test_on_the_way_only_what_the_agent_knows() -> None:
    text = drawn(bandit(400))
    assert "pulls     400 of 1,000" in text
    assert "winnings  485" in text
    assert "1.21 a pull" in text
    assert "w h  shows regret and the best arm" in text
    for secret in ("regret  ", "best possible", "%"):
        assert secret not in text


@pytest.mark.parametrize(
    ("width", "hint"), [(35, "w h  shows regret and the best arm"), (34, "w h  shows regret"), (17, "")]
)
def test_the_hint_is_whole_or_not_there(width: int, hint: str) -> None:
    assert drawn(bandit(400), width).rstrip().splitlines()[-1].strip() == (hint or "winnings")


def test_revealed() -> None:
    text = drawn(bandit(400), revealed=True)
    assert "regret" in text
    assert "best possible 600 on average" in text
    assert "shows regret" not in text


def test_spent() -> None:
    text = drawn(bandit(bandit=BanditFigures(1_000, 1_000, 1_213.4, 287.2, 0.842, 1_500.0)))
    assert text.rstrip().splitlines() == [
        " pulls     1,000 of 1,000 · spent   r r starts again",
        " winnings  1,213      best possible 1,500 on average",
        " regret    287        by true means, without luck",
        " best arm pulled 84 %",
    ]


def test_what_does_not_fit_is_left_out_whole() -> None:
    figures = BanditFigures(1_000, 1_000, 1_213.4, 287.2, 0.842, 1_500.0)
    assert " regret    287        in true means" in drawn(bandit(bandit=figures), 36).splitlines()
    assert drawn(bandit(bandit=figures), 34).splitlines() == [
        " pulls     1,000 of 1,000 · spent",
        " winnings  1,213",
        " regret    287",
        " best arm pulled 84 %",
    ]


def test_before_the_first_pull_there_is_no_share() -> None:
    text = drawn(bandit(0), revealed=True)
    assert "regret    0" in text
    assert BEST_ARM_PULLED not in text


@pytest.mark.parametrize(
    ("x", "text"), [(12.34, "12.3"), (-12.34, "−12.3"), (1_213.4, "1,213"), (-2_000.2, "−2,000"), (0.0, "0")]
)
def test_sums(x: float, text: str) -> None:
    assert sum_text(x, sum_decimals([x]), look()) == text


def test_sums_beside_one_another_have_as_many_decimals() -> None:
    figures = BanditFigures(60, 1_000, 70.44, 12.3, 0.5, 120.0)
    text = drawn(bandit(bandit=figures), revealed=True)
    assert "winnings  70 " in text
    assert "regret    12 " in text


@pytest.mark.parametrize(
    ("width", "figures"), [(57, ["485", "1.21", "75", "85", "%"]), (56, ["485", "1.21", "75"])]
)
def test_of_two_lanes_no_figure_is_cut(width: int, figures: list[str]) -> None:
    group = replace(side_by_side(2, 1).run_group, beside=0)
    shown = replace(answered(bandit(400), revealed=True), run_group=group, beside=answered(bandit(300), True))
    lines = drawn(shown, width, 7, revealed=True).splitlines()
    assert lines[2].split()[-len(figures) :] == figures
    assert "…" not in "".join(lines)
