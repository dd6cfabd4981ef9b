"""A policy that a person draws."""

from __future__ import annotations

import json
import shlex
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from autosaving import OPENED, kept, only
from click.testing import CliRunner
from playing import begin, do
from recipes import recipe
from session_samples import after, fresh

from rl_tui.agents.exact.policy_figures import figures
from rl_tui.commands.main import program
from rl_tui.live.commands import ClearDrawing, DrawAction, Restart, Step, StudyPolicy
from rl_tui.live.sessions.session import SessionError, checksum_of, encoded, read_session
from rl_tui.runs.answers.policy_kind import PolicyKind
from rl_tui.runs.answers.policy_values import DrawnPolicy, left_to_chance
from rl_tui.runs.export.tables import evaluate_line, policy_text
from rl_tui.runs.recipe import Recipe
from rl_tui.runs.recipe import begin as begin_run
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

LEFT, DOWN, RIGHT, UP = range(4)
SHORTEST = DrawnPolicy(((0, DOWN), (4, DOWN), (8, RIGHT), (9, DOWN), (13, RIGHT), (14, RIGHT)))


def table_of(made_from: Recipe) -> TabularMDP:
    mdp = begin_run(made_from).world.mdp
    assert mdp is not None
    return mdp


# Its actions


def test_it_does_what_was_chosen_and_elsewhere_anything() -> None:
    lake = table_of(recipe("frozenlake"))
    chances = DrawnPolicy().with_action(4, UP).with_action(0, DOWN).chances(lake)
    assert chances[list(lake.pairs_of(0))].tolist() == [0.0, 1.0, 0.0, 0.0]
    assert chances[list(lake.pairs_of(1))].tolist() == [0.25] * 4


def test_a_choice_takes_the_place_of_the_one_before_and_can_be_taken_away() -> None:
    drawn = DrawnPolicy().with_action(4, UP).with_action(0, DOWN).with_action(4, LEFT)
    assert drawn.choices == ((0, DOWN), (4, LEFT))
    assert drawn.with_action(0, None).with_action(7, None).choices == ((4, LEFT),)


def test_the_shortest_way_reaches_the_goal_and_leaves_nothing_to_chance_but_on_slippery_ice() -> None:
    lake, slippery = table_of(recipe("frozenlake")), table_of(recipe("frozenlake-slippery"))
    of_way = figures(lake, SHORTEST.chances(lake), 0.95)
    assert of_way.expected_return == 1.0
    assert of_way.steps == 6.0
    assert of_way.value_at_start == pytest.approx(0.95**5, abs=1e-12)
    assert not left_to_chance(lake, SHORTEST).any()
    assert left_to_chance(slippery, SHORTEST).sum() == 5  # all live states off the path
    assert left_to_chance(lake, DrawnPolicy()).sum() == 11


# On the player


def test_commands_draw_and_the_run_knows_nothing_of_it() -> None:
    made_from = recipe("frozenlake")
    drawing, plain = begin(made_from), begin(made_from)
    do(drawing, Step(), StudyPolicy(PolicyKind.DRAWN), DrawAction(0, RIGHT), DrawAction(1, RIGHT), Step())
    seen = do(drawing, DrawAction(1, None), Step())
    assert seen.answers.drawn.choices == ((0, RIGHT),)
    left = seen.answers.left_to_chance
    assert left.sum() == 10
    alone = do(plain, Step(), Step(), Step())
    assert seen.agent.q.tobytes() == alone.agent.q.tobytes()
    assert drawing.record.lanes == plain.record.lanes
    assert do(drawing, ClearDrawing()).answers.drawn == DrawnPolicy()


@pytest.mark.parametrize(("state", "action"), [(0, 4), (5, 0), (16, 0), (-1, 0)])
def test_what_is_no_action_is_not_drawn(state: int, action: int) -> None:
    playback = begin(recipe("frozenlake"))
    seen = do(playback, DrawAction(state, action))
    assert seen.answers.drawn == DrawnPolicy()
    assert seen.playback.paused_by


def test_drawing_is_a_deed_and_looking_at_it_is_none() -> None:
    playback = begin(recipe("student"))
    do(playback, StudyPolicy(PolicyKind.DRAWN))
    assert not playback.touched
    do(playback, DrawAction(0, 0))
    assert playback.touched
    assert playback.record.drawn.choices == ((0, 0),)


def test_a_restart_keeps_it_while_the_states_are_the_same() -> None:
    made_from = recipe("frozenlake")
    playback = begin(made_from)
    do(playback, DrawAction(0, DOWN), Step())
    assert do(playback, Restart(replace(made_from, seed=7))).answers.drawn.choices == ((0, DOWN),)
    assert do(playback, Restart(recipe("student"))).answers.drawn == DrawnPolicy()


