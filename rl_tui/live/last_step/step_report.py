"""The last step of a snapshot in numbers. Panels write the words."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Final

import numpy as np

from rl_tui.agents.catalogue import (
    OWN_PROGRAM,
    POLICY_BY_ID,
    Algorithm,
    Lookup,
    Policy,
    SweepPhase,
    UpdateTerms,
    algorithm_row,
)
from rl_tui.agents.hyperparameters import SAMPLE_AVERAGE, Hyperparameters
from rl_tui.agents.last_step import NOTHING, LastStep
from rl_tui.live.last_step.backup import Backup, EstimatesBefore, backup_of, sources
from rl_tui.live.last_step.gust import gust_of
from rl_tui.live.program_view import ProgramView
from rl_tui.live.snapshot import AgentView, Snapshot
from rl_tui.programs.evidence.verdict import Rule, UpdateFound, UpdateTarget
from rl_tui.worlds.mdp.space import FloatArray
from rl_tui.worlds.mdp.tabular_mdp import UNKNOWN_ACTION
from rl_tui.worlds.world import World

# The update of a program


NO_CHANGE: Final = "your program changed nothing"
NO_TABLE: Final = "no table was found, so no change is known"
_LATER: Final = "changes are known after step {:,}, where the table was found"
_OF_THE_BOOK: Final = {
    Lookup.BEST: UpdateTarget.BEST,
    Lookup.NEXT: UpdateTarget.NEXT_ACTION,
    Lookup.MEAN: UpdateTarget.EXPECTED,
}
_OTHERWISE: Final = {
    UpdateTarget.COLUMN: "max Q(·,a)",
    UpdateTarget.SAME_ACTION: "Q({next},a)",
    UpdateTarget.OWN_STATE: "max Q(s,·)",
    UpdateTarget.INDEX: "argmax Q({next},·)",
    UpdateTarget.ALLOWED: "max Q({next}, allowed)",
    UpdateTarget.DRAWN: "Q({next},b)",
}


def program_terms(terms: UpdateTerms, program: ProgramView) -> UpdateTerms:
    """Return `terms`, corrected by the update found in `program`."""
    update = program.verdict.update
    gathered = "r before" if update.uses_reward_before else "own r" if update.reward == "own" else "r"
    later = _LATER.format(program.table_from) if program.table_from else ""
    return replace(
        terms,
        gathered=gathered if terms.gathered == "r" else terms.gathered,
        bootstrap=_OTHERWISE.get(update.target, terms.bootstrap),
        waiting=NO_TABLE if program.table is None else later or NO_CHANGE,
    )


def reads_by_the_book(terms: UpdateTerms, update: UpdateFound, last: LastStep) -> bool:
    """Return True if the program's target uses the lookup in `terms`, with known ε for an expected value."""
    if _OF_THE_BOOK.get(terms.lookup) is not update.target:
        return False
    return terms.lookup is not Lookup.MEAN or update.epsilon == last.epsilon


# A planner's backup of one state


_STATE_BACKUP_TOLERANCE: Final = 1e-9


@dataclass(frozen=True, slots=True, eq=False)
class StateBackup:
    """The planner's backup of a state (Sutton & Barto, 2nd ed., equations 4.5, 4.9 and 4.10).

    Attributes:
        phase: Kind of sweep, or None for value iteration.
        q: Σ p [r + γ V(s′)] = `reward` + `gamma` · `bootstrap`, `[n]` each.
        chance: π(a|s) after the backup, `[n]`, uniform over the best for value iteration.
        value: V(s) after the backup.
        is_split: False if reward and bootstrap are unknown, because rewards drift.
    """

    state: int
    phase: SweepPhase | None
    pairs: range
    q: FloatArray
    reward: FloatArray
    bootstrap: FloatArray
    gamma: float
    chance: FloatArray
    value: float
    is_split: bool


