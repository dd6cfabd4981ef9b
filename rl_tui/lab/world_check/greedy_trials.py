"""Short trainings of every algorithm, to see whether what it learns would ever end."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from typing import Final, NamedTuple

import numpy as np

from rl_tui.agents.catalogue import BY_ID
from rl_tui.agents.compatibility import incompatibility
from rl_tui.agents.compiling.background import BACKGROUND
from rl_tui.agents.compiling.cache_folder import was_compiled
from rl_tui.agents.exact.exact_model import exact_model
from rl_tui.agents.exact.policies import greedy_policy
from rl_tui.agents.exact.ways_out import endless_part, staying_states
from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.agents.kernels.stop import Stop
from rl_tui.agents.learner import Learner
from rl_tui.common.streams import streams
from rl_tui.lab.experiments.endless import LONG_EPISODE
from rl_tui.lab.experiments.patience import WORTH_READING
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

SEEDS: Final = (0, 1, 2)
MOST_EPISODES: Final = 500
MOST_STEPS: Final = 100_000
"""Of one training; of a planner, backups of a state."""
MOST_STATES: Final = 1_000
MOST_ACTIONS: Final = 50
"""In a larger world nothing is learned in so few steps."""

OnAlgorithm = Callable[[str], None]
_CHUNK: Final = 2_000


class Trial(NamedTuple):
    """What came of one training.

    ``endless_at`` is a state that the greedy policy of what was learned may come to and from which it never
    ends, None where it ends with probability 1, or a planner had not converged. ``long_episode`` is the
    number, from 1, of an episode that had not ended after 50,000 steps; None: each did. ``is_whole``: all its
    episodes were finished, or the planner converged.
    """

    algorithm: str
    seed: int
    endless_at: int | None
    long_episode: int | None
    is_whole: bool

    @property
    def may_never_end(self) -> bool:
        """Whether the greedy policy, or an episode of learning, may go on for ever."""
        return self.endless_at is not None or self.long_episode is not None


def may_stay(mdp: TabularMDP) -> bool:
    """Return whether some policy of ``mdp`` may stay for ever; else no trial is needed, each ends."""
    return bool(staying_states(exact_model(mdp), np.ones(mdp.pairs, dtype=np.bool_)).any())


def is_tried(mdp: TabularMDP) -> bool:
    """Return whether ``mdp`` is small enough to be tried."""
    return mdp.states <= MOST_STATES and len(mdp.action_names) <= MOST_ACTIONS


def trials(
    mdp: TabularMDP, hyperparameters: Hyperparameters, episodes: int, on_algorithm: OnAlgorithm
) -> Iterator[Trial]:
    """Yield a trial of every algorithm that suits ``mdp`` with these settings, for each of ``SEEDS``.

    Each takes at most so many ``episodes`` and ``MOST_STEPS`` steps. Equal arguments give equal trials.
    ``on_algorithm`` is called with the id of each before it begins. A planner draws nothing: one trial does.
    """
    for algorithm in BY_ID.values():
        if incompatibility(mdp, algorithm.id, hyperparameters):
            continue
        on_algorithm(algorithm.id)
        seeds = SEEDS[:1] if algorithm.planner else SEEDS
        for seed in seeds:
            yield _trial(mdp, algorithm.id, hyperparameters, episodes, seed)


def _trial(mdp: TabularMDP, algorithm: str, values: Hyperparameters, episodes: int, seed: int) -> Trial:
    learner = Learner(mdp, algorithm, values, streams(seed))
    wanted = MOST_STEPS if learner.plans else episodes
    began = time.perf_counter()
    is_long, stop = False, Stop.DONE
    while learner.step < MOST_STEPS and learner.episodes < wanted and not is_long:
        stop = learner.advance(min(_CHUNK, MOST_STEPS - learner.step), wanted - learner.episodes)
        learner.drain_episodes()
        if stop not in (Stop.DONE, Stop.EPISODES_FULL):
            break
        is_long = not learner.plans and learner.episode_step >= LONG_EPISODE
        is_slow = not learner.is_compiled and time.perf_counter() - began > WORTH_READING
        if is_slow and learner.loop not in BACKGROUND.failed and was_compiled(learner.loop):
            BACKGROUND.read(learner.loop)  # the same bits, sooner; to compile would take longer than the rest
    is_whole = learner.converged if learner.plans else learner.episodes >= episodes
    # a planner that was broken off has no policy yet
    greedy = greedy_policy(mdp, learner.q, values.ties) if is_whole or not learner.plans else None
    return Trial(
        algorithm,
        seed,
        None if greedy is None else endless_part(mdp, greedy),
        learner.episodes + 1 if is_long else None,
        is_whole,
    )
