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
from rl_tui.screen.panels.last_step.update_text import UpdateText, update_text
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
    assert snapshot.counters.last_step is not None
    gathered = {"gathered": changes["reward"]} if "reward" in changes else {}
    last = learned_from(snapshot.counters.last_step, **(gathered | changes))
    q = snapshot.agent.q.copy()
    q[last.updated_pair] = last.after
    return changed(snapshot, last_step=last, q=q)


def lake_step(**changes: Any) -> Snapshot:
    """State 6 of the slippery lake, left intended, down happened: the step in the drawings."""
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


def test_one_line_holds_what_happened_and_the_update() -> None:
    (line,) = drawn(lake_step(), 90)
    equation = ".360 + .10·(0 + .99·.560 − .360) = .379  δ +.194"
    assert line == f" 6 meant ← slipped ↓ to 10  r 0  {equation}  greedy"
    assert drawn(lake_step(), 62) == [" 6 meant ← slipped ↓ to 10  r 0  now = .379  δ +.194  greedy"]
    assert drawn(lake_step(), 30) == [" now = .379  δ +.194"]


@pytest.mark.parametrize(("width", "remark"), [(80, ": target = estimate"), (45, "")])
def test_a_target_that_is_the_estimate_is_told_in_words(width: int, remark: str) -> None:
    lines = drawn(lake_step(before=0.0, bootstrap=0.0), width, 7)
    assert lines[1].strip().startswith(f"nothing to learn{remark}")
    assert lines[-1].endswith(" 0")


def test_every_form_is_whole() -> None:
    snapshot = lake_step()
    parts = (
        ".360 + .10·(0 + .99·.560 − .360) = .379",
        "now = .379",
        "δ +.194",
        "6 meant ← slipped ↓ to 10  r 0",
    )
    parts += (
        "in 6 meant ← slipped ↓ to 10   reward 0   chance 1/3",
        "in 6 meant ← slipped ↓ to 10   reward 0",
    )
    parts += (
        "in 6 meant ← slipped ↓ to 10  r 0",
        "6 meant ← slipped ↓ to 10   reward 0",
        "chance 1/3",
        "greedy",
    )
    for width in range(13, 120):
        (line,) = drawn(snapshot, width)
        for part in sorted(parts, key=len, reverse=True):
            line = line.replace(part, "")
        assert not line.strip()


def test_a_terminal_step_does_not_bootstrap() -> None:
    ended = lake_step(terminated=True, next_state=5, bootstrap=0.0)
    (line,) = drawn(ended)
    assert ".360 + .10·(0 − .360) = .324  δ −.360" in line
    lines = drawn(ended, 56, 7)
    assert lines[:2] == [" in 6 meant ← slipped ↓ to 5: hole   reward 0", " the episode ends"]
    assert lines[2] == " now  = was  + α  ·(r − was )"


def test_a_truncated_step_still_bootstraps() -> None:
    truncated = lake_step(truncated=True)
    lines = drawn(truncated, 56, 7)
    assert lines[1] == " truncated by the time limit: still bootstraps"
    assert "+ γ  ·best" in lines[2]
    assert drawn(truncated, 45, 7)[1] == " truncated, still bootstraps"
    assert drawn(truncated, 32, 3)[1:] == [" now = .379  δ +.194", " truncated, still bootstraps"]
    assert drawn(truncated, 110)[0].endswith("δ +.194  time limit  greedy")


def test_negative_numbers_stand_in_brackets() -> None:
    negative = stepped(student(), before=-1.5, bootstrap=-0.5, reward=-2.0)
    (line,) = drawn(negative, 100)
    assert "−1.5 + .10·(−2 + .90·(−.5) − (−1.5)) = −1.595  δ −.950" in line
    assert drawn(negative, 46, 7)[2:4] == [
        " now    = was  + α  ·(r  + γ  ·best  − was   )",
        " −1.595 = −1.5 + .10·(−2 + .90·(−.5) − (−1.5))",
    ]


