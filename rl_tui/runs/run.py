"""A run: the state that follows from a recipe and a journal."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from rl_tui.agents.catalogue import POLICY_BY_ID
from rl_tui.agents.kernels.position import Stop
from rl_tui.agents.learner import Learner
from rl_tui.agents.learner_memory import LearnerState
from rl_tui.common.errors import UserError
from rl_tui.runs.answers.policy_kind import BROKE_DOWN, PLANS, PolicyKind
from rl_tui.runs.bandit import NOTHING_SETTLED, BanditFigures, SettledPulls, bandit_figures, settle
from rl_tui.runs.edited_world import EditedWorld, NextWorld, next_world
from rl_tui.runs.evaluation import NO_FIGURES, Evaluation, GreedyReturn, MarksState
from rl_tui.runs.history import History
from rl_tui.runs.recipe import (
    UNLIMITED,
    Beginning,
    Change,
    JournalEntry,
    OrderSweep,
    Recipe,
    SetParameter,
    Setting,
    TakeAction,
    WorldChange,
    action_called,
    begin,
    no_such_action,
)
from rl_tui.runs.results import RunResults
from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray
from rl_tui.worlds.world import World

OnEpisodes = Callable[[FloatArray, IntArray, BoolArray], None]


@dataclass(frozen=True, slots=True, eq=False)
class RunState:
    """A copy of a run's state. Checkpoints share their worlds."""

    step: int
    episodes: int
    begins_episode: bool
    learner: LearnerState
    history: tuple[IntArray | FloatArray, ...]
    marks: MarksState
    journal: tuple[JournalEntry, ...]
    stop_reason: str
    edited: EditedWorld
    world_changes: tuple[WorldChanged, ...]
    settled: SettledPulls

    @property
    def nbytes(self) -> int:
        """Memory in bytes, without the world."""
        arrays = (*self.history, self.marks.episode, self.marks.value)
        return self.learner.nbytes + sum(array.nbytes for array in arrays)


class WorldChanged(NamedTuple):
    """An edit of the world. `given_up` means that it ended an episode, which counts in no mean."""

    step: int
    episodes: int
    given_up: bool


