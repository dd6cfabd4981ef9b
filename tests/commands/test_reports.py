"""The reports of commands for people."""

from __future__ import annotations

import io
import json
import re
import sys
from dataclasses import replace
from itertools import count
from pathlib import Path

import pytest
from called import printed as report

from rl_tui.commands.line.output import alike, columns, number, progress
from rl_tui.commands.reports.policy_map import policy_map
from rl_tui.commands.reports.training import FIRST_REWARD, TITLES, no_reward
from rl_tui.runs.library import find, recipe_for
from rl_tui.runs.recipe import begin
from rl_tui.worlds.drawing import Graph


def test_train_says_what_was_learned_and_what_could_be() -> None:
    text = report("train", "frozenlake")
    assert "10,000 episodes" in text
    assert "0.95099, optimal 0.95099" in text
    assert "1, optimal 1 " in text


def test_what_is_discounted_and_what_is_not_is_said_beside_each_figure() -> None:
    rows = {line[:18].strip(): line for line in report("train", "frozenlake").splitlines()}
    assert " discounted" in rows["value at the start"]
    assert "undiscounted" in rows["expected return"]
    assert "undiscounted" in rows["last 100 episodes"]
    assert "discounted, returns are not" in report("train", "frozenlake", "--runs", "2")
    assert "discounted" not in report("train", "bandit", "--runs", "2")


def test_a_first_reward_may_be_a_cost() -> None:
    assert "the first reward other than 0" in report("train", "cliff", "--episodes", "3")


def test_a_bandit_gets_lines_of_its_own() -> None:
    text = report("train", "bandit")
    figures = json.loads(report("train", "bandit", "--json"))
    rows = dict(re.split(r"  +", line)[:2] for line in text.splitlines()[4:])
    assert "1,000 pulls in " in text
    assert rows["greedy arm"] == figures["policy"][0][0]
    assert rows["best arm pulled"] == f"{figures['best_arm_rate']:.1%} of the time"
    assert rows["winnings"].split()[0] == f"{figures['winnings']:,.1f}"
    assert rows["regret"] == f"{figures['regret']:,.1f}"
    assert not any(each in text for each in ("episode", "length", TITLES["greedy_ends"], FIRST_REWARD))


def test_many_arms_that_tie_are_counted(tmp_path: Path) -> None:
    file = tmp_path / "arms.toml"
    file.write_text("[bandit]\narms = 50\nstd = 0.0\nmean = { normal = [-9.0, 1.0] }\n", encoding="utf-8")
    assert "greedy arm          49 arms tie " in report("train", str(file), "--steps", "1")


def test_several_runs_of_a_bandit_too() -> None:
    text = report("train", "bandit", "--runs", "3")
    assert "\nwinnings " in text
    assert "\nregret " in text
    assert "\nbest arm, share of pulls " in text
    assert "\nreward, last 100 pulls " in text
    assert not any(each in text for each in ("episode", "length", FIRST_REWARD))


@pytest.mark.parametrize(
    ("args", "shown"),
    [
        (("frozenlake",), "\nlast 100 episodes "),
        (("student", "--episodes", "7"), "\nlast 7 episodes "),
        (("student", "--episodes", "1"), "\nlast episode "),
        (("frozenlake", "--steps", "1"), "\nlast episodes       none is finished"),
        (("student", "--episodes", "7", "--runs", "2"), "\nreturn, last 7 episodes "),
        (("student", "--steps", "300", "--runs", "3"), "\nreturn, last 8 episodes or fewer "),
        (("bandit", "--episodes", "1"), "\nlast pull "),
    ],
)
def test_means_say_over_how_many_episodes_they_are(args: tuple[str, ...], shown: str) -> None:
    assert shown in report("train", *args)


def test_whether_the_greedy_policy_ends_is_a_probability() -> None:
    assert "greedy policy ends  with probability 1\n" in report("train", "frozenlake")


def test_one_is_singular() -> None:
    assert "\n0 episodes, 1 step in" in report("train", "frozenlake", "--steps", "1")
    assert "\n1 episode, " in report("train", "student", "--episodes", "1")
    assert "\n1 pull in" in report("train", "bandit", "--episodes", "1")


@pytest.mark.parametrize("runs", [(), ("--runs", "2")])
def test_train_says_why_no_reward_was_seen(runs: tuple[str, ...]) -> None:
    text = report("train", "frozenlake", "--ties", "first", "--episodes", "100", *runs)
    assert "never" in text
    assert "Try --ties random" in text


def test_runs_whose_greedy_policy_never_ends_are_told() -> None:
    text = report("train", "cliff", "--algorithm", "sarsa", "--runs", "22")
    rows = {line.split("  ")[0]: line.split() for line in text.splitlines()}
    assert (rows["expected return"][-1], rows["episodes"][-1]) == ("21", "22")
    assert "In 1 of 22 runs the greedy policy may never end" in text
    assert "never end" not in report("train", "cliff", "--runs", "2")


def test_other_reasons_for_no_reward_get_other_advice() -> None:
    text = report("train", "frozenlake", "--steps", "3")
    assert "Try more --episodes" in text


def test_only_runs_without_a_reward_are_said_to_have_learned_nothing() -> None:
    lake = recipe_for(find("frozenlake"), {"ties": "first"})
    assert no_reward(lake).startswith("This run never saw a reward and learned nothing: ")
    assert no_reward(lake, 94, 100).startswith("94 of 100 runs never saw a reward and learned nothing: ")
    command = ("train", "frozenlake", "--episodes", "60", "--runs", "10")
    runs = json.loads(report(*command, "--json"))["runs"]
    blind = sum(row["first_reward_episode"] is None for row in runs)
    assert 0 < blind < 10
    assert f"\n{blind} of 10 runs never saw a reward and learned nothing. Try more --episodes" in report(
        *command
    )