def test_a_sample_average_shows_its_fraction() -> None:
    (line,) = drawn(stepped(bandit(), before=1.39, reward=2.11))
    assert "1.390 + 1/842·(2.110 − 1.390) = 1.391" in line
    for step_size, alpha, text in ((0.5, 0.5, ".50"), (0.5, "sample-average", "1/2"), (0.3, 0.1, ".30")):
        last = replace(LAST, step_size=step_size)
        assert update_text(last, alpha, UNICODE, bootstraps=True).step_size == text


def test_zero_has_no_decimals_what_rounding_leaves_is_zero_and_a_small_estimate_is_not() -> None:
    def text_of(**terms: float) -> UpdateText:
        return update_text(replace(LAST, **terms), 0.1, UNICODE, bootstraps=True)

    text = text_of(before=0.0, bootstrap=0.0, after=0.0)
    assert (text.before, text.bootstrap, text.target, text.error, text.after) == ("0", "0", "0", "0", "0")
    text = text_of(before=0.1 + 0.2, gathered=0.3, bootstrap=0.0, after=0.3)
    assert (text.error, text.before) == ("0", ".3")
    assert text_of(before=0.0, bootstrap=0.004, after=0.1 * 0.99 * 0.004).after == ".0004"


# Words above numbers


def test_words_stand_above_the_numbers_and_a_bar_shows_the_error() -> None:
    assert drawn(lake_step(), 45, 7) == [
        " in 6 meant ← slipped ↓ to 10   reward 0",
        "",
        " now  = was  + α  ·(r + γ  ·best − was )",
        " .379 = .360 + .10·(0 + .99·.560 − .360)",
        "                   ╰──────── δ ────────╯",
        "",
        " surprise δ ────────────│━━━━━━━━━━━━   +.194",
    ]


def test_in_three_rows_the_numbers_stand_without_words() -> None:
    assert drawn(lake_step(), 32, 3) == [
        " 6 meant ← slipped ↓ to 10  r 0",
        " .360 + .10·(0 + .99·.560",
        "   − .360) = .379  δ +.194",
    ]
    assert drawn(lake_step(before=0.63745, bootstrap=0.73106), 32, 3)[1:] == [
        " .637 + .10·(0 + .99·.731",
        "   − .637) = .646  δ +.086",
    ]


def test_where_the_equation_is_too_long_for_a_line_it_goes_on_below() -> None:
    assert drawn(lake_step(before=0.63745, bootstrap=0.73106), 36, 7)[2:6] == [
        " now  = was  + α",
        " .646 = .637 + .10",
        "   ·(r + γ  ·best − was )",
        "   ·(0 + .99·.731 − .637)",
    ]


def test_where_words_above_the_numbers_are_too_wide_the_equation_goes_on_below() -> None:
    long = stepped(LAKE, before=-2.67555, bootstrap=-3.28212, reward=-1.0)
    text = " ".join(" ".join(drawn(long, 36, 8)).split())
    assert "−2.67" in text.partition("surprise")[0]
    assert "· (" in text or "·(" in text, "not the result alone"


@pytest.mark.parametrize("height", [4, 5, 6, 7, 9])
def test_shorter_forms_tell_the_same(height: int) -> None:
    lines = drawn(lake_step(), 60, height)
    text = "\n".join(lines)
    for part in ("6 meant ← slipped ↓ to 10", "reward 0", ".379 = .360 + .10·(0 + .99·.560 − .360)"):
        assert part in text
    assert lines[min(height, 7) - 1].startswith(" surprise δ ──")
    assert ("╰" in text) is (height >= 6)


@pytest.mark.parametrize(
    ("error", "bar"),
    [
        (0.0, "────────────│────────────"),
        (-0.01, "────━│──────"),
        (0.01, "──────│━────"),
        (-9.0, " ━━━━━━━━━━━━│"),
    ],
)
def test_the_bar_goes_to_the_side_of_the_sign(error: float, bar: str) -> None:
    assert bar in drawn(lake_step(before=0.0, bootstrap=error), 45, 7)[-1]


def test_the_environment_of_a_graph_is_told_in_words() -> None:
    text = "\n".join(drawn(student(), 56, 8))
    assert "in Class did study to Pass   reward −2   chance .8" in text
    for word in ("meant", "went", "slipped", "row"):
        assert word not in text + drawn(student())[0]


