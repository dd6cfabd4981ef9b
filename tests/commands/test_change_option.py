"""``train --change``, of settings, actions and the world."""

from __future__ import annotations

import json
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from called import assert_refused, called

from rl_tui.live.record import Record
from rl_tui.live.sessions.session import encoded
from rl_tui.runs.changes import journal_of, read_change
from rl_tui.runs.library import recipe_named
from rl_tui.runs.timeline.branches import Branch, RunRecord

MAP = """\
title = "Two ways"
[grid]
step_reward = -1
map = '''
S..
.#.
..G
'''
"""
DRAWN = """\
title = "Drawn from the seed"
[bandit]
arms = 3
budget = 50
"""
train = partial(called, "train")


def trained(*args: str) -> dict[str, Any]:
    result = train(*args, "--json")
    assert result.exit_code == 0, result.stderr
    document: dict[str, Any] = json.loads(result.stdout)
    return document


@pytest.fixture
def world(tmp_path: Path) -> str:
    file = tmp_path / "ways.toml"
    file.write_text(MAP, encoding="utf-8")
    return str(file)


def test_an_edit_at_the_start_is_the_run_of_a_file_with_that_map(world: str, tmp_path: Path) -> None:
    drawn = tmp_path / "drawn.toml"
    drawn.write_text(MAP.replace(".#.", "..."), encoding="utf-8")
    edited = trained(world, "--steps", "300", "--change", "0:world.cell[1,1]=.")
    whole = trained(str(drawn), "--steps", "300")
    for name in ("world", "states", "q", "visits", "optimal_value_at_start", "max_error", "expected_return"):
        assert edited[name] == whole[name], name
    assert edited["journal"] == [{"step": 0, "name": "world", "value": "world.cell[1,1]=."}]


def test_exact_figures_are_those_of_the_world_at_the_end(world: str) -> None:
    before = trained(world, "--steps", "300", "--gamma", "0.9")
    after = trained(world, "--steps", "300", "--gamma", "0.9", "--change", "200:world.cell[0,1]=G")
    undone = trained(
        world,
        "--steps",
        "300",
        "--gamma",
        "0.9",
        "--change",
        "200:world.cell[0,1]=G",
        "--change",
        "250:world.undo=1",
    )
    assert after["world"] != before["world"] == undone["world"]
    assert after["optimal_value_at_start"] > before["optimal_value_at_start"]
    assert undone["optimal_value_at_start"] == before["optimal_value_at_start"]


def test_a_stepped_environment_has_no_table_to_tell() -> None:
    assert trained("blackjack", "--episodes", "1")["world"] is None


def test_an_action_may_be_there_only_after_an_edit(world: str) -> None:
    take = ("--change", "6:take=down-right")
    assert "6:take=down-right: there is no such action" in train(world, "--steps", "20", *take).stderr
    document = trained(world, "--steps", "20", "--change", "5:world.moves=king", *take)
    assert document["journal"][1] == {"step": 6, "name": "take", "value": "down-right"}
    assert "down-right" in document["actions"]


def test_each_seed_edits_the_world_that_it_drew(tmp_path: Path) -> None:
    file = tmp_path / "drawn.toml"
    file.write_text(DRAWN, encoding="utf-8")
    change = ("--steps", "40", "--change", "10:world.arm[1]=7")
    together = trained(str(file), "--runs", "2", *change)
    alone = [trained(str(file), "--seed", str(seed), *change) for seed in (0, 1)]
    for name in ("world", "max_error", "expected_return"):
        assert [row[name] for row in together["runs"]] == [each[name] for each in alone], name
    assert alone[0]["world"] != alone[1]["world"]
    assert together["journal"] == alone[0]["journal"]


@pytest.mark.parametrize(
    ("change", "fault", "status"),
    [
        ("10:world.cell[9,1]=#", "10:world.cell[9,1]=#: cell[9,1]", 1),
        ("10:world.cell[0,0]=.", "10:world.cell[0,0]=.: grid.map", 1),
        ("10:world.undo=1", "10:world.undo=1: there is no edit", 1),
        ("10:world.redo=1", "10:world.redo=1: there is no edit", 1),
        ("10:world.undo=2", 'world.undo is "2"; expected world.undo=1', 2),
        ("10:world.rows=+1@9", "rows=+1@9: the rows are numbered from 0 to 2", 1),
        ("10:world.rows=+0@1", "such as +1@3", 1),
        (
            "10:world.noise=$(rm -rf /)",
            'grid.noise: found "$(rm -rf /)"; expected a finite number from 0 to 1',
            1,
        ),
        ("10:world.noise=nan", "expected a finite number", 1),
        ("10:world.noise[1,2]=0.3", "noise applies to the whole world", 1),
        ("10:world.reward[1,1]=5", '"#" has no reward', 1),
        ("10:world.reward[0,1]=1e400", "expected a finite number", 1),
        ("10:world.cell[0,1]=\x1b", '"\\u001b" is not a character of a map', 1),
        ("10:world.cell[0,1]=##", "separate edits by ;", 2),
        ("10:world.arm[0]=1", 'a map has nothing called "arm"', 1),
        ("10:World.cell[1,1]=#", "or a change of the world such as world.cell[1,2]=#", 2),
        (f"10:world.legend[x]={'[' * 3000}", "expected JSON", 2),
        (f"10:world.noise={'9' * 5000}", "expected a finite number", 1),
        ("10:world.cell[1", "expected , or ]", 2),
        ("ten:world.cell[1,1]=#", "is not a whole number of steps", 2),
    ],
)
def test_faults_name_the_step_and_the_edit_in_one_line(
    world: str, change: str, fault: str, status: int
) -> None:
    result = train(world, "--steps", "50", "--change", change)
    assert_refused(result, status, fault)
    assert len(result.stderr) < 600


