from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from samples import bandit, lake, learned_from, look, planning, student
from snapshots import changed

from rl_tui.agents.last_step import LastStep
from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.screen.panels.last_step.last_step import LastStepPanel
from rl_tui.screen.panels.last_step.update_text import step_size_text, update_text
from rl_tui.screen.theme.glyphs import UNICODE

LAKE = lake()
LAST = LastStep(
    step=1,
    episode=1,
    state=0,
    pair=0,
    explored=False,
    epsilon=0.1,
    outcome=0,
    reward=0.0,
    next_state=1,
    terminated=False,
    truncated=False,
    updated_pair=0,
    others=0,
    table=0,
    before=0.36,
    step_size=0.1,
    gamma=0.99,
    gathered=0.0,
    discount=0.99,
    bootstrap=0.56,
    bootstrap_state=1,
    after=0.38,
)


def drawn(snapshot: Snapshot | None, width: int = 80, height: int = 1, *, ascii: bool = False) -> list[str]:  # noqa: A002
    rows = LastStepPanel(look(ascii)).picture(snapshot, width, height)
    assert [row.cell_length for row in rows] == [width] * height
    return [row.text.rstrip() for row in rows]


def stepped(snapshot: Snapshot, **changes: Any) -> Snapshot:
    """``snapshot`` with changes to its last step, the estimate after it worked out."""
    assert snapshot.counters.last_step is not None
    gathered = {"gathered": changes["reward"]} if "reward" in changes else {}
    last = learned_from(snapshot.counters.last_step, **(gathered | changes))
    q = snapshot.agent.q.copy()
    q[last.updated_pair] = last.after
    return changed(snapshot, last_step=last, q=q)


def lake_step(**changes: Any) -> Snapshot:
    """State 6 of the slippery lake, meant left, went down: the step of the drawings."""
    mdp = LAKE.world.mdp
    left = int(mdp.first_pair[6])
    outcome = next(each for each in mdp.outcomes_of(left) if mdp.outcome_action[each] == 1)
    usual = {
        "state": 6,
        "pair": left,
        "updated_pair": left,
        "outcome": outcome,
        "next_state": 10,
        "reward": 0.0,
        "before": 0.36,
        "bootstrap": 0.56,
    }
    return stepped(LAKE, **(usual | changes))


# The update in numbers


def test_one_line_holds_the_update_and_what_led_to_it() -> None:
    (line,) = drawn(lake_step())
    assert line == " Q(6,←) ← .36 + .10·(0 + .99·.56 − .36) = .38  δ +.19  meant ← went ↓  greedy"


@pytest.mark.parametrize(("width", "remark"), [(80, ", the target is the estimate"), (45, "")])
def test_a_target_that_is_the_estimate_is_told_in_words(width: int, remark: str) -> None:
    lines = drawn(lake_step(before=0.0, bootstrap=0.0), width, 8)
    told = next(line for line in lines if "stays" in line)
    assert told.strip() == f"Q(6,←) stays 0: nothing to learn{remark}"
    assert "(0)" not in "".join(lines)


def test_parts_that_do_not_fit_are_left_out_whole_and_a_sign_says_so() -> None:
    snapshot = lake_step()
    parts = (
        " Q(6,←) ← .36 + .10·(0 + .99·.56 − .36) = .38",
        " Q(6,←) ← .38",
        "  δ +.19",
        "  meant ← went ↓",
        "  greedy",
    )
    for width in range(13, 90):
        (line,) = drawn(snapshot, width)
        has_all = all(part in line for part in parts[2:])
        for part in parts:
            line = line.replace(part, "")
        assert line.strip() == "" if has_all else line.strip() in ("", "…")
    assert [drawn(snapshot, width)[0].endswith("…") for width in (50, 60, 70)] == [True] * 3


def test_too_narrow_for_the_update_its_result_is_left() -> None:
    assert drawn(lake_step(), 30) == [" Q(6,←) ← .38  δ +.19  greedy…"]


def test_a_terminal_step_does_not_bootstrap() -> None:
    ended = lake_step(terminated=True, next_state=5, bootstrap=0.0)
    (line,) = drawn(ended)
    assert "Q(6,←) ← .36 + .10·(0 − .36) = .32  δ −.36" in line
    assert "target = r = 0 (terminal)" in "\n".join(drawn(ended, 56, 10))
    assert "s′ = 5: hole, the episode ends" in "\n".join(drawn(ended, 56, 10))


