"""Answers to the user's questions about a run, as a snapshot holds them."""

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
    from rl_tui.runs.run import Run


# The wait for the first update


MANY_EPISODES: Final = 10
TOO_LARGE: Final = "this world is too large to be worked out on screen; rl-tui why has the answer"
_KEPT: Final = 16
_Settings = tuple[TabularMDP, str, Hyperparameters, bool]


@dataclass(frozen=True, slots=True, eq=False)
class FirstUpdateView:
    """The wait of one run for its first update, by the settings in force, as if it began with them.

    Either ``answer`` is there, or ``refused`` says why there is none. ``has_moved`` tells whether an estimate
    has moved already, and ``is_long`` that none has in many episodes.
    """

    answer: FirstUpdate | None
    refused: str
    has_moved: bool
    is_long: bool


class FirstUpdates:
    """The waits of runs, in whichever worlds they are."""

    def __init__(self) -> None:
        self._known: OrderedDict[_Settings, tuple[FirstUpdate | None, str]] = OrderedDict()

    def of(self, run: Run, *, is_asked: bool) -> FirstUpdateView | None:
        """Return the wait of ``run``; None where nobody has asked and something was learned, or may soon be.

        Of a large world nothing is said unless somebody has asked.
        """
        learner = run.learner
        has_many = not learner.plans and learner.episodes >= MANY_EPISODES
        if not is_asked and (not has_many or run.world.space.pairs > MOST_COPIED):
            return None
        has_moved = bool(np.any(learner.q != run.recipe.hyperparameters.initial_q))
        if has_moved and not is_asked:
            return None
        answer, refused = self._answer(run)
        return FirstUpdateView(answer, refused, has_moved, has_many and not has_moved)

    def _answer(self, run: Run) -> tuple[FirstUpdate | None, str]:
        mdp, learner = run.world.mdp, run.learner
        if mdp is None:
            return None, NO_TABLE
        if visits_of(mdp) > DEAREST_LIVE:
            return None, TOO_LARGE
        # estimates start from what the recipe says, whatever is set later
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
    """The answers for one run at one step."""

    is_hidden: bool = False
    """Whether whatever would give the answer away is to be hidden; False where there is no exact answer."""
    kept_back: frozenset[str] = frozenset()
    """What a lesson keeps back until a page of it is done: names of what a page may hide."""
    studied: PolicyKind | None = None
    """The policy whose values are asked for; None: of none."""
    drawn: DrawnPolicy = field(default_factory=DrawnPolicy)
    """The policy that a person drew."""
    left_to_chance: BoolArray | None = None
    """The states in which it may come to act at random for want of a choice, [S]; None: it is not studied."""
    policies: Mapping[PolicyKind, PolicyAnswer] = field(default_factory=dict)
    """What each policy is worth, as far as it is known; none while nobody asks."""
    first_update: FirstUpdateView | None = None
    """The wait for the first update; None: nobody has asked, and something was learned or may soon be."""
    flips: FlipAnswer = NOT_ASKED
    """Every γ at which the optimal actions of its world change."""