def test_a_map_drawn_from_another_seed_drops_it() -> None:
    made_from = recipe("frozenlake-random", seed=1)
    assert made_from.scenario.section.drawn_from_seed
    playback = begin(made_from)
    state = int(np.flatnonzero(np.diff(table_of(made_from).first_pair))[0])
    action = int(table_of(made_from).pair_action[table_of(made_from).pairs_of(state).start])
    assert do(playback, DrawAction(state, action)).answers.drawn.choices == ((state, action),)
    assert do(playback, Restart(replace(made_from, seed=2))).answers.drawn == DrawnPolicy()


# In sessions

PLAIN = fresh(recipe("frozenlake"))
DRAWN = replace(PLAIN, drawn=SHORTEST)


def rewritten(path: Path, drawn: Any) -> Path:
    fields = {**json.loads(encoded(DRAWN)), "drawn": drawn}
    del fields["checksum"]
    path.write_text(json.dumps({**fields, "checksum": checksum_of(fields)}), encoding="utf-8")
    return path


def test_sessions_keep_it_and_those_without_one_are_as_they_were(tmp_path: Path) -> None:
    path = tmp_path / "a.json"
    path.write_bytes(encoded(DRAWN))
    assert json.loads(path.read_text(encoding="utf-8"))["drawn"][0] == [0, DOWN]
    assert read_session(path).record().drawn == SHORTEST
    assert not read_session(path).is_blank
    assert "drawn" not in json.loads(encoded(PLAIN))
    path.write_bytes(encoded(PLAIN))
    assert read_session(path).record().drawn == DrawnPolicy()


def test_what_fits_no_state_of_the_world_is_dropped(tmp_path: Path) -> None:
    path = rewritten(tmp_path / "a.json", [[9, 3], [0, 1], [5, 0], [0, 2], [3, 77], [10**9, 0]])
    record = read_session(path).record()
    playback = begin(PLAIN.lanes[0].recipe, record)
    assert playback.snapshot().answers.drawn.choices == ((0, RIGHT), (9, UP))


@pytest.mark.parametrize(
    "drawn", ["none", [[1]], [[1, 2, 3]], [[0, -1]], [["0", 1]], [[0, 1.5]], [[0, 1]] * 100_001, {"0": 1}]
)
def test_a_broken_one_is_refused_in_a_line(tmp_path: Path, drawn: Any) -> None:
    with pytest.raises(SessionError) as refused:
        read_session(rewritten(tmp_path / "a.json", drawn)).record()
    assert "drawn" in str(refused.value)
    assert "\n" not in str(refused.value)


def test_what_was_drawn_before_the_first_step_is_kept_by_itself(tmp_path: Path) -> None:
    kept(tmp_path, replace(OPENED, drawn=DrawnPolicy(((0, 1),))))
    assert only(tmp_path).record().drawn.choices == ((0, 1),)
    assert after(OPENED, 0).drawn == DrawnPolicy()


# In files


@pytest.mark.parametrize(
    ("scenario", "drawn", "gamma"),
    [
        ("frozenlake", SHORTEST, 0.95),
        ("frozenlake-slippery", SHORTEST, 0.5),
        ("student", DrawnPolicy(((0, 0), (1, 3))), 0.9),
    ],
)
def test_the_command_says_of_the_file_what_the_drawing_is_worth(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, scenario: str, drawn: DrawnPolicy, gamma: float
) -> None:
    monkeypatch.chdir(tmp_path)
    made_from = recipe(scenario, gamma=gamma)
    mdp = table_of(made_from)
    Path("my policy.json").write_text(policy_text(mdp, drawn), encoding="utf-8")
    words = shlex.split(evaluate_line(made_from, "my policy.json"))
    assert words[:3] == ["rl-tui", "evaluate", scenario]
    answer = json.loads(CliRunner().invoke(program, [*words[1:], "--json"]).stdout)
    expected = figures(mdp, drawn.chances(mdp), gamma)
    assert answer["gamma"] == gamma
    assert answer["value_at_start"] == expected.value_at_start
    assert answer["expected_return"] == expected.expected_return
    assert list(answer["V"].values()) == expected.v.tolist()


def test_the_command_names_the_seed_where_the_map_comes_of_it() -> None:
    assert "--seed 3" in evaluate_line(recipe("frozenlake-random", seed=3), "a.json")
    assert "--seed" not in evaluate_line(recipe("frozenlake", seed=3), "a.json")