def test_a_truncated_step_still_bootstraps() -> None:
    assert "cut off by the time limit: still bootstraps" in "\n".join(
        drawn(lake_step(truncated=True), 80, 10)
    )
    text = "\n".join(drawn(lake_step(truncated=True), 56, 10))
    assert "cut off, still bootstraps" in text
    assert "target = r + γ · max Q(10,·)" in text
    assert "time limit" in drawn(lake_step(truncated=True), 100)[0]


def test_negative_numbers_stand_in_brackets() -> None:
    (line,) = drawn(stepped(student(), before=-1.5, bootstrap=-0.5, reward=-2.0))
    assert " Q(Class,study) ← −1.5 + .10·(−2 + .90·(−.5) − (−1.5)) = −1.59" in line
    assert "δ −.95" in line


def test_a_sample_average_shows_its_fraction() -> None:
    (line,) = drawn(stepped(bandit(), before=1.39, reward=2.11))
    assert line.startswith(" Q(5) ← 1.390")
    assert "+ 1/842·(2.11" in line
    assert step_size_text(0.5, 0.5, UNICODE) == ".50"
    assert step_size_text(0.5, "sample-average", UNICODE) == "1/2"
    assert step_size_text(0.3, 0.1, UNICODE) == ".30"


def test_whole_numbers_have_no_decimals() -> None:
    text = update_text(replace(LAST, before=0.0, bootstrap=0.0, after=0.0), 0.1, UNICODE, bootstraps=True)
    assert (text.before, text.bootstrap, text.target, text.error, text.after) == ("0", "0", "0", "0", "0")


def test_what_rounding_errors_leave_is_nothing() -> None:
    text = update_text(
        replace(LAST, before=0.1 + 0.2, gathered=0.3, bootstrap=0.0, after=0.3), 0.1, UNICODE, bootstraps=True
    )
    assert (text.error, text.before) == ("0", ".3")


def test_a_small_estimate_does_not_look_like_none() -> None:
    text = update_text(
        replace(LAST, before=0.0, bootstrap=0.004, after=0.1 * 0.99 * 0.004), 0.1, UNICODE, bootstraps=True
    )
    assert text.after == ".0004"


# The five parts


def test_the_loop_in_five_parts() -> None:
    assert drawn(lake_step(), 56, 9) == [
        " agent        s = 6   row 1, column 2, counted from 0",
        "              greedy (ε = .10)   action a = ←",
        " environment  meant ←, slipped ↓ (p 1/3)",
        "              reward r = 0   next state s′ = 10",
        " update       target = r + γ · max Q(10,·)",
        "                     = 0 + .99 · .56 = .55",
        "              δ = .55 − .36 = +.19",
        "   Q(6,←) ← .36 + .10 · (+.19) = .38",
        "",
    ]


@pytest.mark.parametrize("height", [4, 5, 6, 7])
def test_shorter_forms_tell_the_same(height: int) -> None:
    lines = drawn(lake_step(), 60, height)
    text = "\n".join(lines)
    for part in ("s = 6", "a = ←", "greedy", "slipped ↓", "r = 0", "s′ = 10", ".55", "+.19", ".38"):
        assert part in text
    assert lines[-1] == "   Q(6,←) ← .36 + .10 · (+.19) = .38" or height == 4


def test_the_environment_of_a_graph_is_told_in_words() -> None:
    text = "\n".join(drawn(student(), 56, 8))
    assert "s = Class" in text
    assert "a = study" in text
    assert "environment  → Pass (p .8)" in text
    assert "s′ = Pass" in text
    for word in ("meant", "went", "slipped", "row"):
        assert word not in text + drawn(student())[0]


def test_a_certain_outcome_has_probability_1() -> None:
    certain = lake(slippery=False)
    text = "\n".join(drawn(certain, 56, 8))
    assert certain.counters.last_step
    assert f"environment  → {certain.counters.last_step.next_state} (p 1)" in text
    assert "meant" not in text


def test_a_long_name_of_the_action_is_not_crowded_out() -> None:
    pair = student().world.space.pairs_of(0)[1]
    snapshot = stepped(student(), pair=pair, updated_pair=pair, explored=True)
    assert "random (ε = .10)   action a = check phone" in drawn(snapshot, 56, 8)[1]
    assert "random (ε = .10)   a = check phone" in drawn(snapshot, 50, 8)[1]
    assert "random   action a = check phone" in drawn(snapshot, 46, 8)[1]