def state_backup_of(world: World, agent: AgentView, last: LastStep) -> StateBackup | None:
    """Return the backup of the step, if there is one."""
    mdp, algorithm = world.mdp, agent.row
    pairs = world.space.pairs_of(last.state)
    if not last.planned or not last.learned or mdp is None or agent.learned_by[0] != algorithm.id:
        return None
    if not len(pairs) or not agent.holds(pairs.start):
        return None
    q = agent.q[pairs.start : pairs.stop]
    if agent.q[last.updated_pair] != last.after or not np.isfinite(q).all():
        return None  # another algorithm may have learned since
    if algorithm.takes_orders:
        if agent.sweep is None or not len(agent.policy) or not len(agent.values):
            return None
        chance, value = agent.policy[pairs.start : pairs.stop], float(agent.values[last.state])
        expected = float(chance @ q)
        is_kept = abs(expected - value) <= _STATE_BACKUP_TOLERANCE * max(1.0, abs(value))
        if agent.sweep == "evaluation" and not is_kept:
            return None
    else:
        best = q == q.max()
        chance, value = np.asarray(best / best.sum()), float(q.max())
        if value != last.after:
            return None
    first = mdp.outcomes_of(pairs.start).start
    outcomes = slice(first, mdp.outcomes_of(pairs[-1]).stop)
    owner = mdp.outcome_pair[outcomes] - pairs.start
    weighed = mdp.probability[outcomes] * mdp.reward[outcomes]
    reward: FloatArray = np.bincount(owner, weighed, minlength=len(pairs)).astype(np.float64)
    bootstrap = (q - reward) / last.gamma if last.gamma else np.zeros(len(pairs))
    return StateBackup(
        state=last.state,
        phase=agent.sweep if algorithm.takes_orders else None,
        pairs=pairs,
        q=q,
        reward=reward,
        bootstrap=bootstrap,
        gamma=last.gamma,
        chance=chance,
        value=value,
        is_split=not mdp.drift_std and last.gamma > 0.0,
    )


# The whole step


_TOLERANCE: Final = 1e-6


@dataclass(frozen=True, eq=False)
class StepStory:
    """All numbers of an agent's step, or a planner's backup."""

    world: World
    """World of the run."""
    last: LastStep
    """State, action, reward, next state, and the terms of the update."""
    algorithm: Algorithm
    """Algorithm that took the step."""
    hyperparameters: Hyperparameters
    """Hyperparameters at the step. `last` has the ε of a schedule."""
    policy: Policy
    """Policy that chose the action."""
    before: EstimatesBefore
    """Estimates before the update."""
    greedy: Sequence[int]
    """Pairs that were greedy when the action was chosen, empty if unknown."""
    chance: float | None
    """Probability of the drawn outcome, or None if unknown."""
    meant: int | None
    """Chosen action if the world may slip and the result is known, else None."""
    went: int | None
    """Action that happened, or None if `meant` is None."""
    wind: int
    """Cells that the wind moved the agent, positive upwards."""
    visits: int
    """Visits of the pair (updates, for some algorithms), or 0 for a planner."""
    planning: str
    """Progress of a planner's sweep, in words, empty for an agent."""
    rewards: Sequence[float]
    """Rewards of the episode, oldest first, only the last ones of a long episode, none for a planner."""
    discounted_return: float
    """Discounted return of the episode so far, with the γ of each step."""
    ends_episode: bool
    """True for the last step of an episode, or the last backup of a sweep."""
    mean: FloatArray | None
    """Current mean rewards, `[P]`, if they drift and are known."""
    program: ProgramView | None = None
    """The watched program that took the step, or None for a built-in agent."""

    @property
    def has_equation(self) -> bool:
        """True if the update's terms are known."""
        return self.algorithm is not OWN_PROGRAM

    @property
    def terms(self) -> UpdateTerms:
        """Symbols and words of the update."""
        terms, program = self.algorithm.update, self.program
        return terms if program is None else program_terms(terms, program)

    @property
    def reads_by_the_book(self) -> bool:
        """True if the lookup is the algorithm's own."""
        program = self.program
        return program is None or (
            self.has_equation and reads_by_the_book(self.terms, program.verdict.update, self.last)
        )

    @property
    def bootstraps(self) -> bool:
        """True with an estimate in the target."""
        return self.last.planned or self.last.bootstrap_state != NOTHING

    @property
    def step_size(self) -> float | str:
        """Step size, or the word for averages."""
        values = self.hyperparameters
        if values.sample_average:
            return SAMPLE_AVERAGE
        moves = values.step_size_schedule != "constant" and values.alpha_decay > 0.0
        return self.last.step_size if moves else values.alpha

    @property
    def has_trace(self) -> bool:
        """True if the step size is α times a trace."""
        return "traces" in self.algorithm.parameters and self.last.step_size != self.hyperparameters.alpha

    @cached_property
    def backup(self) -> Backup | None:
        """The update as a tree."""
        return backup_of(self.before, self.mean) if self.reads_by_the_book else None

    @cached_property
    def state_backup(self) -> StateBackup | None:
        """A planner's backup."""
        return state_backup_of(self.world, self.before.agent, self.last)

    @cached_property
    def sources(self) -> dict[int, float]:
        """Pairs read by the bootstrap, with weights."""
        return sources(self.before) if self.reads_by_the_book else {}

    @property
    def looked_up(self) -> list[tuple[float, float]]:
        """Weights of `sources`, each with its estimate."""
        last, q = self.last, self.before.agent.q
        return [
            (weight, last.before if pair == last.updated_pair else float(q[pair]))
            for pair, weight in self.sources.items()
        ]

    @property
    def steps(self) -> int:
        """Steps of the episode so far."""
        return max(self.last.episode_step, len(self.rewards))

    @property
    def has_one_gamma(self) -> bool:
        """True if one γ gives the return."""
        is_whole = len(self.rewards) == self.steps
        return not is_whole or self._comes_to(self.rewards, self.discounted_return)

    @property
    def gathered_rewards(self) -> Sequence[float]:
        """Rewards in a multi-step target, oldest first."""
        last, parameters = self.last, self.algorithm.parameters
        if self.terms.one_step or not last.learned or not self.rewards:
            return []
        ended = last.terminated or last.truncated
        count = last.episode_step if "n" not in parameters else 1 if ended else self.hyperparameters.n
        rewards = self.rewards[-count:]
        is_whole = len(rewards) == count and self._comes_to(rewards, last.gathered)
        return rewards if is_whole and count > 1 else []

    def _comes_to(self, rewards: Sequence[float], total: float) -> bool:
        worked_out = discounted_sum(rewards, self.last.gamma)
        return abs(worked_out - total) <= _TOLERANCE * max(1.0, abs(worked_out))


