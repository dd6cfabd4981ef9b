"""Exact values of policies in a run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, NamedTuple
from weakref import WeakKeyDictionary

import numpy as np

from rl_tui.agents.exact.policy_figures import policy_of_choices
from rl_tui.runs.answers.policy_kind import PolicyKind
from rl_tui.runs.exact_answers import LIVE_STATES, NO_TABLE, is_quick
from rl_tui.worlds.mdp.reachable import reachable
from rl_tui.worlds.mdp.space import BoolArray, FiniteSpace, FloatArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

if TYPE_CHECKING:
    from rl_tui.runs.exact_answers import Answer
    from rl_tui.runs.played_run import PlayedRun


# A drawn policy


@dataclass(frozen=True, slots=True)
class DrawnPolicy:
    """Chosen (state, action) numbers, sorted by state; random elsewhere."""

    choices: tuple[tuple[int, int], ...] = ()

    def with_action(self, state: int, action: int | None) -> DrawnPolicy:
        """Return a copy with `action` in `state`. None removes the choice."""
        chosen = dict(self.choices)
        chosen.pop(state, None)
        if action is not None:
            chosen[state] = action
        return DrawnPolicy(tuple(sorted(chosen.items())))

    def fitting(self, space: FiniteSpace) -> DrawnPolicy:
        """Return a copy without choices unavailable in `space`."""
        legal = self.pairs(space)
        return DrawnPolicy(tuple(choice for choice in self.choices if choice[0] in legal))

    def pairs(self, space: FiniteSpace) -> dict[int, int]:
        """Return the pair chosen in each state, if available."""
        chosen = {
            state: space.pair_of(state, action) for state, action in self.choices if state < space.states
        }
        return {state: pair for state, pair in chosen.items() if pair is not None}

    def chances(self, space: FiniteSpace) -> FloatArray:
        """Return π(a|s), `[P]`, uniform in states without a choice."""
        return policy_of_choices(space, self.pairs(space))


# States left to chance


def left_to_chance(mdp: TabularMDP, drawn: DrawnPolicy) -> BoolArray:
    """Mark the reachable states, `[S]`, with several actions and no drawn one."""
    policy = drawn.chances(mdp)
    goes_on = (policy[mdp.outcome_pair] > 0.0) & (mdp.probability > 0.0) & ~mdp.terminated
    source = mdp.pair_state[mdp.outcome_pair[goes_on]]
    first_edge = np.concatenate([[0], np.cumsum(np.bincount(source, minlength=mdp.states))])
    reached = reachable(first_edge, mdp.next_state[goes_on], mdp.start_state)
    is_open = np.diff(mdp.first_pair) > 1
    is_open[[state for state, _ in drawn.choices]] = False
    return np.asarray(reached & is_open)


class LeftToChance:
    """Cache of `left_to_chance` for two runs."""

    def __init__(self) -> None:
        self._known: list[tuple[TabularMDP, DrawnPolicy, BoolArray]] = []

    def of(self, mdp: TabularMDP, drawn: DrawnPolicy) -> BoolArray:
        """Return `left_to_chance`, `[S]`, cached."""
        for its_mdp, its_drawn, left in self._known:
            if its_mdp is mdp and its_drawn is drawn:
                return left
        left = left_to_chance(mdp, drawn)
        self._known = [(mdp, drawn, left), *self._known[:1]]
        return left


# Values of a policy


TOO_MANY: Final = f"more than {LIVE_STATES:,} states: use rl-tui evaluate"
WHILE_RUNNING: Final = "pause to see it"
NO_CHANCES: Final = "its action probabilities have no formula, or there are too many"


@dataclass(frozen=True, slots=True, eq=False)
class PolicyAnswer:
    """The exact values of one policy, None while pending or `refused`.

    `policy` and `q` are `[P]`, `v` is `[S]`, both values for the current γ without time limit, NaN where a
    policy has none (γ = 1 only). `value_at_start` is the mean of `v` over the start states. The return
    (undiscounted), `steps` and `ends` (a probability) are those of an episode within the time limit.
    """

    policy: FloatArray | None = None
    v: FloatArray | None = None
    q: FloatArray | None = None
    value_at_start: float | None = None
    expected_return: float | None = None
    steps: float | None = None
    ends: float | None = None
    refused: str = ""
    """Reason why there is no answer, empty if there is one, or it is pending."""

    @property
    def is_known(self) -> bool:
        """True once the values are known."""
        return self.policy is not None


PENDING: Final = PolicyAnswer()


def worth_of(mdp: TabularMDP, policy: FloatArray, gamma: float) -> PolicyAnswer:
    """Evaluate `policy`, `[P]`, in `mdp` for `gamma` in [0, 1]."""
    from rl_tui.agents.exact.policy_figures import figures

    found = figures(mdp, policy, gamma)
    q = None if found.v is None else action_values(mdp, found.v, gamma)
    return PolicyAnswer(
        policy, found.v, q, found.value_at_start, found.expected_return, found.steps, found.ends
    )


def action_values(mdp: TabularMDP, v: FloatArray, gamma: float) -> FloatArray:
    """Back up `v`, `[S]`, to action values, `[P]` (equation 4.6)."""
    first = mdp.first_outcome[:-1]
    later = np.where(mdp.terminated, 0.0, v[mdp.next_state])
    gain = mdp.probability * (mdp.reward + gamma * later)
    summed: FloatArray = np.add.reduceat(gain, first) / np.add.reduceat(mdp.probability, first)
    return summed


class _Question(NamedTuple):
    mdp: TabularMDP
    policy: FloatArray
    gamma: float

    def is_answered_by(self, other: _Question) -> bool:
        is_same_world = self.mdp is other.mdp and self.gamma == other.gamma
        return is_same_world and np.array_equal(self.policy, other.policy)


class PolicyAnswers:
    """Policy values of several runs, cached until policy, γ or world change.

    Slow evaluations happen in `work` while the run is paused. Without `automatic`, nothing depends on timing.
    """

    def __init__(self, *, automatic: bool) -> None:
        self._automatic = automatic
        self._known: WeakKeyDictionary[PlayedRun, dict[PolicyKind, tuple[_Question, PolicyAnswer]]] = (
            WeakKeyDictionary()
        )

    def of(
        self, run: PlayedRun, exact: Answer, drawn: DrawnPolicy, *, is_still: bool
    ) -> Mapping[PolicyKind, PolicyAnswer]:
        """Return the known values of each policy, next to the optimal answer `exact`.

        A slow evaluation may begin only if the run `is_still`.
        """
        mdp = run.learner.mdp
        waits = not is_still and mdp is not None and not is_quick(mdp)
        known = self._known.get(run, {})
        answers = {}
        for kind in PolicyKind:
            if waits and kind not in known:
                # do not build a policy only to refuse it
                answers[kind] = PolicyAnswer(refused=_refusal(kind, run, exact) or WHILE_RUNNING)
                continue
            asked = _question(kind, run, exact, drawn)
            answers[kind] = (
                asked if isinstance(asked, PolicyAnswer) else self._answer(run, kind, asked, is_still)
            )
        return answers

    def work(self, run: PlayedRun, exact: Answer, drawn: DrawnPolicy) -> bool:
        """Compute one answer that `of` lacks, and return True if there was one."""
        for kind in PolicyKind:
            asked = _question(kind, run, exact, drawn)
            if not isinstance(asked, PolicyAnswer) and self._kept(run, kind, asked) is None:
                self._work_out(run, kind, asked)
                return True
        return False

    def _answer(self, run: PlayedRun, kind: PolicyKind, asked: _Question, is_still: bool) -> PolicyAnswer:
        known = self._kept(run, kind, asked)
        if known is not None:
            return known
        if is_quick(asked.mdp) or (is_still and not self._automatic):
            return self._work_out(run, kind, asked)
        return PENDING if is_still else PolicyAnswer(refused=WHILE_RUNNING)

    def _kept(self, run: PlayedRun, kind: PolicyKind, asked: _Question) -> PolicyAnswer | None:
        question, answer = self._known.get(run, {}).get(kind, (None, PENDING))
        return answer if question is not None and asked.is_answered_by(question) else None

    def _work_out(self, run: PlayedRun, kind: PolicyKind, asked: _Question) -> PolicyAnswer:
        answer = worth_of(asked.mdp, asked.policy, asked.gamma)
        self._known.setdefault(run, {})[kind] = (asked, answer)
        return answer


def _question(
    kind: PolicyKind, run: PlayedRun, exact: Answer, drawn: DrawnPolicy
) -> _Question | PolicyAnswer:
    mdp, refused = run.learner.mdp, _refusal(kind, run, exact)
    if mdp is None or refused:
        return PolicyAnswer(refused=refused)
    policy = _policy(kind, run, exact, drawn)
    if isinstance(policy, PolicyAnswer):
        return policy
    return _Question(mdp, policy, run.learner.hyperparameters.gamma)


def _refusal(kind: PolicyKind, run: PlayedRun, exact: Answer) -> str:
    learner = run.learner
    if learner.mdp is None:
        return NO_TABLE
    if learner.mdp.states > LIVE_STATES:
        return TOO_MANY
    if kind is PolicyKind.OPTIMAL:
        return exact.refused
    return run.unknown_policies.get(kind, "")


def _policy(kind: PolicyKind, run: PlayedRun, exact: Answer, drawn: DrawnPolicy) -> FloatArray | PolicyAnswer:
    from rl_tui.agents.exact.policy_figures import greedy_policy, uniform_over, uniform_policy

    space, learner = run.world.space, run.learner
    match kind:
        case PolicyKind.UNIFORM:
            return uniform_policy(space)
        case PolicyKind.OPTIMAL:
            if exact.solution is None:
                return PENDING
            return uniform_over(space, exact.solution.greedy)
        case PolicyKind.DRAWN:
            return drawn.chances(space)
        case PolicyKind.GREEDY:
            return greedy_policy(space, learner.q, learner.hyperparameters.ties)
    return _behaviour(run)


def _behaviour(run: PlayedRun) -> FloatArray | PolicyAnswer:
    from rl_tui.agents.policies.chances import all_chances
    from rl_tui.runs.run import Run

    assert isinstance(run, Run)  # how a program explores is unknown
    learner, space = run.learner, run.world.space
    values = learner.hyperparameters
    epsilon = values.epsilon_at(learner.episodes)
    chances = all_chances(space, values, learner.rule, epsilon, learner.q, learner.visits)
    return PolicyAnswer(refused=NO_CHANCES) if chances is None else chances
