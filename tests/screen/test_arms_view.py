from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from drawn_grids import style_at
from sample_worlds import bandit_world
from samples import answered, bandit, look
from snapshots import changed

from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.screen.panels.arm_bars import (
    NO_SCALE,
    ArmsScale,
    bound_text,
    grown,
    round_up,
    rows_an_arm,
    shown_scale,
    ticks,
)
from rl_tui.screen.panels.arms import ArmsView, arms_of, noise_of_rewards, standard_error, true_means_now
from rl_tui.screen.theme.glyphs import ASCII, UNICODE
from rl_tui.worlds.drawing import Arms
from rl_tui.worlds.mdp.tabular_mdp import Outcome, Transition, tabular_mdp
from rl_tui.worlds.world import World


def picture(
    snapshot: Snapshot,
    width: int,
    height: int,
    *,
    revealed: bool = False,
    ascii: bool = False,  # noqa: A002
) -> list[str]:
    view = ArmsView(snapshot.world, look(ascii))
    return [strip.text for strip in view.picture(answered(snapshot, revealed), width, height)]


def test_each_arm_is_a_bar_of_its_estimate_and_standard_error() -> None:
    view = ArmsView(bandit_world(), look())
    snapshot = changed(bandit(), phase=Phase.PAUSED)
    rows = [strip.text for strip in view.picture(snapshot, 40, 10)]
    assert rows == [
        "   0            ━━━┃━▌                  ",
        "   1                 ▐━┃━━              ",
        "   2          ━━┃━━━ ▌                  ",
        "   3                 ▐   ━━┃━           ",
        "   4               ━━┃━━                ",
        "▸◉ 5                 ▐          ┃       ",
        "   6              ━━┃▌━                 ",
        "   7                 ▐━┃━━              ",
        "   8     ━━┃━━━      ▌                  ",
        "   9                 ▐    ━┃━━          ",
    ]
    assert view.footing == "−2…+2"


def test_where_there_is_room_rows_are_spaced_and_an_axis_is_drawn() -> None:
    view = ArmsView(bandit_world(), look())
    rows = [strip.text for strip in view.picture(bandit(), 60, 21)]
    assert [row[:4] for row in rows[:20:2]] == ["▸◉ 5" if arm == 5 else f"   {arm}" for arm in range(10)]
    assert all(row.strip() == "┊" for row in rows[1:20:2])
    assert rows[20].split() == ["−2", "−1", "0", "1", "2", "Q", "pulls"], "the columns beside the bars too"
    assert rows[20].index("0") == rows[1].index("┊")
    assert "…" not in view.footing


@pytest.mark.parametrize("width", [24, 40, 60])
def test_what_is_said_of_arms_not_pulled_keeps_off_their_true_means(width: int) -> None:
    rows = picture(bandit(0), width, 10, revealed=True)
    assert all(row.count("◆") == 1 for row in rows)
    said = [row for row in rows if "not" in row]
    assert all(" not pulled" in row for row in said)
    assert len(said) == 10 or width < 40
    hidden = picture(bandit(0), width, 10)
    assert all("not pulled yet" in row for row in hidden)


def test_titles_are_shortened_by_whole_parts() -> None:
    view = ArmsView(bandit_world(), look())
    view.picture(bandit(), 28, 6)
    assert view.footing == "↑↓ 1–6 of 10  −2…+2"
    view.picture(bandit(), 16, 6)
    assert view.footing == "↑↓ 1–6 of 10"


def test_the_truth_is_drawn_only_when_revealed() -> None:
    snapshot = changed(bandit(), phase=Phase.PAUSED)
    hidden = "".join(picture(snapshot, 60, 21))
    assert "◆" not in hidden
    assert "★" not in hidden
    rows = picture(snapshot, 60, 21, revealed=True)
    assert sum(row.count("◆") for row in rows) == 10
    assert [y for y, row in enumerate(rows) if "★" in row] == [10]  # arm 5 has the largest mean, 1.5
    assert rows[10].index("◆") > rows[10].index("┃")  # 1.5 against an estimate of 1.4


def test_a_true_mean_is_no_notch_in_its_bar() -> None:
    shown = answered(changed(bandit(), q=np.full(10, 2.0)))
    strips = ArmsView(bandit_world(), look()).picture(shown, 60, 10)
    marks = [(strip, strip.text.index("◆")) for strip in strips]
    bars = [(style_at(strip, x - 1), style_at(strip, x)) for strip, x in marks]
    grounds = [(bar.bgcolor, mark.bgcolor) for bar, mark in bars if bar and mark and bar.bgcolor]
    assert len(grounds) > 3
    assert all(bar == mark for bar, mark in grounds)


def test_the_hidden_picture_does_not_depend_on_the_truth() -> None:
    snapshot = changed(bandit(), phase=Phase.PAUSED)
    other = changed(snapshot, world=bandit_world(means=tuple(range(10))))
    assert picture(other, 60, 21) == picture(snapshot, 60, 21)


