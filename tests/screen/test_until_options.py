from __future__ import annotations

import pytest
from samples import bandit, lake, look, planning, stepped_lake, student
from snapshots import changed

from rl_tui.live.pace.until import Event, Until
from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.dialogs.until_options import UntilOption, ask_number, until_options

GLYPHS = look().glyphs


def found(snapshot: Snapshot, cursor: int | None = None) -> dict[str, UntilOption]:
    return {wait.id: wait for wait in until_options(snapshot, cursor, GLYPHS)}


def read(wait: UntilOption, snapshot: Snapshot, text: str) -> float | str:
    return ask_number(wait, snapshot, GLYPHS).read(text)


def test_an_agent_waits_for_all_of_it() -> None:
    listed = found(lake(), cursor=17)
    assert [wait.event for wait in listed.values()] == [
        Event.REWARD,
        Event.EPISODE_END,
        Event.POLICY_CHANGE,
        Event.OPTIMAL,
        Event.STEP,
        Event.EPISODE,
        Event.VALUE,
        Event.VALUE,
    ]
    assert not any(wait.refused for wait in listed.values())
    assert listed["value cursor"].name == "Q(4,↓) reaches a value …"
    assert listed["value last"].name == "Q(6,←) reaches a value …"
    assert [wait.asks for wait in listed.values()] == [False] * 4 + [True] * 4


def test_the_pair_under_the_cursor_is_not_listed_twice() -> None:
    last = lake().counters.last_step
    listed = found(lake(), cursor=last.updated_pair)
    assert "value last" not in listed
    assert "value cursor" in listed


def test_without_a_cell_it_says_how_to_choose_one() -> None:
    refused = found(lake(step=0))["value cursor"].refused
    assert refused == "no cell is chosen. tab: the table, arrows: a cell"


def test_what_each_wait_tells_the_run() -> None:
    listed = found(student(), cursor=3)
    assert listed["reward"].until() == Until(Event.REWARD)
    assert listed["optimal"].until() == Until(Event.OPTIMAL)
    assert listed["step"].until(5000) == Until(Event.STEP, number=5000)
    assert listed["episode"].until(7.0) == Until(Event.EPISODE, number=7)
    assert listed["value cursor"].until(0.5) == Until(Event.VALUE, pair=3, threshold=0.5)


def test_a_bandit_has_pulls_and_arms_and_gives_nothing_away() -> None:
    listed = found(bandit(500), cursor=3)
    assert "episode" not in listed
    assert "end" not in listed
    assert listed["optimal"].name == "the greedy arm is the best one"
    assert listed["step"].name == "a pull by its number …"
    assert listed["value cursor"].name == "Q(3) reaches a value …"
    words = " ".join(f"{wait.name} {wait.hint}" for wait in listed.values())
    assert "1.5" not in words  # the true mean of the best arm
    assert "episode" not in words


def test_a_planner_has_sweeps_and_no_rewards() -> None:
    listed = found(planning())
    assert "no rewards" in listed["reward"].refused
    assert listed["end"].name == "the end of the sweep"
    assert listed["episode"].name == "a sweep by its number …"
    assert listed["step"].name == "a backup by its number …"


def test_without_an_exact_answer_nobody_knows_when_a_policy_is_optimal() -> None:
    refused = found(stepped_lake())["optimal"].refused
    assert refused == "no exact values: this environment has no transition table"


def test_numbers_are_read_and_those_in_the_past_are_not() -> None:
    snapshot = lake(step=0)
    listed = found(changed(snapshot, step=120, episodes=9))
    now = changed(snapshot, step=120, episodes=9)
    assert read(listed["step"], now, "121") == 121
    assert read(listed["step"], now, " 1,000 ") == 1000
    assert read(listed["episode"], now, "11") == 11
    for wait, text, expected in (
        ("step", "120", "type a whole number, 121 or more. m g: go back"),
        ("step", "soon", "type a whole number, 121 or more. m g: go back"),
        ("episode", "10", "type a whole number, 11 or more. m g: go back"),
        ("episode", "", "type a whole number, 11 or more. m g: go back"),
    ):
        with pytest.raises(ValueError, match=expected):
            read(listed[wait], now, text)


def test_a_pull_is_within_the_budget() -> None:
    snapshot = bandit(500)
    with pytest.raises(ValueError, match="type a whole number from 501 to 1,000"):
        read(found(snapshot)["step"], snapshot, "1001")
    assert ask_number(found(snapshot)["step"], snapshot, GLYPHS).typed == "1000"


def test_a_value_is_any_finite_number_but_the_one_it_is() -> None:
    snapshot = lake()
    wait = found(snapshot, cursor=17)["value cursor"]
    assert read(wait, snapshot, "−0.25") == -0.25
    assert read(wait, snapshot, "1e-3") == 0.001
    for text in ("", "nan", "inf", "much"):
        with pytest.raises(ValueError, match=r"type a number, such as 0\.5"):
            read(wait, snapshot, text)
    with pytest.raises(ValueError, match="this is its value now"):
        read(wait, snapshot, repr(float(snapshot.agent.q[17])))
