"""Exports of a run with an edited world."""

from __future__ import annotations

import json
import shlex
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from edited_worlds import edit, small_bandit, small_graph, small_map
from export_samples import q_of, ran
from playing import begin, do
from recipes import recipe, replay

from rl_tui.agents.exact.solve import solve
from rl_tui.commands.main import program
from rl_tui.common.errors import UserError
from rl_tui.live.commands import Apply, DrawWorld, GoTo, RedoStroke, Step, Take, Train, UndoStroke
from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.export.recipe_line import LONGEST_LINE, recipe_line
from rl_tui.runs.export.tables import write_q_csv, write_returns
from rl_tui.runs.recipe import JournalEntry, Recipe, SetParameter, SwitchAlgorithm
from rl_tui.screen.playground.actions.export import script_of
from rl_tui.worlds.mdp.digest import table_digest

pytestmark = pytest.mark.unit


def draw(text: str) -> DrawWorld:
    return DrawWorld(edit(text).edits)


def in_a_file(made_from: Recipe, folder: Path) -> Recipe:
    path = folder / "my small.toml"
    path.write_text(made_from.scenario.text, encoding="utf-8")
    return replace(made_from, scenario=replace(made_from.scenario, source=path))


WORLDS: dict[str, tuple[Callable[[], Recipe], tuple[str, ...]]] = {
    "map": (small_map, ("rows=+1@1", "reward[2,1]=-0.5;cell[0,1]=^", "noise=0", "cell[3,1]=H")),
    "graph": (
        small_graph,
        (
            'transition["Class","it\'s $HOME"]={"to":{"Pass":0.5,"Jail & `x`":0.5},"reward":1}',
            'transition["Jail & `x`","wait"]={"to":"Class","reward":-3}',
            "time_limit=7",
            'start="Phone"',
        ),
    ),
    "bandit": (small_bandit, ("arm[2]=7", "arms=+1@0", "std=0.25", "arms=-1@5")),
    "lake": (
        lambda: recipe("frozenlake-slippery"),
        ("cell[1,1]=.", "columns=+1@2", "step_reward=-0.1", "cell[0,3]=G"),
    ),
    "cliff": (lambda: recipe("cliff"), ("cell[3,5]=.", "cell[2,5]=#", "noise=0.1", "rows=-1@0")),
    "maze drawn from the seed": (
        lambda: recipe("frozenlake-random", seed=4),
        ("cell[0,1]=.", "rows=+1@1", "noise=0.1", "cell[1,1]=H"),
    ),
}


def edited(name: str, folder: Path) -> Snapshot:
    make, strokes = WORLDS[name]
    made_from = make()
    playback = begin(in_a_file(made_from, folder) if made_from.scenario.id == "small" else made_from)
    first, second, third, last = map(draw, strokes)
    do(playback, Train(40), first, Train(20), Take(1), second, UndoStroke(), Train(10), RedoStroke(), Step())
    do(playback, third, Apply(SetParameter("alpha", 0.5)), Take(0), Train(300), GoTo(200), last)
    return do(playback, Apply(SwitchAlgorithm("expected-sarsa")), Train(50))


@pytest.mark.parametrize("name", WORLDS)
def test_the_command_does_it_again_to_the_bit(name: str, tmp_path: Path) -> None:
    shown = edited(name, tmp_path)
    mdp = shown.world.mdp
    assert mdp is not None
    journal = shown.timeline.current.journal
    line = recipe_line(shown.recipe, journal, shown.counters.step, ())
    command, *words = shlex.split(line)
    result = CliRunner().invoke(program, [*words, "--json"])
    assert (command, result.exit_code, result.stderr) == ("rl-tui", 0, "")
    document = json.loads(result.stdout)
    assert document["world"] == table_digest(mdp)
    assert document["steps"] == shown.counters.step
    q, visits = np.array(document["q"], np.float64), np.array(document["visits"], np.float64)
    assert np.array_equal(q[mdp.pair_state, mdp.pair_action], shown.agent.q)
    assert np.array_equal(visits[mdp.pair_state, mdp.pair_action], shown.agent.visits)
    assert [entry["step"] for entry in document["journal"]] == [entry.step for entry in journal]


@pytest.mark.parametrize("name", WORLDS)
def test_the_script_is_one_of_the_world_as_it_was_drawn(name: str, tmp_path: Path) -> None:
    playback_of = edited(name, tmp_path)
    planned = replace(playback_of, agent=replace(playback_of.agent, algorithm="value-iteration"))
    text = script_of(planned)
    assert "or another world at first" in " ".join(text.split())
    names, mdp = ran(text, "# How good is it?"), planned.world.mdp
    live = [state for state in range(mdp.states) if mdp.pairs_of(state)]
    assert len(names["states"]) == len(live)
    best = solve(mdp, planned.agent.hyperparameters.gamma).q
    assert np.abs(q_of(names, mdp) - best).max() < 1e-6
    assert compile(script_of(playback_of), name, "exec")


def test_tables_have_the_states_and_actions_of_the_world_in_force(tmp_path: Path) -> None:
    shown = edited("graph", tmp_path)
    path = tmp_path / "q.csv"
    write_q_csv(path, shown.world.space, shown.agent.q, shown.agent.visits)
    head, *rows = path.read_text(encoding="utf-8").splitlines()
    assert "it's $HOME" in head
    assert any(row.startswith("Jail & `x`,") for row in rows)


def test_returns_are_those_of_the_run_with_its_changes(tmp_path: Path) -> None:
    shown = edited("map", tmp_path)
    journal, step = shown.timeline.current.journal, shown.counters.step
    path = tmp_path / "returns.csv"
    write_returns(path, shown.recipe, journal, step)
    rows = [line.split(",") for line in path.read_text(encoding="utf-8").splitlines()[1:]]
    again = replay(shown.recipe, journal, step)
    assert len(rows) == again.learner.episodes
    assert sum(float(row[2]) for row in rows) == pytest.approx(again.history.total_return)


def test_a_stroke_too_long_for_a_command_is_left_to_the_session() -> None:
    entries = [JournalEntry(1, edit(";".join(["cell[0,0]=S"] * (LONGEST_LINE // 10))))]
    with pytest.raises(UserError, match="too long for one line: save the session"):
        recipe_line(recipe("maze"), entries, 5, ())
