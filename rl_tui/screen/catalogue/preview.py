"""Moments of a short run on the start screen."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Final

import numpy as np
from rich.console import RenderableType
from rich.text import Text

from rl_tui.agents.catalogue import BY_ID
from rl_tui.agents.exact.policy_evaluation import Solution
from rl_tui.common.errors import UserError
from rl_tui.common.streams import streams
from rl_tui.live.pace.stop_condition import is_optimal
from rl_tui.live.sessions.session import StoredSession
from rl_tui.live.snapshot import AgentView, PlaybackView, Snapshot
from rl_tui.live.snapshot_builder import SnapshotBuilder
from rl_tui.runs.figures import optimum_of
from rl_tui.runs.large_worlds import is_large
from rl_tui.runs.library import recipe_for
from rl_tui.runs.recipe import UNLIMITED, begin
from rl_tui.runs.results import RunResults
from rl_tui.runs.run import Run
from rl_tui.screen.catalogue.facts import PartsLine
from rl_tui.screen.draw import numbers
from rl_tui.screen.theme.look import Look
from rl_tui.worlds.files.catalogue import YOURS, group_of
from rl_tui.worlds.files.scenario import Scenario
from rl_tui.worlds.mdp.space import FloatArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP
from rl_tui.worlds.world import World

SEED: Final = 0
MOMENTS: Final = 24
STEPS: Final = 3_000
PLANNING_STEPS: Final = 300
_MOST_STEPS: Final = 20_000
_MOST_ANSWERS: Final = 32
_ROWS: Final = 3  # of the area
_EIGHTHS: Final = " ▁▂▃▄▅▆▇█"
_SIGNS: Final = " ..::**##"  # the same in ASCII

# The run


def beginning_of(scenario: Scenario, world: World) -> Snapshot:
    """Return a run before its first step."""
    recipe = recipe_for(scenario, {}, SEED)
    return SnapshotBuilder().before(recipe, world, PlaybackView(), is_hidden=scenario.hides_answer)


def moments_of(scenario: Scenario, world: World) -> tuple[Snapshot, ...]:
    """Return moments of a reproducible run, equally spaced in steps.

    Large worlds and user environments without ``preview_steps`` have only the beginning.
    """
    before = beginning_of(scenario, world)
    recipe = before.recipe
    is_foreign = scenario.kind == "gymnasium" and group_of(scenario) == YOURS
    if is_large(world) or (is_foreign and scenario.preview_steps is None):
        return (before,)
    plans = BY_ID[recipe.algorithm].planner
    steps = scenario.preview_steps or (PLANNING_STEPS if plans else STEPS)
    try:
        run = Run(recipe, begin(recipe, world), evaluate=False, episode_limit=world.budget)
    except UserError:
        return (before,)
    moments = [before]
    for number in range(1, MOMENTS):
        run.advance(max(0, steps * number // (MOMENTS - 1) - run.step))
        moments.append(_moment(run, before))
    return tuple(moments)


def _moment(run: Run, before: Snapshot) -> Snapshot:
    learner = run.learner
    agent = AgentView(
        learner.algorithm,
        learner.hyperparameters,
        learner.q.copy(),
        learner.visits.copy(),
        values=next(iter(learner.remembered("v")), before.agent.values),
        policy=next(iter(learner.remembered("policy")), before.agent.policy),
        sweep=learner.phase,
    )
    mean_return, _ = run.history.last_100
    results = RunResults(return_last_100=mean_return, bandit=run.bandit)
    return replace(before, agent=agent, counters=learner.counters, results=results)


# Results of earlier sessions


def has_found_optimum(session: StoredSession, scenario: Scenario) -> bool:
    """Return whether a session's greedy policy is optimal, unless hidden."""
    document = session.document
    table, lane = document.table, document.lanes[document.shown]
    is_edited = any(entry.world for branch in lane.branches for entry in branch.journal)
    if table is None or is_edited or scenario.hides_answer or document.scenario.text != scenario.text:
        return False
    try:
        mdp, optimum = _answer(scenario, lane.seed, float(lane.settings_in_force["gamma"]))
    except (UserError, ImportError, KeyError, ValueError):
        return False
    if mdp is None or optimum is None or len(table.q) != mdp.pairs:
        return False
    return is_optimal(mdp, np.array(table.q), "random", optimum)


@lru_cache(maxsize=_MOST_ANSWERS)
def _answer(scenario: Scenario, seed: int, gamma: float) -> tuple[TabularMDP | None, Solution | None]:
    mdp = scenario.build(streams(seed).world).mdp
    return mdp, optimum_of(mdp, gamma)


@dataclass(frozen=True, slots=True)
class LastRun:
    """Mean returns of the last run, oldest first."""

    returns: FloatArray
    told: str


def last_run(session: StoredSession) -> LastRun | None:
    """Repeat a session's run if possible and short."""
    try:
        record = session.record()
        lane = record.lanes[record.shown]
        branch = lane.branches[lane.branch]
        if branch.here > _MOST_STEPS:
            return None
        run = Run(lane.recipe, evaluate=False)
        run.follow(branch.journal, branch.here, UNLIMITED)
    except (UserError, ImportError):
        return None
    results = run.results
    parts = []
    if results.return_last_100 is not None:
        parts.append(f"agent {_return(results.return_last_100)}")
    if results.greedy_return is not None and not lane.recipe.scenario.hides_answer:
        parts.append(f"greedy {_return(results.greedy_return)}")
    told = " · ".join(parts) or f"step {run.step:,}"
    return LastRun(results.curve.return_mean, told)


def last_run_text(run: LastRun, width: int, look: Look) -> Text:
    """Return a heading, the returns as an area, and the summary."""
    text = Text(no_wrap=True)
    text.append("Your last run\n", look.palette.strong)
    returns = run.returns
    if len(returns) > 1 and width > 1:
        at = np.linspace(0, len(returns) - 1, min(width, len(returns))).round().astype(int)
        low, high = float(returns.min()), float(returns.max())
        levels = (len(_EIGHTHS) - 1) * _ROWS
        share = (returns[at] - low) / (high - low) if high > low else np.full(len(at), 1.0)
        filled = np.maximum(1, (share * levels).round().astype(int))
        eighths = _EIGHTHS if look.glyphs.braille else _SIGNS
        for row in reversed(range(_ROWS)):
            parts = np.clip(filled - row * (len(_EIGHTHS) - 1), 0, len(_EIGHTHS) - 1)
            text.append("".join(eighths[part] for part in parts) + "\n", look.palette.episodes)
    text.append(look.glyphs.separated(run.told), look.palette.dim)
    return text


# The line below the picture


def moment_line(moment: Snapshot, look: Look) -> RenderableType:
    """Return step, mean return and episode."""
    counters, mean_return = moment.counters, moment.results.return_last_100
    parts = [f"step {counters.step:,}"]
    if mean_return is not None:
        parts.append(f"mean return {_return(mean_return)}")
    if not moment.agent.row.planner:
        parts.append(f"episode {counters.episodes:,}")
    return PartsLine(" · ".join(parts), look)


def _return(number: float) -> str:
    return numbers.fixed(number, 2, leading_zero=False)