def test_unpulled_arms_say_so_and_before_the_first_pull_none_is_greedy() -> None:
    rows = picture(bandit(pulls=0), 40, 10)
    assert all("not pulled yet" in row for row in rows)
    assert "▸" not in "".join(rows)
    one = changed(bandit(), visits=np.array([3, 0, 0, 0, 0, 0, 0, 0, 0, 0]), q=np.array([0.5, *[0.0] * 9]))
    rows = picture(one, 40, 10)
    assert rows[0].startswith("▸")
    assert sum("not pulled yet" in row for row in rows) == 9


def test_optimistic_ties_are_all_greedy() -> None:
    snapshot = changed(
        bandit(), visits=np.array([1, *[0] * 9]), q=np.array([0.5, *[5.0] * 9]), last_step=None
    )
    rows = picture(snapshot, 40, 10)
    assert [row[0] for row in rows] == [" ", *["▸"] * 9]


def test_the_standard_error_follows_how_the_agent_averages() -> None:
    assert standard_error(1.0, 4, "sample-average") == pytest.approx(0.5)
    assert standard_error(2.0, 100, "sample-average") == pytest.approx(0.2)
    # by hand: 0.5 R1 + 0.25 ... weights 1/4 and 1/2 after two pulls at α = 1/2
    assert standard_error(1.0, 2, 0.5) == pytest.approx(math.sqrt(1 / 16 + 1 / 4))
    assert standard_error(1.0, 10_000, 0.1) == pytest.approx(math.sqrt(0.1 / 1.9))
    assert standard_error(1.0, 5, 1.0) == pytest.approx(1.0)
    assert standard_error(0.0, 5, 0.1) == 0.0


def test_the_scale_widens_in_steps_and_never_shrinks_within_a_run() -> None:
    scale = grown(NO_SCALE, [0.3, -0.2])
    assert scale == ArmsScale(-0.2, 0.3)
    scale = grown(scale, [0.31])
    assert scale == ArmsScale(-0.2, 0.4)
    assert grown(scale, [0.0, 0.1]) == scale
    assert grown(scale, [math.nan, math.inf]) == scale
    assert shown_scale(NO_SCALE) == ArmsScale(-1.0, 1.0)


def test_a_new_run_starts_with_a_new_scale() -> None:
    view = ArmsView(bandit_world(), look())
    view.show(bandit(1_000))
    view.picture(bandit(1_000), 40, 10)
    tame = changed(bandit(500), q=np.full(10, 0.01), visits=np.full(10, 10**6))
    view.picture(tame, 40, 10)
    assert view.footing.startswith("−2…+2")
    view.show(tame)
    view.picture(tame, 40, 10)
    assert view.footing.startswith("0…+0.02")


@pytest.mark.parametrize(
    ("value", "rounded"),
    [(1.0, 1.0), (1.2, 2.0), (2.1, 3.0), (7.0, 8.0), (9.0, 10.0), (0.031, 0.04), (450.0, 500.0)],
)
def test_round_ends(value: float, rounded: float) -> None:
    assert round_up(value) == pytest.approx(rounded)


def test_ticks_are_round_and_hold_zero() -> None:
    assert ticks(ArmsScale(-2.0, 2.0), 5) == [-2.0, -1.0, 0.0, 1.0, 2.0]
    assert ticks(ArmsScale(-0.6, 3.0), 4) == [0.0, 2.0]
    assert [bound_text(value, UNICODE) for value in (-0.5, 0.0, 20.0)] == ["−0.5", "0", "20"]
    assert bound_text(-0.5, ASCII) == "-0.5"


def test_more_arms_than_rows_scroll() -> None:
    world = bandit_world(means=tuple(0.1 * arm for arm in range(50)))
    snapshot = changed(bandit(pulls=0), world=world, q=np.zeros(50), visits=np.zeros(50, dtype=np.int64))
    view = ArmsView(world, look())
    assert view.picture(snapshot, 40, 10)[0].text.startswith("    0")
    assert view.footing == "↑↓ 1–10 of 50  −1…+1"
    view.pan(5, 0)
    assert view.picture(snapshot, 40, 10)[0].text.startswith("    5")
    view.pan(99, 0)
    assert view.picture(snapshot, 40, 10)[9].text.startswith("   49")
    assert view.footing == "↑↓ 41–50 of 50  −1…+1"
    view.follow()
    assert view.picture(snapshot, 40, 10)[0].text.startswith("    0")


def test_narrow_panels_show_the_estimate_as_a_number() -> None:
    rows = picture(bandit(), 9, 10)
    assert rows[5] == "▸◉ 5 1.40"
    assert rows[8] == "   8 −1.2"


def test_wide_panels_add_estimate_and_pulls() -> None:
    assert picture(bandit(), 60, 10)[5].endswith("1.400     842 ")
    assert picture(bandit(), 100, 10)[5].endswith("1.400     842   84 % ")


