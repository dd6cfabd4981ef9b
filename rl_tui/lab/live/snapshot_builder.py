"""Where snapshots are made: of a run, and of one that is about to begin."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rl_tui.agents.counters import Counters
from rl_tui.lab.live.snapshot import AgentView, PlaybackView, Snapshot
from rl_tui.lab.live.viewport import PartCopier, Viewport
from rl_tui.lab.run.bandit import bandit_figures
from rl_tui.lab.run.exact_answers import NO_TABLE, PENDING, Answer
from rl_tui.lab.run.large_worlds import is_large
from rl_tui.lab.run.recipe import Recipe
from rl_tui.lab.run.results import RunResults
from rl_tui.lab.timeline.branches import Timeline
from rl_tui.lab.timeline.lane_view import RunGroupView
from rl_tui.lab.timeline.table_samples import CellHistory
from rl_tui.worlds.mdp.space import IntArray
from rl_tui.worlds.world import World

if TYPE_CHECKING:
    from rl_tui.lab.run.run import Run


class SnapshotBuilder:
    """Builds the snapshots of a playground; keeps what was worked out once of a large world."""

    def __init__(self) -> None:
        self._copier: PartCopier | None = None

    def before(self, recipe: Recipe, world: World, playback: PlaybackView) -> Snapshot:
        """Return the snapshot of a run whose world is there and whose agent is not yet."""
        hyperparameters, pairs = recipe.hyperparameters, world.space.pairs
        visits: IntArray = np.zeros(pairs, np.int64)
        return Snapshot(
            world=world,
            recipe=recipe,
            agent=AgentView(
                recipe.algorithm, hyperparameters, np.full(pairs, hyperparameters.initial_q), visits
            ),
            counters=Counters(state=0 if world.mdp is None else int(world.mdp.start_state[0])),
            results=RunResults(bandit=bandit_figures(world, visits, winnings=0.0)),
            exact_answer=Answer(None, NO_TABLE) if world.mdp is None else PENDING,
            playback=playback,
        )

    def build(
        self,
        run: Run,
        playback: PlaybackView,
        *,
        viewport: Viewport | None,
        exact_answer: Answer,
        timeline: Timeline,
        run_group: RunGroupView,
        cell: CellHistory | None,
    ) -> Snapshot:
        """Return the snapshot of ``run``; of a large world with what ``viewport`` shows, None: everything."""
        counters = run.learner.counters
        return Snapshot(
            world=run.world,
            recipe=run.recipe,
            agent=self._agent(run, counters, viewport),
            counters=counters,
            results=run_group.lanes[run_group.shown].results if run_group.lanes else run.results,
            exact_answer=exact_answer,
            playback=playback,
            timeline=timeline,
            run_group=run_group,
            cell=cell,
        )

    def _agent(self, run: Run, counters: Counters, viewport: Viewport | None) -> AgentView:
        """Return the agent with copies of all that it has learned, of a large world of what is in view."""
        learner = run.learner
        if viewport is None or not is_large(run.world):
            return AgentView(
                learner.algorithm,
                learner.hyperparameters,
                learner.q.copy(),
                learner.visits.copy(),
                tables=learner.remembered("q1", "q2"),
                values=next(iter(learner.remembered("v")), np.empty(0)),
                planning=learner.planning,
                author=learner.author,
            )
        if self._copier is None or self._copier.world is not run.world:
            self._copier = PartCopier(run.world)
        part = self._copier.copy(viewport, counters.state, counters.last_step, learner.q, learner.visits)
        return AgentView(
            learner.algorithm,
            learner.hyperparameters,
            part.q,
            part.visits,
            part=part,
            planning=learner.planning,
            author=learner.author,
        )