def discounted_sum(rewards: Sequence[float], gamma: float) -> float:
    """Return Σ γᵏ r of `rewards`, oldest first."""
    return sum(reward * gamma**place for place, reward in enumerate(rewards))


@lru_cache(maxsize=1)
def story_of(snapshot: Snapshot) -> StepStory | None:
    """Return the story of the last step, cached for all panels of a frame."""
    last, agent, world = snapshot.counters.last_step, snapshot.agent, snapshot.world
    if last is None:
        return None
    taken_by, hyperparameters = agent.learned_by
    algorithm = _algorithm_of(snapshot)
    before = EstimatesBefore(world, agent, last, algorithm.update)
    solution = snapshot.exact_answer.solution
    drifts = world.mdp is not None and world.mdp.drift_std and not last.planned
    (chance, meant, went), gust = _drawn(world, last), gust_of(world, last)
    return StepStory(
        world=world,
        last=last,
        algorithm=algorithm,
        hyperparameters=hyperparameters,
        policy=POLICY_BY_ID[hyperparameters.policy],
        before=before,
        greedy=[]
        if snapshot.program is not None and snapshot.program.table is None
        else _greedy_before(before, knows_others=_knows_others(snapshot, algorithm)),
        chance=chance,
        meant=meant,
        went=went,
        wind=0 if gust is None else gust.pushed,
        visits=0 if last.planned else int(agent.visits[last.pair]),
        planning=agent.planning if last.planned and taken_by == agent.algorithm else "",
        rewards=snapshot.counters.rewards.tolist(),
        discounted_return=snapshot.counters.discounted_return,
        ends_episode=last.terminated
        or last.truncated
        or (last.planned and snapshot.counters.episode_step == 0),
        mean=solution.q if drifts and solution is not None else None,
        program=snapshot.program,
    )


def _drawn(world: World, last: LastStep) -> tuple[float | None, int | None, int | None]:
    mdp = world.mdp
    if mdp is None or last.outcome == UNKNOWN_ACTION:
        return None, None, None
    chance = float(mdp.probability[last.outcome])
    meant, went = int(mdp.pair_action[last.pair]), int(mdp.outcome_action[last.outcome])
    outcomes = mdp.outcomes_of(last.pair)
    slips = bool((mdp.outcome_action[outcomes.start : outcomes.stop] != meant).any())
    return (chance, meant, went) if slips and went != UNKNOWN_ACTION else (chance, None, None)


def _algorithm_of(snapshot: Snapshot) -> Algorithm:
    agent, program = snapshot.agent, snapshot.program
    row = algorithm_row(agent.learned_by[0])
    if program is None or row is not OWN_PROGRAM or agent.author is not None:
        return row
    rule = program.verdict.update.rule
    return row if rule is Rule.UNKNOWN else algorithm_row(rule)


def _knows_others(snapshot: Snapshot, algorithm: Algorithm) -> bool:
    """Return True if an action that is not greedy before the update was not greedy when chosen."""
    last = snapshot.counters.last_step
    if snapshot.program is None:
        return last is not None and last.explored
    return algorithm is not OWN_PROGRAM and algorithm.update.lookup is not Lookup.NEXT


def _greedy_before(before: EstimatesBefore, *, knows_others: bool) -> list[int]:
    """Return the pairs that were greedy at the choice, if known.

    The choice may precede the last update, so unless `knows_others` the chosen pair must be among them.
    """
    last = before.last
    pairs = before.world.space.pairs_of(last.state)
    estimates = before.of(pairs)
    if last.planned or last.others or last.table or estimates is None:
        return []
    best = [pairs.start + int(each) for each in np.flatnonzero(estimates == estimates.max())]
    return best if knows_others or last.pair in best else []
