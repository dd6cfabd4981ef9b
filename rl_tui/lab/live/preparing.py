"""The picture of a run that is about to begin."""

from __future__ import annotations

import numpy as np

from rl_tui.lab.live.snapshot import Curve, Marks, Phase, Snapshot
from rl_tui.lab.run.bandit import bandit_figures
from rl_tui.lab.run.exact_answers import NO_TABLE
from rl_tui.lab.run.recipe import Recipe
from rl_tui.worlds.mdp.tabular_mdp import FloatArray, IntArray
from rl_tui.worlds.world import World


def preparing(recipe: Recipe, world: World, speed: float | None, message: str) -> Snapshot:
    """Return a snapshot of a run whose world is there and whose agent is not yet."""
    hyperparameters, space = recipe.hyperparameters, world.space
    visits: IntArray = np.zeros(space.pairs, np.int64)
    nothing: FloatArray = np.empty(0)
    no_steps: IntArray = np.empty(0, np.int64)
    return Snapshot(
        world=world,
        recipe=recipe,
        algorithm=recipe.algorithm,
        hyperparameters=hyperparameters,
        phase=Phase.PREPARING,
        message=message,
        speed=speed,
        steps_per_second=None,
        step=0,
        episodes=0,
        state=0 if world.mdp is None else int(world.mdp.start_state[0]),
        episode_step=0,
        episode_return=0.0,
        q=np.full(space.pairs, hyperparameters.initial_q),
        visits=visits,
        last=None,
        curve=Curve(no_steps, nothing, nothing, nothing, nothing),
        marks=Marks(no_steps, no_steps, nothing),
        return_last_100=None,
        length_last_100=None,
        greedy_return=None,
        exact=None,
        exact_refused=NO_TABLE if world.mdp is None else "",
        bandit=bandit_figures(world, visits, winnings=0.0),
    )
