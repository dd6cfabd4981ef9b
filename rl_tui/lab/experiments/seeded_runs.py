"""Runs of one recipe that differ in their seed, one at a time: what they share is made once."""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import Any, Final

from rl_tui.agents.batches.batch import batching_of
from rl_tui.agents.compiling.background import BACKGROUND
from rl_tui.agents.exact.solution import Solution
from rl_tui.agents.kernels.machine_code import Loop
from rl_tui.common.errors import UserError
from rl_tui.lab.experiments.patience import batching_pays, pays, seconds_interpreted
from rl_tui.lab.experiments.training import Goal, OnProgress, train
from rl_tui.lab.run.edited_world import EditedWorld
from rl_tui.lab.run.figures import (
    BANDIT_FIGURES,
    exact_world,
    greedy_figures,
    optimum_of,
    pulls,
    world_digest,
)
from rl_tui.lab.run.recipe import JournalEntry, Recipe, WorldChange, begin
from rl_tui.lab.run.run import OnEpisodes, Run, each_of
from rl_tui.worlds.drawing import Arms
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP
from rl_tui.worlds.world import World

FIGURES: Final = (
    "steps",
    "episodes",
    "value_at_start",
    "expected_return",
    "max_error",
    "return_mean",
    "return_last_100",
    "length_last_100",
    "first_reward_episode",
)
"""The names of a run's figures, each a key of its row."""


def no_compiling() -> None:
    """Ignore that runs wait for machine code."""


class SeededRuns:
    """Trains ``recipe`` under one seed after the other, from several threads if need be.

    They share a world that no seed shapes, ``known`` if it is at hand, and its exact answer, which ``solve``
    works out. The settings of ``journal`` are made in each of them on the way. Raises UserError where the
    world cannot be built.
    """

    def __init__(
        self,
        recipe: Recipe,
        journal: Sequence[JournalEntry] = (),
        known: World | None = None,
        solve: Callable[[TabularMDP | None, float], Solution | None] = optimum_of,
    ) -> None:
        self._solve = solve
        self.recipe = recipe
        """The recipe of the first of them."""
        self.first = Run(recipe, begin(recipe, known), evaluate=False)
        """The first of them, not trained."""
        self.is_bandit = isinstance(self.first.world.drawing, Arms)
        """Whether their world is a bandit."""
        self.journal = journal
        """What is set in each of them on the way."""
        self.shared = None if recipe.scenario.section.drawn_from_seed else self.first.edited
        """The world of them all; None where each has one of its own."""
        self._edited = [] if self.shared is None else self._worlds_after(self.shared)
        # By γ, which may be set on the way, and by how often the world changed, in all of them alike
        self._optima = dict[tuple[float, int], Solution | None]()
        self._digests = dict[int, str | None]()
        self._solving = threading.Lock()

    def _worlds_after(self, first: EditedWorld) -> list[EditedWorld]:
        """Return what the journal makes of the world ``first``; held here, each is built once for all."""
        worlds = [first]
        with suppress(UserError):  # the run that comes to what cannot be done says where that is
            for entry in self.journal:
                if isinstance(entry.change, WorldChange):
                    worlds.append(worlds[-1].after(entry.change, self.recipe))
        return worlds

    @property
    def batched_loop(self) -> Loop | None:
        """The loop that trains many at once: of agents that learn in a table, with nothing set on the way.

        None for others.
        """
        learner, mdp = self.first.learner, self.first.world.mdp
        if mdp is None or learner.plans or self.journal:
            return None
        return learner.loop._replace(batching=batching_of(mdp, is_shared=self.shared is not None))

    @property
    def first_seed(self) -> int:
        """The seed of the first of them."""
        return self.recipe.seed

    @property
    def plans(self) -> bool:
        """Whether they have no episodes, but the sweeps of a planner."""
        return self.first.learner.plans

    @property
    def figures(self) -> tuple[str, ...]:
        """The names of a run's figures."""
        return (*FIGURES, *BANDIT_FIGURES) if self.is_bandit else FIGURES

    def get_machine_code(self, runs: int, goal: Goal, on_compiling: Callable[[], None]) -> None:
        """Have machine code for so many runs where that pays; ``on_compiling`` is called before it is had."""
        # Interpreted, all runs together have one core. An environment that is stepped is not tried: it may do
        # anything, and takes most of the time itself
        learner = self.first.learner
        if learner.rewindable:
            wanted, by_episodes = goal.steps or goal.episodes or 0, goal.steps is None
            seconds = runs * seconds_interpreted(learner, wanted, episodes=by_episodes)
            if pays(learner.loop, seconds):
                on_compiling()
                BACKGROUND.get(learner.loop)
            if self.batched_loop is not None and batching_pays(self.batched_loop, seconds):
                BACKGROUND.get(self.batched_loop)

    def new_run(self, seed: int, *on_episodes: OnEpisodes | None) -> Run:
        """Return the run of ``seed``, not trained; each of ``on_episodes`` hears of its episodes."""
        recipe = replace(self.recipe, seed=seed)
        beginning = begin(recipe, None if self.shared is None else self.shared.world)
        on_each = each_of(*on_episodes)
        return Run(recipe, beginning, edited=self.shared, evaluate=False, on_episodes=on_each)

    def train(self, run: Run, goal: Goal, on_progress: OnProgress) -> None:
        """Advance ``run`` to ``goal``. Raises UserError, naming the seed, where it broke down."""
        try:
            train(run, goal, on_progress, self.journal)
        except UserError as error:
            raise UserError(f"seed {run.recipe.seed}: {error}") from error

    def row(self, run: Run, check: Callable[[], None] = no_compiling) -> dict[str, Any]:
        """Return the seed and the figures of ``run``, as ``train --runs --json`` prints them.

        ``check`` is called between what may take long, and may raise to end it.
        """
        check()
        learner, changes = run.learner, len(run.world_changes)
        optimum = self.optimum(exact_world(run), learner.hyperparameters.gamma, changes)
        check()
        exact = greedy_figures(run, optimum)
        mean_return, mean_length = run.history.last_100
        return {
            "seed": run.recipe.seed,
            "steps": run.step,
            "episodes": learner.episodes,
            "value_at_start": exact.value_at_start,
            "expected_return": exact.expected_return,
            "max_error": exact.max_error,
            "return_mean": run.mean_return,
            "return_last_100": mean_return,
            "length_last_100": mean_length,
            "first_reward_episode": learner.first_reward_episode or None,
            "world": self.digest(run.world, changes),
            **pulls(run.bandit),
        }

    def optimum(self, mdp: TabularMDP | None, gamma: float, changes: int = 0) -> Solution | None:
        """Return the exact answer of ``mdp``, in which a run is after so many ``changes`` of its world.

        None where there is none. What is the same for all of them is worked out once.
        """
        # Where the world drifts, each run comes to other means, and so to another exact answer
        if self.shared is None or (mdp is not None and mdp.drift_std > 0.0):
            return optimum_of(mdp, gamma)
        with self._solving:
            key = gamma, changes
            if key not in self._optima:
                self._optima[key] = self._solve(mdp, gamma)
            return self._optima[key]

    def digest(self, world: World, changes: int = 0) -> str | None:
        """Return the digest of ``world``, that of a run after so many ``changes``; None without a table."""
        if self.shared is None:
            return world_digest(world)
        with self._solving:
            if changes not in self._digests:
                self._digests[changes] = world_digest(world)
            return self._digests[changes]
