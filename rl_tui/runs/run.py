"""A run: a recipe, a journal, and all that they lead to."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from rl_tui.agents.catalogue import POLICY_BY_ID
from rl_tui.agents.kernels.position import Stop
from rl_tui.agents.learner import Learner
from rl_tui.agents.learner_memory import LearnerState
from rl_tui.common.errors import UserError
from rl_tui.runs.bandit import NOTHING_SETTLED, BanditFigures, SettledPulls, bandit_figures, settle
from rl_tui.runs.edited_world import EditedWorld, NextWorld, next_world
from rl_tui.runs.evaluation import MOST_STATES, Evaluation, GreedyReturn, MarksState
from rl_tui.runs.exact_answers import DEAREST_LIVE, is_quick, visits_of
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
    changed_parameter,
    no_such_action,
)
from rl_tui.runs.results import RunResults
from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray
from rl_tui.worlds.world import World

OnEpisodes = Callable[[FloatArray, IntArray, BoolArray], None]


@dataclass(frozen=True, slots=True, eq=False)
class RunState:
    """A copy of all that a run knows at one step, for checkpoints; worlds are shared by many of them."""

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
        """How much memory it takes without its world."""
        arrays = (*self.history, self.marks.episode, self.marks.value)
        return self.learner.nbytes + sum(array.nbytes for array in arrays)


class WorldChanged(NamedTuple):
    """The world of a run has become another one, after so many steps and finished episodes.

    ``given_up`` says that the episode under way ended there, unfinished; it counts in no mean.
    """

    step: int
    episodes: int
    given_up: bool


class Run:
    """What one recipe and its journal come to, step by step: the same bits however the steps are chunked.

    ``beginning`` is what :func:`begin` made of the recipe, if it is at hand; ``edited`` is its world, where
    it shares with other runs what is edited in it. ``evaluate`` takes marks, which never influence learning.
    ``episode_limit`` ends the run after so many episodes of an agent. ``on_episodes`` is called with
    the returns and lengths of finished episodes and whether each took the best arm of a bandit, [n] each, in
    order and each once.
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
        """What the run was made from."""
        world, drawn = beginning or begin(recipe)
        self.edited = edited or EditedWorld(world)
        """The world in force, and what was edited in it."""
        self.ready: NextWorld | None = None
        """What the next change of the world comes to, if that was worked out before it is made."""
        self._settled = NOTHING_SETTLED
        self.world_changes: tuple[WorldChanged, ...] = ()
        """Where on the way it became another one."""
        mdp = world.mdp
        environment = world.new_environment() if world.new_environment else None
        self.learner = Learner(world.space, recipe.algorithm, recipe.hyperparameters, drawn, environment)
        """The algorithm at work in the world."""
        self.history = History()
        """The returns and lengths of finished episodes."""
        self.episode_limit = UNLIMITED if episode_limit is None else episode_limit
        """The number of episodes of an agent after which the run is over."""
        self.stop_reason = ""
        """Why the run broke down, naming the step; empty if it did not."""
        self.timed_out = False
        """Whether the last advance ended because its time was over: see :meth:`Learner.set_time_budget`."""
        self.noticed = False
        """Whether the run came to rest after a step for which the learner watches."""
        self._journal: list[JournalEntry] = []
        self.first_actions = world.space.action_names
        """The names of the actions at first, which numbers in its journal mean."""
        self.greedy_return = GreedyReturn(lambda: self.learner.mdp)
        """What the greedy policy of estimates earns here."""
        self._evaluation = Evaluation(mdp if evaluate else None, self.greedy_return)
        self._on_episodes = on_episodes

    @property
    def world(self) -> World:
        """The world in force."""
        return self.edited.world

    @property
    def step(self) -> int:
        """How many steps were taken."""
        return self.learner.step

    @property
    def journal(self) -> tuple[JournalEntry, ...]:
        """What was changed on the way."""
        return tuple(self._journal)

    @property
    def bandit(self) -> BanditFigures | None:
        """How the pulls of a bandit were spent; None where the world is no bandit."""
        if self.world.budget is None:
            return None
        total = self.history.total_return
        return bandit_figures(self.world, self._pulled, total, self.learner.drifted, self._settled)

    @property
    def _pulled(self) -> IntArray:
        """How often each arm was pulled: a planner's backup counts as a visit of each, but pulls none."""
        return self.learner.visits - self.learner.planned.steps

    @property
    def mean_return(self) -> float | None:
        """The mean return of all finished episodes, sweeps of a planner left out; None before the first."""
        episodes = self.learner.episodes - self.learner.planned.sweeps
        return self.history.total_return / episodes if episodes else None

    @property
    def results(self) -> RunResults:
        """What it has achieved so far."""
        learner, history = self.learner, self.history
        mdp = self.world.mdp
        is_cheap = mdp is not None and mdp.states <= MOST_STATES and visits_of(mdp) <= DEAREST_LIVE
        is_evaluated = is_cheap and not self.stop_reason
        mean_return, mean_length = history.last_100
        ties = learner.hyperparameters.ties
        greedy_return = self.greedy_return(learner.q, ties) if is_evaluated else None
        return RunResults(
            curve=history.curve(),
            marks=self._evaluation.marks(),
            return_last_100=mean_return,
            length_last_100=mean_length,
            greedy_return=greedy_return,
            greedy_ends=self.greedy_return.ends if is_evaluated else None,
            behaviour_return=self._behaviour_return() if is_evaluated else None,
            bandit=self.bandit,
        )

    def _behaviour_return(self) -> float | None:
        """Return what the greedy policy last asked for earns with the ε of this episode, where it has one.

        None too where a second evaluation a frame would take too long.
        """
        learner, mdp = self.learner, self.world.mdp
        values = learner.hyperparameters
        if (
            mdp is None
            or not is_quick(mdp)
            or learner.plans
            or not POLICY_BY_ID[values.policy].explores_by_epsilon
        ):
            return None
        return self.greedy_return.softened(values.epsilon_at(learner.episodes))

    @property
    def spent(self) -> bool:
        """Whether the episodes it may take are used up; sweeps of a planner are none."""
        return self.learner.episodes >= self.episode_limit + self.learner.planned.sweeps

    @property
    def message(self) -> str:
        """Why it goes no further, as a sentence; empty while it does."""
        if not self.learner.converged:
            return self.stop_reason
        sweeps, accuracy = self.learner.planned.sweeps, self.learner.hyperparameters.accuracy
        return f"converged after {sweeps:,} sweeps: no value moved by more than {accuracy:g} in the last one"

    @property
    def over(self) -> bool:
        """Whether it takes no further step."""
        return bool(self.stop_reason) or self.learner.converged or self.spent

    def advance(self, steps: int = UNLIMITED, episodes: int = UNLIMITED) -> None:
        """Take ``steps`` steps or finish ``episodes`` episodes, whichever is first, unless it is over."""
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
                self._take_in(Stop.DONE)  # what is finished is told before the end
                raise
            self._take_in(stop)
            is_there = learner.step >= until or learner.episodes >= last_episode
            self.timed_out = stop is Stop.DONE and not is_there
            if self.noticed or self.timed_out:
                return

    def apply(self, change: Change) -> None:
        """Change something before the next step. Raises UserError, with the range, if it does not fit."""
        # A mark of this step belongs to what was in force until now
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
        if isinstance(change, SetParameter):
            learner.configure(changed_parameter(learner.hyperparameters, change.name, change.value))
            return
        try:
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
        assert mdp is not None  # what can be edited has a table
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
            raise UserError(f"{name} is not possible in state {space.state_names[state]}")
        if self.over:
            raise UserError("the run is over: no step can be taken")
        self._take_in(self.learner.take(pair))
        self._mark_if_due()

    def _order(self, change: OrderSweep) -> None:
        if self.over and not self.learner.converged:  # a planner that was done goes on with what is ordered
            raise UserError("the run is over: no sweep can be run")
        self.learner.order(change.phase)

    def follow(
        self, journal: Sequence[JournalEntry], last_step: int = UNLIMITED, last_episode: int = UNLIMITED
    ) -> None:
        """Advance along ``journal``, of which this run has applied the beginning.

        It ends at ``last_step`` or when ``last_episode`` episodes are finished, both counted from the start
        of the run, or earlier, where :meth:`advance` does. Each entry applies at its step, or at once where
        the run is beyond that, and so do all settings and orders of the step that is reached; what lies
        beyond is left out, and so is an action taken by a person at that step, since it is a step further.
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
        """Return a copy of where the run stands."""
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
        """Go back to what :meth:`checkpoint` returned, be it from another run of the same recipe."""
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
        """Take in the episodes that ended, and why the learner came back."""
        returns, lengths, optimal = self.learner.drain_episodes()
        if len(returns):
            self.history.add(returns, lengths)
            if self._on_episodes is not None:
                self._on_episodes(returns, lengths, optimal)
        self.noticed = stop is Stop.NOTICED
        if stop is not Stop.DONE:
            self.stop_reason = self.learner.stop_reason


def each_of(*listeners: OnEpisodes | None) -> OnEpisodes:
    """Return what hands episodes on to each of ``listeners`` that is there."""
    there = [listener for listener in listeners if listener is not None]

    def hand_on(returns: FloatArray, lengths: IntArray, optimal: BoolArray) -> None:
        for listener in there:
            listener(returns, lengths, optimal)

    return hand_on
