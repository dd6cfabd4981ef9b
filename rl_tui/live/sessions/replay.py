"""Replay of a session from step 0 to its position."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from rl_tui.common.errors import UserError
from rl_tui.common.findings import shown
from rl_tui.common.words import counted
from rl_tui.live.record import Record
from rl_tui.live.sessions.session import StoredSession, digest_of
from rl_tui.runs.changes import as_json
from rl_tui.runs.figures import training_figures
from rl_tui.runs.recipe import begin
from rl_tui.runs.run import OnEpisodes, Run
from rl_tui.runs.timeline.branches import Branch, RunRecord
from rl_tui.runs.training.seeded_runs import Goal, OnProgress, no_progress, train


@dataclass(frozen=True, slots=True)
class ReplayTarget:
    """A branch of a run (from 0), perhaps where the session was left."""

    lane: RunRecord
    number: int
    branch: Branch
    left: bool


def replay_target(record: Record, lane: int | None = None, branch: str | None = None) -> ReplayTarget:
    """Choose run (from 1) and branch, by default the visible ones. Raises UserError with a list."""
    number = record.shown if lane is None else lane - 1
    if not 0 <= number < len(record.lanes):
        lanes = counted(len(record.lanes), "run")
        raise UserError(f"there is no run {lane}: the session has {lanes}")
    chosen = record.lanes[number]
    here = chosen.branches[chosen.branch]
    if branch is None:
        return ReplayTarget(chosen, number, here, left=number == record.shown)
    for each in chosen.branches:
        if each.name == branch:
            return ReplayTarget(chosen, number, each, left=number == record.shown and each is here)
    names = ", ".join(each.name for each in chosen.branches[:20])
    raise UserError(f"run {number + 1} has no branch {shown(branch)}: its branches are {names}")


def replayed(
    target: ReplayTarget, on_progress: OnProgress = no_progress, on_episodes: OnEpisodes | None = None
) -> tuple[Run, float]:
    """Return the replayed run, and its seconds without compilation. Raises UserError if it ends earlier."""
    recipe, branch = target.lane.recipe, target.branch
    beginning = begin(recipe)
    budget = beginning.world.budget
    run = Run(recipe, beginning, evaluate=False, episode_limit=budget, on_episodes=on_episodes)
    seconds = train(run, Goal(steps=branch.here), on_progress, branch.journal)
    if run.step < branch.here:
        raise UserError(f"the run ends at step {run.step:,}, but it was saved at step {branch.here:,}")
    return run, seconds


def comes_out_otherwise(session: StoredSession, target: ReplayTarget, run: Run) -> bool:
    """Return True if Q differs from a saved digest."""
    digest = session.document.digest
    return target.left and digest != "" and digest_of(run.learner.q) != digest


def replay_figures(session: StoredSession, target: ReplayTarget, run: Run, seconds: float) -> dict[str, Any]:
    """Return the results of training as JSON data, with the place in the session."""
    return {
        "session": str(session.path),
        "lane": target.number + 1,
        "branch": target.branch.name,
        "journal": as_json(run.journal, run.first_actions),
        **training_figures(run, seconds),
    }
