"""Short trainings of every algorithm, to see whether what it learns would ever end."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Final, NamedTuple

import numpy as np

from rl_tui.agents.catalogue import BY_ID
from rl_tui.agents.compatibility import incompatibility
from rl_tui.agents.exact.exact_model import exact_model
from rl_tui.agents.exact.policy_figures import greedy_policy
from rl_tui.agents.exact.solve import endless_part, staying_states
from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.agents.kernels.position import Stop
from rl_tui.agents.learner import Learner
from rl_tui.common.streams import streams
from rl_tui.runs.training.compile_or_interpret import Patience
from rl_tui.runs.training.endless import LONG_EPISODE
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

SEEDS: Final = (0, 1, 2)
MOST_EPISODES: Final = 500
MOST_STEPS: Final = 100_000
"""Of one training; of a planner, backups of a state."""
MOST_STATES: Final = 1_000
MOST_ACTIONS: Final = 50
"""In a larger world nothing is learned in so few steps."""

_CHUNK: Final = 2_000
"""Steps between two looks at whether an episode is long: always as many, or it would depend on the time."""


class GreedyTrial(NamedTuple):
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

    @property
    def is_cut_short(self) -> bool:
        """Whether there was more to learn, of which nothing is known."""
        return not self.is_whole and self.long_episode is None


def may_stay(mdp: TabularMDP) -> bool:
    """Return whether some policy of ``mdp`` may stay for ever; else no trial is needed, each ends."""
    return bool(staying_states(exact_model(mdp), np.ones(mdp.pairs, dtype=np.bool_)).any())


def is_tried(mdp: TabularMDP) -> bool:
    """Return whether ``mdp`` is small enough to be tried."""
    return mdp.states <= MOST_STATES and len(mdp.action_names) <= MOST_ACTIONS


def suitable(mdp: TabularMDP, hyperparameters: Hyperparameters) -> tuple[str, ...]:
    """Return the ids of the algorithms that can learn in ``mdp`` with these settings."""
    return tuple(each for each in BY_ID if not incompatibility(mdp, each, hyperparameters))


def trials(
    mdp: TabularMDP, algorithm: str, hyperparameters: Hyperparameters, episodes: int
) -> Iterator[GreedyTrial]:
    """Yield a trial of ``algorithm``, which is :func:`suitable`, for each of ``SEEDS``.

    Each takes at most so many ``episodes`` and ``MOST_STEPS`` steps. Equal arguments give equal trials.
    A planner draws nothing: one trial does.
    """
    seeds, patience = SEEDS[:1] if BY_ID[algorithm].planner else SEEDS, Patience()
    for number, seed in enumerate(seeds):
        learner = Learner(mdp, algorithm, hyperparameters, streams(seed))
        wanted = MOST_STEPS if learner.plans else episodes

        def look(learner: Learner, begun: int = number * wanted, in_all: int = len(seeds) * wanted) -> None:
            patience.look(learner, begun + (learner.step if learner.plans else learner.episodes), in_all)

        yield _trial(mdp, learner, seed, wanted, look)


def _trial(
    mdp: TabularMDP, learner: Learner, seed: int, wanted: int, look: Callable[[Learner], None]
) -> GreedyTrial:
    """Train ``learner`` for ``wanted`` episodes, or backups of a planner; ``look`` after every chunk."""
    is_long, stop = False, Stop.DONE
    while learner.step < MOST_STEPS and learner.episodes < wanted and not is_long:
        stop = learner.advance(min(_CHUNK, MOST_STEPS - learner.step), wanted - learner.episodes)
        learner.drain_episodes()
        if stop not in (Stop.DONE, Stop.EPISODES_FULL):
            break
        is_long = not learner.plans and learner.episode_step >= LONG_EPISODE
        look(learner)
    is_whole = learner.converged if learner.plans else learner.episodes >= wanted
    # a planner that was broken off has no policy yet
    greedy = (
        greedy_policy(mdp, learner.q, learner.hyperparameters.ties) if is_whole or not learner.plans else None
    )
    return GreedyTrial(
        learner.algorithm,
        seed,
        None if greedy is None else endless_part(mdp, greedy),
        learner.episodes + 1 if is_long else None,
        is_whole,
    )
