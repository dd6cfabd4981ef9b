"""``gym:ENV_ID`` and environments without a table, on every command."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from called import called as run
from called import document

from rl_tui.commands.reports.policy_map import policy_map
from rl_tui.commands.reports.training import TITLES
from rl_tui.runs.export.recipe_line import recipe_line
from rl_tui.runs.library import find, recipe_for
from rl_tui.runs.recipe import begin

EXACT = ("value_at_start", "optimal_value_at_start", "expected_return", "max_error", "greedy_ends")
BINS = """
[gymnasium]
id = "CartPole-v1"
[gymnasium.bins]
edges = [[], [], [0.0], [0.0]]
"""


def refusal(*args: str) -> str:
    result = run(*args)
    assert (result.exit_code, result.stdout) == (1, "")
    (line,) = result.stderr.splitlines()
    return str(line)


def test_an_environment_with_a_table_has_exact_figures():
    figures = document("train", "gym:FrozenLake-v1", "--episodes", "200")
    assert figures["scenario"] == "gym:FrozenLake-v1"
    assert figures["optimal_value_at_start"] == pytest.approx(0.54203, abs=1e-5)
    solved = document("solve", "gym:FrozenLake-v1")
    assert solved["value_at_start"] == pytest.approx(figures["optimal_value_at_start"])


def test_an_environment_without_one_has_none():
    figures = document("train", "gym:Blackjack-v1", "--episodes", "100")
    assert {name: figures[name] for name in EXACT} == dict.fromkeys(EXACT)
    assert figures["actions"] == ["stick", "hit"]
    assert len(figures["states"]) == len(figures["q"]) == 704
    assert figures["return_last_100"] is not None


def test_many_runs_of_it():
    figures = document("train", "blackjack", "--episodes", "60", "--runs", "3")
    assert [row["value_at_start"] for row in figures["runs"]] == [None] * 3
    assert figures["summary"]["value_at_start"] == {
        "mean": None,
        "stderr": None,
        "min": None,
        "max": None,
        "count": 0,
    }
    assert figures["summary"]["length_last_100"]["count"] == 3


def test_reports_leave_out_what_nobody_knows():
    one = run("train", "blackjack", "--episodes", "60")
    assert one.exit_code == 0
    assert "this environment has no transition table" in one.stdout
    drawing = one.stdout.split("\n\n")[1].splitlines()
    shown = re.fullmatch(r"\(rows (\d+) to (\d+) and columns A to T; nothing is .*\)", drawing[-1])
    assert shown, "by the labels of the screen: the player's sum, the dealer's card"
    top, bottom = map(int, shown.groups())
    assert 21 >= top > bottom >= 4, "a sum below 4 or above 21 is never seen"
    assert len(drawing) == top - bottom + 2
    several = run("train", "blackjack", "--episodes", "60", "--runs", "2")
    assert several.exit_code == 0
    assert TITLES["value_at_start"] not in several.stdout.lower()
    assert "return, last 60 episodes" in several.stdout


def test_a_policy_of_which_nothing_is_known_is_a_sentence():
    world = begin(recipe_for(find("blackjack"), {}, 0)).world
    nothing = [list(world.space.action_names)] * world.space.states
    assert policy_map(world, nothing) == "All actions look equal in every state."
    nothing[16 * 22 + 10 * 2] = ["hit"]
    line = "(rows 16 to 16 and columns T to T; nothing is known outside)"
    assert policy_map(world, nothing) == f"h\n{line}"


def test_bins_of_a_file(tmp_path: Path):
    path = tmp_path / "cart.toml"
    path.write_text(BINS)
    assert run("check", str(path)).stdout == f"{path}: ok\n"
    figures = document("train", str(path), "--episodes", "20")
    assert figures["states"] == ["<0, <0", "<0, >=0", ">=0, <0", ">=0, >=0"]
    assert figures["return_last_100"] == figures["length_last_100"] > 5


@pytest.mark.parametrize(
    ("args", "line"),
    [
        (
            ["solve", "gym:Blackjack-v1"],
            "gym:Blackjack-v1 has no exact values: this environment has no transition table",
        ),
        (["train", "gym:Blackjak-v1"], 'gym:Blackjak-v1: no environment is registered as "Blackjak-v1"'),
        (["train", "gym:CartPole-v1"], "write a scenario file with [gymnasium.bins]"),
        (["train", "gym:Blackjack-v1", "--algorithm", "value-iteration"], "this environment has none"),
        (["bench", "gym:Blackjack-v1"], "choose a scenario such as frozenlake"),
        (["check", "gym:FrozenLake-v1"], "gym:FrozenLake-v1: no such file"),
    ],
)
def test_what_cannot_be_done_is_one_line(args, line):
    assert line in refusal(*args)


def test_the_list_has_the_shipped_ones_and_no_other():
    rows = {row["id"]: row for row in document("list")}
    sizes = {name: (rows[name]["states"], rows[name]["actions"]) for name in ("blackjack", "cartpole")}
    assert sizes == {"blackjack": (704, 2), "cartpole": (72, 2)}
    assert not any(name.startswith("gym:") for name in rows)


def test_a_module_is_imported_by_the_flag_alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    code = "import gymnasium\ngymnasium.register('Flagged-v0', 'gymnasium.envs.toy_text:CliffWalkingEnv')\n"
    (tmp_path / "flagged_environments.py").write_text(code)
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setattr("rl_tui.worlds.gym.modules.ALLOWED", set())
    name, flag = "gym:flagged_environments:Flagged-v0", ("--allow-module", "flagged_environments")
    assert refusal("solve", name).endswith("if you trust it, add --allow-module flagged_environments")
    assert len(document("solve", name, *flag)["states"]) == 48
    line = recipe_line(recipe_for(find(name)), (), 0, ("up", "right", "down", "left"))
    assert line == f"rl-tui train {name} {' '.join(flag)} --seed 0"