def test_a_certain_outcome_has_probability_1() -> None:
    certain = lake(slippery=False)
    (line, *_) = drawn(certain, 70, 8)
    assert certain.counters.last_step
    assert f"to {certain.counters.last_step.next_state}: " in line
    assert line.endswith("chance 1")
    assert "meant" not in line


def test_a_long_name_of_the_action_is_not_crowded_out() -> None:
    pair = student().world.space.pairs_of(0)[1]
    snapshot = stepped(student(), pair=pair, updated_pair=pair, explored=True)
    for width in (56, 46, 40):
        assert "did check phone to " in drawn(snapshot, width, 7)[0]


def test_a_bandit_has_no_next_state() -> None:
    text = "\n".join(drawn(stepped(bandit(), before=1.39, reward=2.11), 56, 8))
    assert "pulled 5   reward 2.110   N 842" in text
    assert "1/N" in text
    assert " to " not in text
    assert "γ" not in text


# The origin of the action


def choice(q_before: list[float], pair: int, *, explored: bool) -> str:
    snapshot = lake_step(before=q_before[pair], explored=explored)
    mdp = snapshot.world.space
    first = int(mdp.first_pair[6])
    q = snapshot.agent.q.copy()
    q[first : first + 4] = q_before
    q[first + pair] = 9.9  # the update has changed it: its value before counts
    assert snapshot.counters.last_step is not None
    last = replace(snapshot.counters.last_step, pair=first + pair, updated_pair=first + pair)
    return heading(changed(snapshot, q=q, last_step=last))


def heading(snapshot: Snapshot) -> str:
    widget = LastStepPanel(look())
    widget.picture(snapshot, 80, 7)
    return widget.heading


def test_it_says_whether_an_action_was_greedy_or_random() -> None:
    assert choice([0.5, 0.1, 0.2, 0.3], 0, explored=False) == "Last step · the greedy action"
    assert choice([0.0, 0.0, 0.0, 0.0], 2, explored=False) == "Last step · one of 4 tied greedy actions"
    explored = "Last step · a random action (1 step in 10)"
    assert choice([0.5, 0.1, 0.2, 0.3], 1, explored=True) == explored
    assert choice([0.5, 0.1, 0.2, 0.3], 0, explored=True) == f"{explored}, by chance the greedy one"


@pytest.mark.parametrize(
    ("epsilon", "share"), [(0.25, "1 step in 4"), (0.15, "15 % of steps"), (1.0, "every step")]
)
def test_how_many_actions_are_random(epsilon: float, share: str) -> None:
    assert heading(lake_step(explored=True, epsilon=epsilon)).startswith(
        f"Last step · a random action ({share})"
    )


# Any size


def test_before_the_first_step_it_says_what_to_press() -> None:
    assert drawn(lake(0))[0].strip() == "no step yet: s takes one"
    assert drawn(None)[0].strip() == "no step yet: s takes one"


def test_while_a_session_is_replayed_its_last_step_is_not_known() -> None:
    left = lake(0)
    left = replace(left, counters=replace(left.counters, step=2_000_000))
    assert drawn(left)[0].strip() == "the last step appears once it is replayed"


@pytest.mark.parametrize(("speed", "is_told"), [(10.0, True), (30.0, True), (100.0, False), (None, False)])
def test_how_an_action_that_passes_too_fast_was_chosen_is_not_told(
    speed: float | None, is_told: bool
) -> None:
    assert ("greedy" in heading(changed(lake_step(), phase=Phase.RUNNING, speed=speed))) is is_told
    assert "greedy" in heading(changed(lake_step(), speed=speed))


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


def test_the_equation_keeps_its_form_from_step_to_step() -> None:
    steps = [(0.36, 0.56), (0.63745, 0.73106), (0.9066, 0.9545), (0.1234567, 0.7654321), (0.5, 0.25)]
    for before, bootstrap in steps:
        lines = drawn(lake_step(before=before, bootstrap=bootstrap), 45, 7)
        assert lines[2].startswith(" now  ")
        assert "╰" in lines[4]