def test_with_an_initial_q_something_is_learned_without_a_reward() -> None:
    text = report("train", "frozenlake", "--initial-q", "1", "--ties", "first", "--steps", "5")
    assert "never saw a reward." in text
    assert "--ties random" not in text


def test_solve_says_what_it_counts_and_which_policies_know_the_time_left() -> None:
    text = report("solve", "student")
    assert "(1 round of evaluation and improvement)" in text
    assert "undiscounted, within 100 steps, of this policy" in text
    assert "likewise, the largest of any policy that knows the time left" in text
    assert "time left" not in report("solve", "bandit")
    assert "Left out: 1 action." in report("solve", "student", "--gamma", "1")
    assert "left out" not in report("solve", "cliff") + report("solve", "windy") + text


def test_actions_come_in_the_order_of_the_screen() -> None:
    head, first = report("solve", "frozenlake").splitlines()[2:4]
    assert re.findall(r"Q (\w+)", head) == ["up", "right", "down", "left"]
    assert re.split(r"  +", first)[-1] == "right, down"
    q = json.loads(report("solve", "frozenlake", "--json"))
    assert q["actions"] == ["left", "down", "right", "up"], "JSON keeps the order of the world"
    assert first.split()[2:6] == [f"{q['q'][0][action]:.5f}" for action in (3, 2, 1, 0)]


def test_solve_draws_the_policy_on_the_map() -> None:
    lines = report("solve", "frozenlake").splitlines()
    assert "→↓  →   ↓  ←" in lines
    assert "●   →   →  ★" in lines
    assert any(line.split()[:2] == ["14", "1.00000"] for line in lines)


def test_where_all_actions_look_alike_the_map_shows_a_dot() -> None:
    world = begin(recipe_for(find("frozenlake"))).world
    names = list(world.space.action_names)
    drawing = policy_map(world, [names if world.space.pairs_of(state) else [] for state in range(16)])
    assert drawing.splitlines() == [".  .  .  .", ".  ●  .  ●", ".  .  .  ●", "●  .  .  ★"]


def test_without_a_map_the_first_hundred_states_are_listed() -> None:
    world = begin(recipe_for(find("blackjack"))).world
    listed = policy_map(replace(world, drawing=Graph(())), [["hit"]] * 704).splitlines()
    assert [line.split()[-1] for line in listed] == ["greedy", *["hit"] * 100, "all"]
    assert listed[-1] == "... and 604 more: --json has all"


def test_a_terminal_without_arrows_gets_ascii(monkeypatch: pytest.MonkeyPatch) -> None:
    world = begin(recipe_for(find("frozenlake"))).world
    policy = [["right"] if world.space.pairs_of(state) else [] for state in range(16)]
    monkeypatch.setattr(sys, "stdout", io.TextIOWrapper(io.BytesIO(), encoding="ascii"))
    assert policy_map(world, policy).splitlines()[3] == "O  >  >  G"


def test_list_fits_80_columns() -> None:
    lines = report("list").splitlines()
    assert lines[0].split()[0] == "id"
    assert len(lines) >= 7
    assert max(map(len, lines[:7])) <= 80


def test_columns_are_aligned_by_what_is_seen() -> None:
    assert columns([("a", "1"), ("日本", "22")], right=(1,)) == "a      1\n日本  22"


def test_numbers() -> None:
    assert number(None) == "-"
    assert number("sample-average") == "sample-average"
    assert number(0.123456) == "0.12346"


class _Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_a_bar_is_drawn_on_a_terminal_only(monkeypatch: pytest.MonkeyPatch) -> None:
    for stream, drawn in ((io.StringIO(), False), (_Terminal(), True)):
        monkeypatch.setattr(sys, "stderr", stream)
        with progress("training") as on_progress:
            for done in (0, 3, 7, 9):
                on_progress(done, 7)
        assert bool(stream.getvalue()) is drawn
    assert "100%" in stream.getvalue()
    assert "9 of 7" in stream.getvalue()


def test_what_has_no_end_is_told_for_as_long_as_it_takes(monkeypatch: pytest.MonkeyPatch) -> None:
    stream, clock = _Terminal(), count(step=2)
    monkeypatch.setattr(sys, "stderr", stream)
    monkeypatch.setattr("click._termui_impl.time.time", lambda: next(clock))
    with progress("script.py", has_end=False) as bar:
        for steps in range(3):
            bar.say(f"{steps} steps")
    assert "script.py  2 steps" in stream.getvalue()


def test_figures_beside_one_another_have_as_many_decimals() -> None:
    assert alike([0.71, 0.0012, 0.6, None]) == ["0.7100", "0.0012", "0.6000", "-"]
    assert alike([-3.17e-36, 0.0, 0.5]) == ["0.0", "0.0", "0.5"]
    assert alike([1.0, 1.0]) == ["1", "1"]
    assert alike([-43.25, 1e-7, -1e-7]) == ["-43.25", "<0.01", ">-0.01"]
    assert alike([-3.17e-36, -0.0]) == ["0", "0"]
    assert alike([4e-7, 3.2e-8, 0.0]) == ["4.000e-07", "3.200e-08", "0"]
    assert number(-3.17e-36) == "0"
