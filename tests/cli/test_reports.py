"""What commands print for people."""

from __future__ import annotations

import io
import sys

import pytest
from click.testing import CliRunner

from rl_tui.cli.main import program
from rl_tui.cli.output import columns, number
from rl_tui.cli.policy_map import policy_map
from rl_tui.cli.progress import progress
from rl_tui.lab.library import find, recipe_for
from rl_tui.lab.recipe import begin


def report(*args: str) -> str:
    result = CliRunner().invoke(program, args)
    assert (result.exit_code, result.stderr) == (0, "")
    return result.stdout


def test_train_says_what_was_learned_and_what_could_be() -> None:
    text = report("train", "frozenlake")
    assert "10,000 episodes" in text
    assert "0.95099 of 0.95099" in text
    assert "1 of 1 " in text


@pytest.mark.parametrize("runs", [(), ("--runs", "2")])
def test_train_says_why_no_reward_was_seen(runs: tuple[str, ...]) -> None:
    text = report("train", "frozenlake", "--ties", "first", "--episodes", "100", *runs)
    assert "never" in text
    assert "Try --ties random" in text


def test_other_reasons_for_no_reward_get_other_advice() -> None:
    text = report("train", "frozenlake", "--steps", "3")
    assert "Try more --episodes" in text


def test_solve_draws_the_policy_on_the_map() -> None:
    lines = report("solve", "frozenlake").splitlines()
    assert "↓→  →   ↓  ←" in lines
    assert "●   →   →  ★" in lines
    assert any(line.split()[:2] == ["14", "1.00000"] for line in lines)


def test_where_all_actions_look_alike_the_map_shows_a_dot() -> None:
    world = begin(recipe_for(find("frozenlake"))).world
    names = list(world.mdp.action_names)
    drawing = policy_map(world, [names if world.mdp.pairs_of(state) else [] for state in range(16)])
    assert drawing.splitlines() == [".  .  .  .", ".  ●  .  ●", ".  .  .  ●", "●  .  .  ★"]


def test_a_terminal_without_arrows_gets_ascii(monkeypatch: pytest.MonkeyPatch) -> None:
    world = begin(recipe_for(find("frozenlake"))).world
    policy = [["right"] if world.mdp.pairs_of(state) else [] for state in range(16)]
    monkeypatch.setattr(sys, "stdout", io.TextIOWrapper(io.BytesIO(), encoding="ascii"))
    assert policy_map(world, policy).splitlines()[3] == "O  >  >  *"


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
