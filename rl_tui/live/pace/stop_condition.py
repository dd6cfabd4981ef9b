"""What a run is to stop at: what the learner watches for, and whether that was it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from rl_tui.agents.kernels.watch import Watching
from rl_tui.common.errors import UserError
from rl_tui.live.pace.until import Breakpoints, Event, Until
from rl_tui.runs.exact_answers import PENDING
from rl_tui.runs.recipe import UNLIMITED
from rl_tui.worlds.drawing import Arms

if TYPE_CHECKING:
    from rl_tui.agents.exact.policy_evaluation import Solution
    from rl_tui.agents.hyperparameters import Ties
    from rl_tui.runs.exact_answers import Answer
    from rl_tui.runs.run import Run
    from rl_tui.worlds.mdp.space import FiniteSpace, FloatArray
    from rl_tui.worlds.mdp.tabular_mdp import TabularMDP
    from rl_tui.worlds.world import World


def watching_for(until: Until | None, breakpoints: Breakpoints) -> Watching | None:
    """Return what the learner has to watch for; None for nothing."""
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
    """Waits for ``until`` in ``run``, which stands where the waiting begins.

    ``exact_answer`` is asked for that of the run as it is. Raises UserError where it cannot happen: it lies
    behind, the pair or the exact answer is not there.
    """

    def __init__(self, until: Until, run: Run, exact_answer: Callable[[], Answer]) -> None:
        self.until = until
        self.stride: int | None = None
        """After how many steps to look, None where the learner itself stops for what is waited for."""
        self._exact_answer = exact_answer
        self._optimum: Solution | None = None  # the answer by which it was looked at last
        self.steps, self.episodes = UNLIMITED, UNLIMITED
        """After how many steps or episodes, counted from the start of the run, it is over."""
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
                    raise UserError(f"there is no pair {until.pair} here")
            case Event.OPTIMAL:
                answer = exact_answer()
                if answer.refused:
                    raise UserError(f"no policy can be told to be optimal: {answer.refused}")
                if answer.solution is None:
                    raise UserError("the exact answer is still being worked out: try again in a moment")
                self._optimum = answer.solution
                if run.learner.drifted:
                    self.stride = 1  # what is best changes with every step, whatever the policy does
                if self._is_optimal(run):
                    raise UserError("the greedy policy is optimal already")

    def is_over(self, run: Run) -> bool:
        """Tell whether it has happened with the last step of ``run``."""
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
            self.stride = None  # until the answer is another one, only another policy can be optimal
        return (learner.noticed.policy or self._optimum is not before) and self._is_optimal(run)

    @property
    def pair(self) -> int | None:
        """The pair whose estimate it waits for, None where it waits for something else."""
        return self.until.pair if self.until.event is Event.VALUE else None

    def goes_on_with(self, pair: int | None) -> bool:
        """Go on in another world, where ``pair`` is the one that it waits for; False where that is gone."""
        if self.until.event is Event.OPTIMAL:
            self.stride = 1  # the policy may be optimal there as it is
        if self.pair is None:
            return True
        if pair is not None:
            self.until = replace(self.until, pair=pair)
        return pair is not None

    def _is_optimal(self, run: Run) -> bool:
        learner, optimum = run.learner, self._optimum
        if learner.mdp is None or optimum is None:
            return False
        return is_optimal(learner.mdp, learner.q, learner.hyperparameters.ties, optimum)


def is_optimal(mdp: TabularMDP, q: FloatArray, ties: Ties, optimum: Solution) -> bool:
    """Tell whether the greedy policy of ``q``, [P], is optimal from the start of an episode.

    It is if in every state it can come to it takes, of the pairs that ``optimum`` has for the best, one or
    some, and no other. At γ = 1 it has to end with probability 1 too, since otherwise it never earns what
    these promise.
    """
    from rl_tui.agents.exact.policy_evaluation import always_ends
    from rl_tui.agents.exact.policy_figures import greedy_policy

    policy = greedy_policy(mdp, q, ties)
    if not _takes_the_best(mdp, policy, optimum):
        return False
    any_choice_will_do = np.array_equal(optimum.best, optimum.greedy)
    return any_choice_will_do or always_ends(mdp, policy)


def _takes_the_best(mdp: TabularMDP, policy: FloatArray, optimum: Solution) -> bool:
    """Tell whether ``policy``, [P], takes nothing but best pairs from the start of an episode."""
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
    """Return what ``until`` waits for, as it follows the word "until"."""
    is_bandit = isinstance(world.drawing, Arms)
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


def breakpoint_in_words(run: Run) -> str:
    """Return the breakpoint that the last step of ``run`` met; empty if none."""
    noticed, space = run.learner.noticed, run.world.space
    if noticed.pair is not None:
        arm = "arm " if isinstance(run.world.drawing, Arms) else ""
        return f"breakpoint: {arm}{_pair_in_words(space, noticed.pair)}"
    return "" if noticed.state is None else f"breakpoint: state {space.state_names[noticed.state]}"


def _pair_in_words(space: FiniteSpace, pair: int) -> str:
    """Return the names of state and action of ``pair``; an only state goes without saying."""
    return space.action_names[int(space.pair_action[pair])] if space.states == 1 else space.pair_name(pair)


def _check_ahead(is_ahead: bool, wanted: str, here: str) -> None:
    if not is_ahead:
        raise UserError(f"{wanted} lies behind: this is {here}; b and m g go back")
