"""Exact answers and policy values next to a program."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Final

import numpy as np

from rl_tui.live.questions import Questions
from rl_tui.live.record import Record
from rl_tui.runs.answers.policy_kind import PolicyKind
from rl_tui.runs.answers.policy_values import PENDING, TOO_MANY, WHILE_RUNNING, PolicyAnswer, worth_of
from rl_tui.runs.answers.view import AnswersView
from rl_tui.runs.exact_answers import LIVE_STATES, NO_TABLE, Answer, is_quick

if TYPE_CHECKING:
    from rl_tui.live.programs.progress import ProgramState
    from rl_tui.worlds.files.scenario import Scenario
    from rl_tui.worlds.mdp.space import FloatArray
    from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

NOT_OURS: Final = "how your program explores is not known"


class ProgramQuestions:
    """Answers about a program. `beside` has the questions about built-in runs next to it."""

    def __init__(self, record: Record, on_exact: Callable[[], None], *, automatic: bool) -> None:
        self.beside = Questions(record, on_exact, automatic=automatic)
        self._automatic = automatic
        self._known: dict[PolicyKind, tuple[TabularMDP, float, FloatArray, PolicyAnswer]] = {}

    def exact(self, progress: ProgramState, gamma: float) -> Answer:
        """Return the solution for `gamma`, as far as known."""
        return self.beside.exact.at(progress.world.world.mdp, gamma)

    def answers(
        self, progress: ProgramState, scenario: Scenario, gamma: float, *, is_still: bool
    ) -> AnswersView:
        """Return the answers known about the moment `progress`."""
        asked, mdp = self.beside, progress.world.world.mdp
        policies: Mapping[PolicyKind, PolicyAnswer] = {}
        if asked.studied is not None:
            policies = {kind: self._worth(kind, progress, gamma, is_still=is_still) for kind in PolicyKind}
        return AnswersView(
            is_hidden=mdp is not None and asked.hides_answer(scenario),
            studied=asked.studied,
            drawn=asked.drawn,
            policies=policies,
            flips=asked.flips.of(mdp),
        )

    def _worth(
        self, kind: PolicyKind, progress: ProgramState, gamma: float, *, is_still: bool
    ) -> PolicyAnswer:
        mdp = progress.world.world.mdp
        if mdp is None:
            return PolicyAnswer(refused=NO_TABLE)
        if mdp.states > LIVE_STATES:
            return PolicyAnswer(refused=TOO_MANY)
        if not is_still and not is_quick(mdp):
            return PolicyAnswer(refused=WHILE_RUNNING)
        policy = self._policy(kind, progress, gamma)
        if isinstance(policy, PolicyAnswer):
            return policy
        known = self._known.get(kind)
        if known is None or known[:2] != (mdp, gamma) or not np.array_equal(known[2], policy):
            known = mdp, gamma, policy, worth_of(mdp, policy, gamma)
            self._known[kind] = known
        return known[3]

    def _policy(self, kind: PolicyKind, progress: ProgramState, gamma: float) -> FloatArray | PolicyAnswer:
        from rl_tui.agents.exact.policy_figures import greedy_policy, uniform_over, uniform_policy

        space = progress.world.world.space
        match kind:
            case PolicyKind.UNIFORM:
                return uniform_policy(space)
            case PolicyKind.DRAWN:
                return self.beside.drawn.chances(space)
            case PolicyKind.OPTIMAL:
                exact = self.exact(progress, gamma)
                if exact.refused:
                    return PolicyAnswer(refused=exact.refused)
                return PENDING if exact.solution is None else uniform_over(space, exact.solution.greedy)
            case PolicyKind.GREEDY:
                if progress.table is None:
                    return PolicyAnswer(refused="no table was found in your program")
                return greedy_policy(space, progress.q, "random")
        return PolicyAnswer(refused=NOT_OURS)
