"""Estimates, episodes and drawn policy as files."""

from __future__ import annotations

import csv
import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from rl_tui.common.errors import UserError
from rl_tui.common.files import new_file
from rl_tui.common.findings import command_line
from rl_tui.runs.answers.policy_values import DrawnPolicy
from rl_tui.runs.changes import written_value
from rl_tui.runs.export.recipe_line import allowance, scenario_name
from rl_tui.runs.policy_file import policy_document
from rl_tui.runs.recipe import JournalEntry, Recipe, begin
from rl_tui.runs.run import Run
from rl_tui.runs.training.episode_rows import HEADER, EpisodeRows
from rl_tui.runs.training.seeded_runs import Goal, OnProgress, no_progress, train
from rl_tui.worlds.mdp.space import FiniteSpace, FloatArray, IntArray
from rl_tui.worlds.world import World

# The drawn policy, and the command that evaluates it


def policy_text(space: FiniteSpace, drawn: DrawnPolicy) -> str:
    """Format `drawn` as the JSON that `rl-tui evaluate` reads."""
    return json.dumps(policy_document(space, drawn.pairs(space)), indent=1, ensure_ascii=False) + "\n"


def evaluate_line(recipe: Recipe, file: str) -> str:
    """Return the command that evaluates the policy in `file`. Raises UserError."""
    scenario = recipe.scenario
    seed = ["--seed", str(recipe.seed)] if scenario.section.drawn_from_seed else []
    gamma = written_value(recipe.hyperparameters.gamma)
    words = ["rl-tui", "evaluate", scenario_name(scenario), *allowance(scenario)]
    return command_line([*words, "--policy", file, "--gamma", gamma, *seed])


def q_array(space: FiniteSpace, q: FloatArray) -> FloatArray:
    """Return `q`, `[P]`, as `[S, A]` with NaN for unavailable actions."""
    table: FloatArray = np.full((space.states, len(space.action_names)), np.nan)
    table[space.pair_state, space.pair_action] = q
    return table


def write_q_array(path: Path, space: FiniteSpace, q: FloatArray) -> None:
    """Write `q_array` as a new .npy file. Raises UserError."""
    with new_file(path) as stream:
        np.save(stream.buffer, q_array(space, q), allow_pickle=False)


def write_q_csv(path: Path, space: FiniteSpace, q: FloatArray, visits: IntArray) -> None:
    """Write estimates and visits, `[P]`, as a new CSV file with all digits, a row per nonterminal state.

    Columns are estimates and visits by action, empty if unavailable. Raises UserError.
    """
    actions = list(space.action_names)
    with new_file(path) as stream:
        rows = csv.writer(stream, lineterminator="\n")
        rows.writerow(["state", *actions, *(f"visits of {action}" for action in actions)])
        for state in np.flatnonzero(np.diff(space.first_pair)).tolist():
            values, counts = [""] * len(actions), [""] * len(actions)
            for pair in space.pairs_of(state):
                place = int(space.pair_action[pair])
                values[place], counts[place] = repr(float(q[pair])), str(int(visits[pair]))
            rows.writerow([space.state_names[state], *values, *counts])


def write_returns(
    path: Path,
    recipe: Recipe,
    journal: Sequence[JournalEntry],
    step: int,
    world: World | None = None,
    on_progress: OnProgress = no_progress,
) -> None:
    """Write all episodes finished by `step` as a new CSV file: run, episode, return, length.

    The run is repeated. An exception of `on_progress` stops it and leaves no file. Raises UserError.
    """
    with new_file(path) as stream:
        stream.write(HEADER)
        run = Run(recipe, begin(recipe, world), evaluate=False, on_episodes=EpisodeRows(stream, 1))
        _do_again(run, journal, step, on_progress)


def estimates_again(
    recipe: Recipe,
    journal: Sequence[JournalEntry],
    step: int,
    world: World | None = None,
    on_progress: OnProgress = no_progress,
) -> tuple[FloatArray, IntArray]:
    """Repeat a run up to `step` and return Q and visits, `[P]` each."""
    run = Run(recipe, begin(recipe, world), evaluate=False)
    _do_again(run, journal, step, on_progress)
    return run.learner.q, run.learner.visits


def _do_again(run: Run, journal: Sequence[JournalEntry], step: int, on_progress: OnProgress) -> None:
    try:
        train(run, Goal(steps=step), on_progress, journal)
    except UserError:
        # a run that breaks down at `step` still has that step
        if run.step < step:
            raise
