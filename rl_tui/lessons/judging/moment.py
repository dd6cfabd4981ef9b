"""A run at one step, as its replay would show it."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from rl_tui.agents.catalogue import BY_ID
from rl_tui.agents.exact.exact_model import exact_model
from rl_tui.agents.exact.policy_evaluation import NoExactAnswer, PolicyChain, Solution
from rl_tui.agents.exact.policy_figures import chance_of_ending, greedy_policy
from rl_tui.agents.exact.solve import solve
from rl_tui.lessons.judging.journal_reader import JournalReader
from rl_tui.lessons.judging.measures import MissingError, NoMomentError, NoStepError, NotYetError
from rl_tui.runs.exact_answers import AT_ONCE_STATES, DEAREST_LIVE, LIVE_STATES, NO_TABLE, Answer, visits_of
from rl_tui.runs.recipe import Recipe, TakeAction
from rl_tui.runs.run import Run
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

if TYPE_CHECKING:
    from rl_tui.agents.last_step import Author, LastStep
    from rl_tui.worlds.files.scenario import Scenario
    from rl_tui.worlds.mdp.space import FiniteSpace, FloatArray

ExactAnswer = Callable[[TabularMDP, float], Answer]
"""Returns the exact answer of a world for a γ, empty while pending."""


def exact_at_once(mdp: TabularMDP, gamma: float) -> Answer:
    """Solve `mdp` for `gamma`."""
    try:
        return Answer(solve(mdp, gamma), "")
    except NoExactAnswer as reason:
        return Answer(None, str(reason))


def why_too_dear(mdp: TabularMDP, *, value_of_policy: bool = False) -> str:
    """Return why exact results take too long, most of all a `value_of_policy`, or ""."""
    if mdp.states > LIVE_STATES or visits_of(mdp) > DEAREST_LIVE:
        return "this world is too large for exact values during a run"
    if value_of_policy and mdp.states > AT_ONCE_STATES:
        return f"policy values are not computed during a run above {AT_ONCE_STATES} states"
    return ""


class Kept:
    """Results cached between moments: names, a journal, exact results."""

    def __init__(self, exact: ExactAnswer = exact_at_once) -> None:
        self.exact = exact
        self.journal = JournalReader()
        """Facts from the journal."""
        self._space: FiniteSpace | None = None
        self._states: dict[str, int | None] = {}
        self._policy: tuple[TabularMDP, FloatArray] | None = None
        self._figures: dict[str | float, float | None] = {}
        self._optimum: tuple[TabularMDP, float, Answer] | None = None
        self._compared: tuple[Scenario, Scenario, bool] | None = None

    def is_same_world(self, one: Scenario, other: Scenario) -> bool:
        """Return True for the same world, even from different files."""
        known = self._compared
        if known is None or known[0] is not one or known[1] is not other:
            is_same = one is other or (one.kind, one.section) == (other.kind, other.section)
            known = self._compared = one, other, is_same
        return known[2]

    def state(self, space: FiniteSpace, name: str) -> int | None:
        """Return the number of the named state, if any."""
        if space is not self._space:
            self._space, self._states = space, {}
        if name not in self._states:
            names = space.state_names
            self._states[name] = names.index(name) if name in names else None
        return self._states[name]

    def of_policy(
        self, mdp: TabularMDP, policy: FloatArray, name: str | float, work_out: Callable[[], float | None]
    ) -> float | None:
        """Return a result for `policy`, `[P]`, computed once while policy and world stay."""
        known = self._policy
        if known is None or known[0] is not mdp or not np.array_equal(known[1], policy):
            self._policy, self._figures = (mdp, policy), {}
        if name not in self._figures:
            self._figures[name] = work_out()
        return self._figures[name]

    def optimum(self, mdp: TabularMDP, gamma: float) -> Answer:
        """Return the known exact answer for `gamma`."""
        known = self._optimum
        if known is None or known[0] is not mdp or known[1] != gamma or not any(known[2]):
            self._optimum = mdp, gamma, self.exact(mdp, gamma)
        assert self._optimum is not None
        return self._optimum[2]


class JudgedMoment:
    """`run` at its current step with the settings of its last step, and the `setup` of the task.

    Later settings do not apply yet, as in a replay that ends here. Members raise MissingError with a reason.
    """

    def __init__(self, run: Run, setup: Recipe, kept: Kept) -> None:
        self.run = run
        self.setup = setup
        self._kept = kept
        self.journal = kept.journal
        self.journal.read(run.recipe, run.journal, run.step, run.world.space.action_names)

    @property
    def author(self) -> Author:
        """Algorithm and settings of the last step."""
        return self.run.learner.author

    @property
    def episodes(self) -> int:
        """Finished episodes of an agent."""
        return self.run.learner.episodes - self.run.learner.planned.sweeps

    @cached_property
    def last(self) -> LastStep:
        """The last step."""
        last = self.run.learner.last_step
        if last is None:
            raise NoStepError
        return last

    @property
    def last_episode(self) -> tuple[float, int]:
        """Return and length of the last episode."""
        newest = self.run.history.newest
        if newest is None or not (self.last.terminated or self.last.truncated):
            raise NoMomentError("no episode ends with this step")
        return newest

    def taken_since(self, step: int) -> int:
        """Count the user's actions after `step`."""
        count = 0
        for entry in reversed(self.run.journal):
            if entry.step < step:
                break
            count += isinstance(entry.change, TakeAction)
        return count

    def state(self, name: str | None) -> int:
        """Return the number of a state."""
        state = self._kept.state(self.run.world.space, name or "")
        if state is None:
            raise MissingError(f"there is no state {name} here")
        return state

    def pair(self, state: str | None, action: str | None) -> int:
        """Return the number of a pair."""
        space, names = self.run.world.space, self.run.world.space.action_names
        number = self.state(state)
        if action not in names:
            raise MissingError(f"there is no action {action} here")
        pair = space.pair_of(number, names.index(action))
        if pair is None:
            raise MissingError(f"{action} is not possible in {state}")
        return pair

    def actions_in(self, state: str | None, best: Callable[[range], list[int]]) -> str:
        """Name the actions that `best` chooses in `state`."""
        space = self.run.world.space
        own = space.pairs_of(self.state(state))
        if not own:
            raise MissingError(f"no action is available in {state}")
        return ", ".join(space.action_names[space.pair_action[pair]] for pair in best(own))

    @property
    def planned_values(self) -> FloatArray | None:
        """V, `[S]`, of a planner, if any."""
        learner = self.run.learner
        if not self.journal.switch_waits:
            return next(iter(learner.remembered("v")), None) if learner.plans else None
        if not BY_ID[self.author.algorithm].planner:
            return None
        # the memory of the last step's algorithm is gone
        again = Run(self.run.recipe, evaluate=False)
        again.follow(self.run.journal[: self.journal.count], self.run.step)
        return next(iter(again.learner.remembered("v")), None)

    @cached_property
    def mdp(self) -> TabularMDP:
        """The world's current table, if small enough."""
        mdp = self.run.learner.mdp
        if mdp is None:
            raise MissingError(NO_TABLE)
        refused = why_too_dear(mdp)
        if refused:
            raise MissingError(refused)
        return mdp

    @cached_property
    def greedy(self) -> FloatArray:
        """Greedy policy, `[P]`, with the step's ties."""
        return greedy_policy(self.mdp, self.run.learner.q, self.author.hyperparameters.ties)

    @property
    def expected_return(self) -> float:
        """Exact undiscounted return of the greedy policy."""
        mdp, ties = self.mdp, self.author.hyperparameters.ties
        value = self.run.greedy_return(self.run.learner.q, ties) if mdp is not None else None
        return _known(value, "the greedy policy has no return: it may never end")

    @property
    def greedy_ends(self) -> float:
        """Probability that a greedy episode ends."""
        mdp, greedy = self.mdp, self.greedy
        ends = self._kept.of_policy(mdp, greedy, "ends", lambda: chance_of_ending(mdp, greedy))
        return _known(ends, "rounding errors would be too large")

    @property
    def value_at_start(self) -> float:
        """Exact value of the greedy policy at the start."""
        mdp, greedy, gamma = self.mdp, self.greedy, self.author.hyperparameters.gamma
        refused = why_too_dear(mdp, value_of_policy=True)
        if refused:
            raise MissingError(refused)

        def work_out() -> float | None:
            try:
                return PolicyChain(exact_model(mdp), greedy).value(gamma).at_start
            except NoExactAnswer:
                return None

        value = self._kept.of_policy(mdp, greedy, gamma, work_out)
        return _known(value, "the greedy policy has no value at this γ")

    @property
    def optimum(self) -> Solution:
        """Solution for the last γ."""
        answer = self._kept.optimum(self.mdp, self.author.hyperparameters.gamma)
        if answer.solution is None:
            raise MissingError(answer.refused) if answer.refused else NotYetError
        return answer.solution


def _known(value: float | None, otherwise: str) -> float:
    if value is None:
        raise MissingError(otherwise)
    return value