def test_ascii() -> None:
    rows = picture(bandit(), 60, 21, revealed=True, ascii=True)
    assert "".join(rows).isascii()
    assert sum(row.count("x") for row in rows) == 10


def test_bars_go_from_0_to_the_estimate_and_the_greedy_one_has_the_colour_of_what_looks_best() -> None:
    palette = look().palette
    strips = ArmsView(bandit_world(), look()).picture(bandit(), 40, 21)
    zero, end = strips[1].text.index("┊"), strips[10].text.index("┃")
    assert style_at(strips[10], 0) == palette.best
    grounds = [getattr(style_at(strips[10], x), "bgcolor", None) for x in range(zero - 1, end + 2)]
    assert grounds == [None, None, *[palette.best.color] * (end - zero), None]
    assert strips[10].text[zero] == "▐", "the line of 0 is in the middle of its cell"
    assert style_at(strips[10], zero).color == palette.best.color
    other = style_at(strips[16], zero - 1)
    assert other is not None
    assert other.bgcolor not in (None, palette.best.color)


@pytest.mark.parametrize("depth", ["truecolor", "16", "none"])
def test_a_bar_touches_the_axis_under_its_error_and_an_estimate_of_0_has_none(depth: str) -> None:
    q, visits = np.array([-0.3, 0.3, *[0.0] * 8]), np.array([1, 1, 1, *[0] * 7])
    view = ArmsView(bandit_world(), look(depth == "none", depth))
    strips = view.picture(changed(bandit(), q=q, visits=visits), 40, 10)
    zero = strips[2].text.index(view.look.glyphs.bar_end)
    assert tuple(strip.text[zero] for strip in strips[:2]) == tuple(view.look.glyphs.half_bar)
    assert view.look.glyphs.bar not in strips[2].text
    assert not any(style_at(strips[2], x).bgcolor for x in range(zero - 1, zero + 2))


def test_without_colours_bars_are_characters() -> None:
    plain = look(True, "none")
    rows = [strip.text for strip in ArmsView(bandit_world(), plain).picture(bandit(), 40, 10)]
    assert "#" in rows[5]
    assert rows[5].index("#") < rows[5].index("|")


@pytest.mark.parametrize(("height", "rows"), [(10, 1), (20, 1), (21, 2), (30, 2), (31, 3), (60, 3)])
def test_arms_have_one_to_three_rows_if_one_is_left_for_the_axis(height: int, rows: int) -> None:
    assert rows_an_arm(10, height) == rows
    drawn = picture(bandit(), 60, height)
    assert [y for y, row in enumerate(drawn) if row[3].isdigit()] == list(range(0, 10 * rows, rows))


def two_valued(q: tuple[float, ...]) -> Snapshot:
    mdp = tabular_mdp(
        ("bandit",),
        ("0", "1", "2"),
        [
            Transition(0, arm, (Outcome(p, 0, 1.0, True), Outcome(1.0 - p, 0, 0.0, True)))
            for arm, p in enumerate((0.2, 0.5, 0.9))
        ],
        {0: 1.0},
        time_limit=1,
    )
    known = bandit(400)
    visits = np.array([100, 200, 100], dtype=np.int64)
    return changed(
        known, world=World(mdp, Arms(mdp.pairs), 1_000), q=np.array(q), visits=visits, solution=None
    )


def test_the_noise_of_bernoulli_arms_is_that_of_the_estimate_and_gives_nothing_away() -> None:
    snapshot = two_valued((0.5, 0.0, 1.0))
    mdp = snapshot.world.mdp
    assert mdp is not None
    assert noise_of_rewards(mdp, snapshot.agent.q).tolist() == [0.5, 0.0, 0.0]
    assert noise_of_rewards(mdp, np.array([5.0, -5.0, 0.5])).tolist() == [0.0, 0.0, 0.5]
    errors = [arm.error for arm in arms_of(mdp, snapshot, None)]
    assert errors == [0.05, 0.0, 0.0]
    assert true_means_now(mdp, snapshot) == pytest.approx([0.2, 0.5, 0.9])


def test_means_that_drift_are_the_current_ones() -> None:
    known = bandit(400)
    mdp = known.world.mdp
    assert mdp is not None
    drifts = replace(mdp, drift_std=0.1)
    moved = replace(known.exact_answer.solution, q=known.exact_answer.solution.q + 1.0)
    assert true_means_now(drifts, changed(known, solution=moved)) == pytest.approx(
        known.exact_answer.solution.q + 1.0
    )
    assert true_means_now(drifts, changed(known, solution=None)) is None
    assert true_means_now(drifts, bandit(0)) == pytest.approx(known.exact_answer.solution.q)
    assert true_means_now(mdp, known) == pytest.approx(known.exact_answer.solution.q)