def test_a_bandit_has_no_next_state() -> None:
    text = "\n".join(drawn(stepped(bandit(), before=1.39, reward=2.11), 56, 8))
    assert "pulled 5   greedy (ε = .10)" in text
    assert "N = 842" in text
    assert "s′" not in text
    assert "γ" not in text


# How the action came about


def choice(q_before: list[float], pair: int, *, explored: bool) -> str:
    snapshot = lake_step(before=q_before[pair], explored=explored)
    mdp = snapshot.world.space
    first = int(mdp.first_pair[6])
    q = snapshot.agent.q.copy()
    q[first : first + 4] = q_before
    q[first + pair] = 9.9  # the update has moved it: what counts is what it was before
    assert snapshot.counters.last_step is not None
    last = replace(snapshot.counters.last_step, pair=first + pair, updated_pair=first + pair)
    return drawn(changed(snapshot, q=q, last_step=last), 60, 8)[1].strip()


def test_a_greedy_choice() -> None:
    assert choice([0.5, 0.1, 0.2, 0.3], 0, explored=False).startswith("greedy (ε = .10)   action a =")


def test_a_choice_among_ties() -> None:
    assert choice([0.0, 0.0, 0.0, 0.0], 2, explored=False).startswith("greedy (ε = .10), one of 4 equal")


def test_exploring() -> None:
    assert choice([0.5, 0.1, 0.2, 0.3], 1, explored=True).startswith("random (ε = .10)   action a = ↓")


def test_exploring_may_hit_the_greedy_action() -> None:
    assert choice([0.5, 0.1, 0.2, 0.3], 0, explored=True).startswith("random (ε = .10), greedy by chance")


# Any size


def test_before_the_first_step_it_says_what_to_press() -> None:
    assert drawn(lake(0))[0].strip() == "no step yet: s takes one"
    assert drawn(None)[0].strip() == "no step yet: s takes one"


def test_while_a_session_is_replayed_its_last_step_is_not_known() -> None:
    left = lake(0)
    left = replace(left, counters=replace(left.counters, step=2_000_000))
    assert drawn(left)[0].strip() == "the last step is told once it is replayed"


def test_the_border_names_the_step() -> None:
    widget = LastStepPanel(look())
    widget.picture(lake_step(), 56, 8)
    assert widget.heading == "Last step"
    assert widget.footing == "step 150,000 · episode 12,500"
    widget.picture(bandit(400), 56, 8)
    assert widget.footing == "pull 400"


@pytest.mark.parametrize(("speed", "is_named"), [(10.0, True), (30.0, True), (100.0, False), (None, False)])
def test_a_step_that_passes_too_fast_is_not_named(speed: float | None, is_named: bool) -> None:
    widget = LastStepPanel(look())
    widget.picture(changed(lake_step(), phase=Phase.RUNNING, speed=speed), 56, 8)
    assert bool(widget.footing) is is_named
    widget.picture(changed(lake_step(), speed=speed), 56, 8)
    assert widget.footing


@pytest.mark.parametrize("snapshot", [None, lake(0), lake_step(), student(), bandit(400)])
@pytest.mark.parametrize("ascii", [False, True])
def test_it_fits_any_size(snapshot: Snapshot | None, ascii: bool) -> None:  # noqa: A002
    for width in (1, 3, 10, 20, 40, 54, 80, 140):
        for height in (1, 2, 3, 4, 5, 6, 7, 8, 20):
            lines = drawn(snapshot, width, height, ascii=ascii)
            assert not ascii or all(line.isascii() for line in lines)


def test_estimates_that_run_away_are_shown() -> None:
    (line,) = drawn(stepped(lake(), before=-3e11, bootstrap=7.5e11))
    assert "e11" in line
    assert np.isfinite(len(line))


def test_a_planner_tells_how_its_sweep_gets_on_where_there_is_room() -> None:
    last = replace(LAST, pair=-1, episode=7, outcome=-1)
    progress = "policy 2, evaluation sweep 7: largest change 0.0123"
    known = planning(last_step=last, planning=progress)
    assert any(progress in row for row in drawn(known, 80, 8))
    narrow = drawn(known, 44, 8)
    assert any(row.endswith("policy 2, evaluation sweep 7") for row in narrow)
    assert not any("policy 2" in row for row in drawn(known, 80, 4))
    assert not any("policy 2" in row for row in drawn(lake(planning=progress), 80, 9))