class Run:
    """A run of one recipe and its journal. The bits do not depend on how the steps are divided.

    Args:
        recipe: Start of the run.
        beginning: Result of `begin(recipe)`, if already built.
        edited: World of `beginning`, to share its edits.
        evaluate: Take marks of the greedy return, without influence on learning.
        episode_limit: Most episodes of an agent.
        on_episodes: Receives returns, lengths and best arms taken, `[n]` each, once, in order.
    """

    def __init__(
        self,
        recipe: Recipe,
        beginning: Beginning | None = None,
        *,
        edited: EditedWorld | None = None,
        evaluate: bool = True,
        episode_limit: int | None = None,
        on_episodes: OnEpisodes | None = None,
    ) -> None:
        self.recipe = recipe
        world, drawn = beginning or begin(recipe)
        self.edited = edited or EditedWorld(world)
        """The current world with its edits."""
        self.ready: NextWorld | None = None
        """A result of the next edit that was computed in advance, or None."""
        self._settled = NOTHING_SETTLED
        self.world_changes: tuple[WorldChanged, ...] = ()
        mdp = world.mdp
        environment = world.new_environment() if world.new_environment else None
        self.learner = Learner(world.space, recipe.algorithm, recipe.hyperparameters, drawn, environment)
        self.history = History()
        self.episode_limit = UNLIMITED if episode_limit is None else episode_limit
        """Number of an agent's episodes after which the run ends."""
        self.stop_reason = ""
        """Why the run broke down, with the step, empty if it did not."""
        self.timed_out = False
        """True if the last advance reached its time limit. See `Learner.set_time_budget`."""
        self.noticed = False
        """True if the run stopped at a step that the learner watches for."""
        self._journal: list[JournalEntry] = []
        self.first_actions = world.space.action_names
        """Names of the actions at the start. Numbers in the journal refer to them."""
        self.greedy_return = GreedyReturn(lambda: self.learner.mdp)
        self._evaluation = Evaluation(mdp if evaluate else None, self.greedy_return)
        self._on_episodes = on_episodes

    @property
    def world(self) -> World:
        """The current world."""
        return self.edited.world

    @property
    def step(self) -> int:
        """Steps taken."""
        return self.learner.step

    @property
    def journal(self) -> tuple[JournalEntry, ...]:
        """A copy of all changes so far; slow if there are many."""
        return tuple(self._journal)

    @property
    def changes(self) -> int:
        """Number of entries in the journal."""
        return len(self._journal)

    @property
    def bandit(self) -> BanditFigures | None:
        """Regret and pulls of a bandit, else None."""
        if self.world.budget is None:
            return None
        total = self.history.total_return
        return bandit_figures(self.world, self._pulled, total, self.learner.drifted, self._settled)

    @property
    def _pulled(self) -> IntArray:
        """Pulls of each arm, `[P]`, without backups of a planner."""
        return self.learner.visits - self.learner.planned.steps

    @property
    def mean_return(self) -> float | None:
        """Mean return of episodes, without sweeps, or None."""
        episodes = self.learner.episodes - self.learner.planned.sweeps
        return self.history.total_return / episodes if episodes else None

    @property
    def results(self) -> RunResults:
        """Results so far."""
        learner, values = self.learner, self.learner.hyperparameters
        mean_return, mean_length = self.history.last_100
        explores = not learner.plans and POLICY_BY_ID[values.policy].explores_by_epsilon
        epsilon = values.epsilon_at(learner.episodes) if explores else None
        greedy = (
            NO_FIGURES if self.stop_reason else self.greedy_return.figures(learner.q, values.ties, epsilon)
        )
        return RunResults(
            curve=self.history.curve(),
            marks=self._evaluation.marks(),
            return_last_100=mean_return,
            length_last_100=mean_length,
            greedy_return=greedy.expected_return,
            greedy_ends=greedy.ends,
            behaviour_return=greedy.softened,
            bandit=self.bandit,
            first_reward_episode=learner.first_reward_episode,
        )

    @property
    def spent(self) -> bool:
        """True if all allowed episodes are used (sweeps do not count)."""
        return self.learner.episodes >= self.episode_limit + self.learner.planned.sweeps

    @property
    def message(self) -> str:
        """Why the run has ended, empty if it has not."""
        if not self.learner.converged:
            return self.stop_reason
        sweeps, accuracy = self.learner.planned.sweeps, self.learner.hyperparameters.accuracy
        return f"converged after {sweeps:,} sweeps: no value moved by more than {accuracy:g} in the last one"

    @property
    def unknown_policies(self) -> Mapping[PolicyKind, str]:
        """Policies without values, each with the reason."""
        if self.stop_reason:
            return {PolicyKind.GREEDY: BROKE_DOWN, PolicyKind.BEHAVIOUR: BROKE_DOWN}
        return {PolicyKind.BEHAVIOUR: PLANS} if self.learner.plans else {}

    @property
    def over(self) -> bool:
        """True if the run takes no further step."""
        return bool(self.stop_reason) or self.learner.converged or self.spent

    def advance(self, steps: int = UNLIMITED, episodes: int = UNLIMITED) -> None:
        """Take at most `steps` steps and finish at most `episodes` episodes."""
        learner = self.learner
        last_step = learner.step + steps
        last_episode = learner.episodes + episodes
        if not learner.plans:
            last_episode = min(last_episode, self.episode_limit + learner.planned.sweeps)
        self.timed_out = self.noticed = False
        while not self.stop_reason:
            self._mark_if_due()
            if self.over or learner.step >= last_step or learner.episodes >= last_episode:
                return
            mark = self._evaluation.next_step
            until = last_step if mark is None else min(last_step, mark)
            try:
                stop = learner.advance(until - learner.step, last_episode - learner.episodes)
            except KeyboardInterrupt:
                self._take_in(Stop.DONE)  # record finished episodes before the interrupt
                raise
            self._take_in(stop)
            is_there = learner.step >= until or learner.episodes >= last_episode
            self.timed_out = stop is Stop.DONE and not is_there
            if self.noticed or self.timed_out:
                return

    def apply(self, change: Change) -> None:
        """Make a change before the next step. Raises UserError."""
        # a mark at this step belongs to the state before the change
        self._mark_if_due()
        entry = JournalEntry(self.step, change)
        if isinstance(change, TakeAction):
            self._take(change.action)
        elif isinstance(change, OrderSweep):
            self._order(change)
        elif isinstance(change, WorldChange):
            self._change_world(change)
        else:
            self._set(change)
        self._journal.append(entry)

    def _set(self, change: Setting) -> None:
        learner = self.learner
        try:
            if isinstance(change, SetParameter):
                learner.configure(learner.hyperparameters.changed(change.name, change.value))
            else:
                learner.switch(change.algorithm)
        except ValueError as fault:
            raise UserError(str(fault)) from fault

    def _change_world(self, change: WorldChange) -> None:
        if self.stop_reason:
            raise UserError(f"the run is over: {self.stop_reason}")
        ready, self.ready = self.ready, None
        if ready is None or ready.before is not self.edited or ready.change != change:
            ready = next_world(self.edited, change, self.recipe)
        before, _, now, carried = ready
        mdp = now.world.mdp
        assert mdp is not None  # an editable world has a table
        pulled, drifted = self._pulled, self.learner.drifted
        given_up = self.learner.change_world(mdp, carried)
        if now.world.budget is not None and before.world.mdp is not None:
            settled = settle(before.world.mdp, pulled, self._settled, drifted)
            self._settled = settled._replace(visits=self._pulled)
        self.edited = now
        self.world_changes += (WorldChanged(self.step, self.learner.episodes, given_up),)
        self._evaluation.change_world(mdp)

    def _take(self, wanted: int | str) -> None:
        space, state = self.world.space, self.learner.state
        names = space.action_names
        action = wanted if isinstance(wanted, int) else action_called(wanted, names)
        if action is None:
            raise UserError(no_such_action(str(wanted), names))
        pair = space.pair_of(state, action)
        if pair is None:
            known = 0 <= action < len(names)
            name = names[action] if known else f"action {wanted}"
            raise UserError(f"{name} is not available in state {space.state_names[state]}")
        if self.over:
            raise UserError("the run is over: no step can be taken")
        self._take_in(self.learner.take(pair))
        self._mark_if_due()

    def _order(self, change: OrderSweep) -> None:
        if self.over and not self.learner.converged:  # a converged planner continues after an order
            raise UserError("the run is over: no sweep can be run")
        self.learner.order(change.phase)

    def follow(
        self, journal: Sequence[JournalEntry], last_step: int = UNLIMITED, last_episode: int = UNLIMITED
    ) -> None:
        """Advance along `journal`, whose first entries have already been applied.

        It stops after `last_step` steps or `last_episode` episodes in all, or where `advance` stops. Entries
        of the last step apply, except actions.
        """
        learner, stopped = self.learner, False
        while True:
            here, applied = learner.step, len(self._journal)
            ahead = journal[applied] if applied < len(journal) else None
            due = None if ahead is None or ahead.step > here else ahead.change
            if due is not None and not isinstance(due, TakeAction):
                self.apply(due)
                continue
            if stopped or self.over or here >= last_step or learner.episodes >= last_episode:
                break
            if due is not None:
                self.apply(due)
            else:
                until = last_step if ahead is None else min(last_step, ahead.step)
                self.advance(until - here, last_episode - learner.episodes)
            stopped = self.noticed or self.timed_out or learner.step == here
        self._mark_if_due()

    def checkpoint(self) -> RunState:
        """Return a copy of the state."""
        return RunState(
            self.step,
            self.learner.episodes,
            self.learner.begins_episode,
            self.learner.checkpoint(),
            self.history.checkpoint(),
            self._evaluation.checkpoint(),
            self.journal,
            self.stop_reason,
            self.edited,
            self.world_changes,
            self._settled,
        )

    def restore(self, state: RunState) -> None:
        """Restore a state from `checkpoint` of this recipe."""
        if state.edited.world is not self.world:
            mdp = state.edited.world.mdp
            assert mdp is not None  # a run without a table has one world and no checkpoints
            self.learner.enter(mdp)
            self._evaluation.change_world(mdp)
        self.edited, self.world_changes = state.edited, state.world_changes
        self._settled = state.settled
        self.learner.restore(state.learner)
        self.stop_reason, self.noticed = state.stop_reason, False
        self.history.restore(state.history)
        self._evaluation.restore(state.marks)
        self._journal = list(state.journal)

    def _mark_if_due(self) -> None:
        if self.learner.step == self._evaluation.next_step and not self.stop_reason:
            ties = self.learner.hyperparameters.ties
            self._evaluation.mark(self.learner.episodes, self.learner.q, ties)

    def _take_in(self, stop: Stop) -> None:
        returns, lengths, optimal = self.learner.drain_episodes()
        if len(returns):
            self.history.add(returns, lengths)
            if self._on_episodes is not None:
                self._on_episodes(returns, lengths, optimal)
        self.noticed = stop is Stop.NOTICED
        if stop is not Stop.DONE:
            self.stop_reason = self.learner.stop_reason


def each_of(*listeners: OnEpisodes | None) -> OnEpisodes:
    """Return a listener that calls each of `listeners` except None."""
    there = [listener for listener in listeners if listener is not None]

    def hand_on(returns: FloatArray, lengths: IntArray, optimal: BoolArray) -> None:
        for listener in there:
            listener(returns, lengths, optimal)

    return hand_on
