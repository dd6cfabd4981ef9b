"""Conditions that stop a run."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from rl_tui.agents.kernels.watch import Watching
from rl_tui.common.errors import UserError
from rl_tui.live.pace.until import Breakpoints, Event, Until
from rl_tui.runs.answers.policy_kind import PolicyKind
from rl_tui.runs.exact_answers import PENDING
from rl_tui.runs.recipe import UNLIMITED

if TYPE_CHECKING:
    from rl_tui.agents.exact.policy_evaluation import Solution
    from rl_tui.agents.hyperparameters import Ties
    from rl_tui.runs.exact_answers import Answer
    from rl_tui.runs.played_run import PlayedRun
    from rl_tui.worlds.mdp.space import FiniteSpace, FloatArray
    from rl_tui.worlds.mdp.tabular_mdp import TabularMDP
    from rl_tui.worlds.world import World


def watching_for(until: Until | None, breakpoints: Breakpoints) -> Watching | None:
    """Return what the learner has to watch for."""
    watching = Watching(states=breakpoints.states, pairs=breakpoints.pairs)
    match until:
        case Until(event=Event.REWARD):
            watching = replace(watching, reward=True)
        case Until(event=Event.POLICY_CHANGE | Event.OPTIMAL):
            watching = replace(watching, policy=True)
        case Until(event=Event.VALUE, pair=pair, threshold=threshold):
            watching = replace(watching, cell=pair, threshold=threshold)
    return None if watching == Watching() else watching


class StopCondition:
    """Waits for `until` in `run`, from its current position.

    Raises UserError for an event in the past, or an unknown pair or exact answer.
    """

    def __init__(self, until: Until, run: PlayedRun, exact_answer: Callable[[], Answer]) -> None:
        self.until = until
        self.stride: int | None = None
        """Steps between two checks, or None if the learner itself stops."""
        self._exact_answer = exact_answer
        self._optimum: Solution | None = None  # the solution of the last check
        self.steps, self.episodes = UNLIMITED, UNLIMITED
        """Step and episode, counted from the start, at which it is over."""
        match until.event:
            case Event.STEP:
                self.steps = until.number
                _check_ahead(until.number > run.step, f"step {until.number:,}", f"step {run.step:,}")
            case Event.EPISODE:
                self.episodes = until.number - 1
                _check_ahead(
                    self.episodes > run.learner.episodes,
                    f"the start of episode {until.number:,}",
                    f"episode {run.learner.episodes + 1:,}",
                )
            case Event.EPISODE_END:
                self.episodes = run.learner.episodes + 1 + until.number
            case Event.VALUE:
                if not 0 <= until.pair < run.world.space.pairs:
                    raise UserError(f"there is no state–action pair {until.pair}")
            case Event.OPTIMAL:
                answer = exact_answer()
                if answer.refused:
                    raise UserError(f"the optimal policy is unknown: {answer.refused}")
                if answer.solution is None:
                    raise UserError("the exact values are still being computed: try again in a moment")
                self._optimum = answer.solution
                if run.learner.drifted:
                    self.stride = 1  # the optimal policy changes with every step
                if self._is_optimal(run):
                    raise UserError("the greedy policy is already optimal")

    def is_over(self, run: PlayedRun) -> bool:
        """Return True if the last step caused the event."""
        learner = run.learner
        match self.until.event:
            case Event.STEP | Event.EPISODE | Event.EPISODE_END:
                return run.step >= self.steps or learner.episodes >= self.episodes
            case Event.REWARD:
                return learner.noticed.reward
            case Event.POLICY_CHANGE:
                return learner.noticed.policy
            case Event.VALUE:
                return learner.noticed.cell
        before, answer = self._optimum, self._exact_answer()
        self._optimum = answer.solution
        if learner.drifted is None and answer != PENDING:
            self.stride = None  # with an unchanged solution, only a changed policy can become optimal
        return (learner.noticed.policy or self._optimum is not before) and self._is_optimal(run)

    @property
    def pair(self) -> int | None:
        """The pair whose estimate is awaited."""
        return self.until.pair if self.until.event is Event.VALUE else None

    def goes_on_with(self, pair: int | None) -> bool:
        """Continue with `pair` in another world, or return False."""
        if self.until.event is Event.OPTIMAL:
            self.stride = 1  # the policy may already be optimal there
        if self.pair is None:
            return True
        if pair is not None:
            self.until = replace(self.until, pair=pair)
        return pair is not None

    def _is_optimal(self, run: PlayedRun) -> bool:
        learner, optimum = run.learner, self._optimum
        if learner.mdp is None or optimum is None or PolicyKind.GREEDY in run.unknown_policies:
            return False
        return is_optimal(learner.mdp, learner.q, learner.hyperparameters.ties, optimum)


def is_optimal(mdp: TabularMDP, q: FloatArray, ties: Ties, optimum: Solution) -> bool:
    """Return True if the greedy policy of `q`, `[P]`, is optimal from the start.

    In every reachable state it must take only optimal actions. At γ = 1 it must also end with probability 1,
    because otherwise it never earns the value of these actions.
    """
    from rl_tui.agents.exact.policy_evaluation import always_ends
    from rl_tui.agents.exact.policy_figures import greedy_policy

    policy = greedy_policy(mdp, q, ties)
    if not _takes_the_best(mdp, policy, optimum):
        return False
    any_choice_will_do = np.array_equal(optimum.best, optimum.greedy)
    return any_choice_will_do or always_ends(mdp, policy)


def _takes_the_best(mdp: TabularMDP, policy: FloatArray, optimum: Solution) -> bool:
    wrong = (policy > 0.0) & ~optimum.best
    if not wrong.any():
        return True
    reached = np.zeros(mdp.states, dtype=np.bool_)
    fresh = mdp.start_state
    while len(fresh):
        reached[fresh] = True
        pairs = np.flatnonzero(np.isin(mdp.pair_state, fresh) & (policy > 0.0))
        if wrong[pairs].any():
            return False
        of_pairs = np.isin(mdp.outcome_pair, pairs) & (mdp.probability > 0.0) & ~mdp.terminated
        landed = np.unique(mdp.next_state[of_pairs])
        fresh = landed[~reached[landed]]
    return True


def until_in_words(until: Until, world: World) -> str:
    """Describe `until` in words after "until"."""
    is_bandit = world.is_bandit
    match until.event:
        case Event.STEP:
            return f"{'pull' if is_bandit else 'step'} {until.number:,}"
        case Event.EPISODE:
            return f"the start of {'pull' if is_bandit else 'episode'} {until.number:,}"
        case Event.EPISODE_END if is_bandit:
            return "the next pull"
        case Event.POLICY_CHANGE if is_bandit:
            return "another greedy arm"
        case Event.OPTIMAL if is_bandit:
            return "the greedy arm is the best"
        case Event.VALUE:
            return f"Q({_pair_in_words(world.space, until.pair)}) reaches {until.threshold:g}"
    return until.event.value


def breakpoint_in_words(run: PlayedRun) -> str:
    """Describe the breakpoint just met, or ""."""
    noticed, space = run.learner.noticed, run.world.space
    if noticed.pair is not None:
        arm = "arm " if run.world.is_bandit else ""
        return f"breakpoint: {arm}{_pair_in_words(space, noticed.pair)}"
    return "" if noticed.state is None else f"breakpoint: state {space.state_names[noticed.state]}"


def _pair_in_words(space: FiniteSpace, pair: int) -> str:
    return space.action_names[int(space.pair_action[pair])] if space.states == 1 else space.pair_name(pair)


def _check_ahead(is_ahead: bool, wanted: str, here: str) -> None:
    if not is_ahead:
        raise UserError(f"{wanted} is in the past (you are at {here}); b and m g go back")
