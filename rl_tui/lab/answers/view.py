"""What a snapshot says of the questions that a person has asked."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from rl_tui.lab.answers.drawn_policy import DrawnPolicy
from rl_tui.lab.answers.first_updates import FirstUpdateView
from rl_tui.lab.answers.flip_answer import NOT_ASKED, FlipAnswer
from rl_tui.lab.answers.policy_kind import PolicyKind
from rl_tui.lab.answers.policy_values import PolicyAnswer
from rl_tui.worlds.mdp.space import BoolArray


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