@pytest.mark.parametrize(
    ("scenario", "change"),
    [
        ("maze", "world.cell[1,1]=#"),
        ("maze", "world.reward[1,1]=-1"),
        ("maze", "world.noise=0.2"),
        ("maze", "world.rows=+1@3"),
        ("student", 'world.transition[Class,study]={"to":{"Pass":0.5,"Class":0.5},"reward":-1}'),
        ("student", 'world.transition[Class,"check phone"]={"to":{"Phone":0.9,"Class":0.1},"reward":0}'),
        ("bandit", "world.arm[1]=5"),
        ("cliff", "world.cell[3,5]=."),
        ("frozenlake", "world.cell[1,1]=."),
    ],
)
def test_each_edit_of_the_contract_counts_and_a_session_of_it_replays(
    scenario: str, change: str, tmp_path: Path
) -> None:
    plain = trained(scenario, "--steps", "90")
    edited = trained(scenario, "--steps", "90", "--change", f"40:{change}")
    assert edited["world"] != plain["world"]
    made_from = recipe_named(scenario, {}, 0)
    journal = journal_of([read_change(f"40:{change}")], ())
    branch = Branch("branch 1", journal, end=90, here=90)
    session = tmp_path / "session.json"
    session.write_bytes(encoded(Record((RunRecord(made_from, (branch,)),))))
    result = called("replay", session, "--json")
    assert (result.exit_code, result.stderr) == (0, "")
    replayed = json.loads(result.stdout)
    for name in ("world", "journal", "states", "actions", "q", "visits", "episodes", "steps"):
        assert replayed[name] == edited[name], name


def test_a_world_that_cannot_be_drawn_says_why() -> None:
    for scenario, why in (("taxi", "not cells of a map"), ("blackjack", "no transition table")):
        result = train(scenario, "--steps", "50", "--change", "10:world.cell[0,0]=.")
        assert (result.exit_code, result.stdout) == (1, "")
        assert why in result.stderr
        assert result.stderr.count("\n") == 1


student = partial(called, "train", "student")


def test_the_report_tells_what_was_changed() -> None:
    result = student("--steps", "200", "--change", "150:gamma=0.5", "--change", "40:epsilon=0")
    assert result.exit_code == 0
    lines = result.stdout.splitlines()
    assert [line.split() for line in lines[2:5]] == [
        ["step", "changed", "to"],
        ["after", "40", "epsilon", "0"],
        ["after", "150", "gamma", "0.5"],
    ]


def test_many_changes_are_cut_off_in_the_report() -> None:
    changes = [word for step in range(25) for word in ("--change", f"{step}:epsilon=0.{step + 1:02}")]
    assert "... and 5 more: --json has all" in student("--steps", "30", *changes).stdout


def test_json_has_the_journal_only_where_there_are_changes() -> None:
    assert "journal" not in json.loads(student("--steps", "50", "--json").stdout)
    document = json.loads(student("--steps", "50", "--json", "--change", "10:take=study").stdout)
    assert document["journal"] == [{"step": 10, "name": "take", "value": "study"}]


def test_a_change_after_the_end_is_told_to_have_no_effect() -> None:
    result = student("--steps", "50", "--change", "51:gamma=0.5")
    assert result.exit_code == 0
    assert result.stderr == "--change 51:gamma=0.5 has no effect: the run ends after 50 steps\n"


def test_settings_of_the_last_step_count_and_a_step_beyond_does_not() -> None:
    result = student("--steps", "50", "--json", "--change", "50:gamma=0.5", "--change", "50:take=study")
    assert json.loads(result.stdout)["steps"] == 50
    assert result.stderr == "--change 50:take=study has no effect: the run ends after 50 steps\n"


@pytest.mark.parametrize(
    ("args", "fault", "status"),
    [
        (["--change", "5:epsilon=2"], 'epsilon is "2"; expected a number in [0, 1]', 2),
        (["--change", "nonsense"], "is not STEP:NAME=VALUE", 2),
        (["--change", "5:take=study", "--runs", "2"], "take=ACTION works for a single run only", 2),
        (["--change", "5:take=sleeep"], '(did you mean "sleep"?)', 1),
        (["--change", "0:take=sleep"], "sleep is not available in state Class", 1),
        (["--change", "5:policy=gradient"], "policy gradient is for bandits", 1),
    ],
)
def test_faults_are_one_line(args: list[str], fault: str, status: int) -> None:
    assert_refused(student("--steps", "50", *args), status, fault)
