"""Answers about a run, as a snapshot holds them."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Final

import numpy as np

from rl_tui.agents.exact.policy_evaluation import NoExactAnswer
from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.runs.answers.flip_answer import NOT_ASKED, FlipAnswer
from rl_tui.runs.answers.policy_kind import PolicyKind
from rl_tui.runs.answers.policy_values import DrawnPolicy, PolicyAnswer
from rl_tui.runs.exact_answers import DEAREST_LIVE, NO_TABLE, visits_of
from rl_tui.runs.large_worlds import MOST_COPIED
from rl_tui.worlds.mdp.space import BoolArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

if TYPE_CHECKING:
    from rl_tui.agents.exact.first_update import FirstUpdate
    from rl_tui.runs.played_run import PlayedRun


# The wait for the first update


MANY_EPISODES: Final = 10
TOO_LARGE: Final = "this world is too large for the screen; use rl-tui why"
_KEPT: Final = 16
_Settings = tuple[TabularMDP, str, Hyperparameters, bool]


@dataclass(frozen=True, slots=True, eq=False)
class FirstUpdateView:
    """The wait for the first update, as if the run began with the current settings.

    `is_long` means that no estimate has changed in many episodes.
    """

    answer: FirstUpdate | None
    refused: str
    has_moved: bool
    is_long: bool


class FirstUpdates:
    """Cache of waits, by world and settings."""

    def __init__(self) -> None:
        self._known: OrderedDict[_Settings, tuple[FirstUpdate | None, str]] = OrderedDict()

    def of(self, run: PlayedRun, *, is_asked: bool) -> FirstUpdateView | None:
        """Return the wait of `run`, or None if nobody asked and the run learns or has only begun."""
        learner = run.learner
        has_many = learner.episodes >= MANY_EPISODES and PolicyKind.BEHAVIOUR not in run.unknown_policies
        if not is_asked and (not has_many or run.world.space.pairs > MOST_COPIED):
            return None
        has_moved = bool(np.any(learner.q != run.recipe.hyperparameters.initial_q))
        if has_moved and not is_asked:
            return None
        answer, refused = self._answer(run)
        return FirstUpdateView(answer, refused, has_moved, has_many and not has_moved)

    def _answer(self, run: PlayedRun) -> tuple[FirstUpdate | None, str]:
        mdp, learner = run.world.mdp, run.learner
        if mdp is None:
            return None, NO_TABLE
        if visits_of(mdp) > DEAREST_LIVE:
            return None, TOO_LARGE
        # Q₀ applies at the start only, so its current value does not matter
        values = replace(learner.hyperparameters, initial_q=run.recipe.hyperparameters.initial_q)
        settings = (mdp, learner.algorithm, values, values.alpha_at(learner.episodes) == 0.0)
        if settings not in self._known:
            self._known[settings] = _worked_out(mdp, learner.algorithm, values, learner.episodes)
            while len(self._known) > _KEPT:
                self._known.popitem(last=False)
        return self._known[settings]


def _worked_out(
    mdp: TabularMDP, algorithm: str, values: Hyperparameters, episode: int
) -> tuple[FirstUpdate | None, str]:
    from rl_tui.agents.exact.first_update import first_update

    try:
        return first_update(mdp, algorithm, values, episode), ""
    except NoExactAnswer as refusal:
        return None, str(refusal)


# All answers


@dataclass(frozen=True, slots=True, eq=False)
class AnswersView:
    """Answers for one run at one step."""

    is_hidden: bool = False
    """True if exact answers are to be hidden, or False if there is none."""
    kept_back: frozenset[str] = frozenset()
    """Names of what the lesson hides until a page is done."""
    studied: PolicyKind | None = None
    """The policy whose values are shown, or None."""
    drawn: DrawnPolicy = field(default_factory=DrawnPolicy)
    left_to_chance: BoolArray | None = None
    """States where the drawn policy acts at random for lack of a choice, `[S]`, or None if it is not
    studied.
    """
    policies: Mapping[PolicyKind, PolicyAnswer] = field(default_factory=dict)
    """Values of each policy, as far as known, empty unless requested."""
    first_update: FirstUpdateView | None = None
    """The wait for the first update, or None unless requested or long."""
    flips: FlipAnswer = NOT_ASKED
    """Every γ at which the optimal actions of the world change."""
