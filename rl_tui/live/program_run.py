"""The run of a watched program, which a playback plays like a built-in run."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np

from rl_tui.agents.catalogue import OWN_PROGRAM
from rl_tui.agents.kernels.watch import NOTHING_NOTICED, WatchedEvents, Watching
from rl_tui.agents.last_step import Author
from rl_tui.common.errors import UserError
from rl_tui.live.pace.pacing import CHUNK
from rl_tui.live.pace.until import Event, Until
from rl_tui.programs.diagnosis.last_step import ProgramSteps
from rl_tui.programs.diagnosis.verdicts import Verdicts
from rl_tui.programs.evidence.code_names import declared_discount
from rl_tui.programs.evidence.verdict import MovedCell, Rule, UpdateFound
from rl_tui.programs.watched.messages import NO_LIMIT
from rl_tui.programs.watched.program_history import ProgramHistory, steps_between
from rl_tui.programs.watched.watched_program import WatchedProgram, error_in_words
from rl_tui.runs.answers.policy_kind import PolicyKind
from rl_tui.runs.edited_world import EditedWorld
from rl_tui.runs.library import recipe_for
from rl_tui.runs.recipe import UNLIMITED, Recipe, changed_parameter
from rl_tui.runs.timeline.branches import Branch, RunRecord, Timeline
from rl_tui.runs.timeline.run_group import PROGRAM

if TYPE_CHECKING:
    from rl_tui.agents.hyperparameters import Hyperparameters
    from rl_tui.agents.learner_counters import Counters
    from rl_tui.programs.watched.program_world import ProgramWorld
    from rl_tui.runs.results import RunResults
    from rl_tui.runs.timeline.table_samples import CellHistory
    from rl_tui.runs.timeline.trail import Trail
    from rl_tui.worlds.mdp.space import FloatArray, IntArray
    from rl_tui.worlds.mdp.tabular_mdp import TabularMDP
    from rl_tui.worlds.world import World


# What is known about its learning


_BUILT_IN: Final[Mapping[Rule, str]] = {
    Rule.Q_LEARNING: "q-learning",
    Rule.SARSA: "sarsa",
    Rule.EXPECTED_SARSA: "expected-sarsa",
}


class Found(NamedTuple):
    """What is known about the learning of a program."""

    algorithm: str
    hyperparameters: Hyperparameters
    gamma_source: str


def found_of(update: UpdateFound, numbers: Mapping[str, float], usual: Hyperparameters) -> Found:
    """Combine the update with the `numbers` in the code and the defaults `usual`, in this order of
    preference.
    """
    declared = declared_discount(numbers)
    gamma, source = update.gamma, "found"
    if declared is not None and not gamma:  # with γ = 0 the target has no next state
        gamma, source = declared[1], "declared"
    elif gamma is None:
        gamma, source = usual.gamma, "usual"
    values = usual
    for name, value in (("gamma", gamma), ("alpha", update.alpha), ("epsilon", update.epsilon)):
        if value is not None and math.isfinite(value):
            with suppress(UserError):  # the program's value may be outside our ranges
                values = changed_parameter(values, name, value)
    is_plain = update.place is MovedCell.TAKEN and update.alpha is not None
    algorithm = _BUILT_IN.get(update.rule, OWN_PROGRAM.id) if is_plain else OWN_PROGRAM.id
    return Found(algorithm, values, source)


def usual_recipe(world: ProgramWorld, seed: int) -> Recipe:
    """Return the default recipe for `world`."""
    return recipe_for(world.scenario, {}, seed)


# Its agent


class ProgramLearner:
    """The agent of `run` at the shown moment: a `PlayedAgent`."""

    converged = False
    drifted = None
    phase = None
    planning = ""

    def __init__(self, run: ProgramRun) -> None:
        self._run = run
        self.seconds = CHUNK
        """Seconds that an advance waits for the program."""

    @property
    def algorithm(self) -> str:
        """Id of the algorithm with the same update, or of a program's own."""
        return self._run.found.algorithm

    @property
    def hyperparameters(self) -> Hyperparameters:
        """The values that were found, else the defaults."""
        return self._run.found.hyperparameters

    @property
    def q(self) -> FloatArray:
        """Estimates, `[P]`, or 0 without a table."""
        return self._run.history.shown.q

    @property
    def visits(self) -> IntArray:
        """How often each pair was taken, `[P]`."""
        return self._run.history.shown.visits

    @property
    def episodes(self) -> int:
        """Finished episodes."""
        return self._run.history.shown.episodes

    @property
    def counters(self) -> Counters:
        """Steps, episodes, state of the agent, and the last step."""
        return self._run.steps.counters

    @property
    def begins_episode(self) -> bool:
        """True if an episode has just ended, or nothing has happened yet."""
        history = self._run.history
        return history.begin_of_episode(self.episodes + 1) >= history.shown.step

    @property
    def author(self) -> Author | None:
        """The program itself if the last step is unexplained."""
        return None if self._run.steps.is_explained else Author(OWN_PROGRAM.id, self.hyperparameters)

    @property
    def noticed(self) -> WatchedEvents:
        """Watched events of the last step, if the program rests after it."""
        return self._run.events

    @property
    def mdp(self) -> TabularMDP | None:
        """Transition table, or None."""
        return self._run.world.mdp

    def remembered(self, *_: str) -> tuple[FloatArray, ...]:
        """Return nothing: only one table of a program is known."""
        return ()

    def set_time_budget(self, seconds: float) -> None:
        """Wait for at most `seconds` in the next advance."""
        self.seconds = seconds


# The run


ENDED_BY_ITSELF: Final = "your program has ended"
NOT_OURS: Final = "how your program explores is not known"
_NO_TABLE: Final = "no table was found in your program"
_AT_A_STOP: Final = 0.05
"""Seconds that a pause waits for the program. It usually responds at once."""


class ProgramRun:
    """What `program`, ready for its first step, has recorded: a `Playing` and its `PlayedRun`. The program
    cannot go back. Its past is shown from the recording, and it goes on from its newest step.

    Args:
        program: The watched program.
        on_news: Called from any thread when a verdict has arrived.
        automatic: False if it advances only on command.
        edited: Its world, if other runs share it.
    """

    seek = None
    world_changes = ()
    journal = ()
    trail_to_find = 0

    def __init__(
        self,
        program: WatchedProgram,
        on_news: Callable[[], None],
        *,
        automatic: bool,
        edited: EditedWorld | None = None,
    ) -> None:
        self.program = program
        """The watched program."""
        self.history = ProgramHistory(program.log.recording, program.world)
        """Its recorded history."""
        self.verdicts = Verdicts(on_news, automatic=automatic)
        """Results of the diagnosis."""
        self.usual = usual_recipe(program.world, program.request.seed)
        """Default recipe of its world."""
        self.edited = edited or EditedWorld(program.world.world)
        """Its world."""
        self.learner = ProgramLearner(self)
        """Its agent."""
        self.begun_at: int | None = None
        """Step at which an episode was sought by its beginning."""
        self.events: WatchedEvents = NOTHING_NOTICED
        """Watched events of the last step, if it rests after it."""
        self._watching = Watching()
        self._is_to_arm = False  # new events to stop at, once it rests
        self._last_episode: int | None = None  # number of finished episodes at which it stops
        self._found: tuple[UpdateFound, Found] | None = None
        self._steps: tuple[object, ProgramSteps] | None = None
        self._take_in()

    @property
    def run(self) -> ProgramRun:
        """Itself: a program has one position."""
        return self

    @property
    def found(self) -> Found:
        """What is known about its learning."""
        update = self.verdicts.newest.update
        if self._found is None or self._found[0] is not update:
            values = found_of(update, self.program.log.numbers, self.usual.hyperparameters)
            self._found = update, values
        return self._found[1]

    @property
    def recipe(self) -> Recipe:
        """Its world and seed, with what is known about its learning."""
        found = self.found
        return replace(self.usual, algorithm=found.algorithm, hyperparameters=found.hyperparameters)

    @property
    def world(self) -> World:
        """Its world."""
        return self.edited.world

    @property
    def step(self) -> int:
        """The shown step."""
        return self.history.shown.step

    @property
    def results(self) -> RunResults:
        """Results up to the shown step."""
        return self.history.shown.results

    @property
    def steps(self) -> ProgramSteps:
        """The last steps before the shown moment."""
        shown, update = self.history.shown, self.verdicts.newest.update
        gamma = self.learner.hyperparameters.gamma
        key = (shown, shown.step, shown.table is None, update, gamma)
        if self._steps is None or self._steps[0] != key:
            self._steps = key, ProgramSteps(shown, update, gamma)
        return self._steps[1]

    @property
    def timeline(self) -> Timeline:
        """The shown step in the recording."""
        return Timeline((Branch(PROGRAM, end=self.history.newest.step, here=self.step),), 0)

    @property
    def record(self) -> RunRecord:
        """Its usual recipe: a program is not saved in sessions."""
        return RunRecord(self.usual)

    @property
    def trail(self) -> Trail:
        """Last steps of the episode, oldest first."""
        return self.steps.trail

    def find_trail(self, seconds: float) -> None:
        """Do nothing: the trail is known."""

    def cell_history(self, pair: int) -> CellHistory | None:
        """Return the history of the estimate of `pair` up to the shown step, or None without a table."""
        return self.history.cell(pair)

    @property
    def noticed(self) -> bool:
        """True if it rests at a watched event."""
        return self.events != NOTHING_NOTICED

    @property
    def over(self) -> bool:
        """True if it has ended, and its last step is shown."""
        return self.program.is_over and not self.history.in_past

    @property
    def spent(self) -> bool:
        """True if its code has run to the end."""
        log = self.program.log
        return self.over and log.error is None and not log.refused

    @property
    def message(self) -> str:
        """Why it has ended, as a sentence, empty if it has not."""
        log = self.program.log
        if not self.over:
            return ""
        if log.refused:
            return f"your program cannot be watched: {log.refused}"
        return ENDED_BY_ITSELF if log.error is None else f"your program stopped: {error_in_words(log.error)}"

    @property
    def unknown_policies(self) -> Mapping[PolicyKind, str]:
        """Policies without values, each with the reason."""
        known = {PolicyKind.BEHAVIOUR: NOT_OURS}
        return known if self.history.shown.table is not None else known | {PolicyKind.GREEDY: _NO_TABLE}

    # Going on

    def watch(self, watching: Watching | None) -> None:
        """Stop right after the event `watching`, from the next step if it rests, else within a moment."""
        self._watching = watching or Watching()
        if self._last_episode is None:
            self._arm()
        else:  # episodes are counted from a rest
            self._is_to_arm = True
            self.program.hold()

    def _arm(self, episodes: int | None = None) -> None:
        """Tell the program what to stop at, at the latest after `episodes` episodes."""
        self._is_to_arm = False
        asked = asked_for(self._watching, self.program.world)
        if episodes is not None:
            asked["episode_ends"] = max(1, episodes)
        self.program.stop_at(asked)

    def advance(self, steps: int = UNLIMITED, episodes: int = UNLIMITED) -> None:
        """Permit at most `steps` and `episodes`, and wait for a moment. In the past, show a later step."""
        history, program = self.history, self.program
        self.begun_at = None
        if history.in_past:
            history.show(history.shown.step + steps)
            return
        before = self._last_episode
        self._last_episode = None if episodes == UNLIMITED else history.newest.episodes + episodes
        if program.is_settled:
            self._arm(None if self._last_episode is None else episodes)
        elif self._last_episode != before:
            self._is_to_arm = True
            program.hold()
        if not self._is_to_arm:
            program.let(min(history.newest.step + steps, NO_LIMIT))
        self.listen(self.learner.seconds)

    def hold(self) -> None:
        """Take no further step, and wait for a moment until the program rests."""
        self.program.hold()
        if not self.program.is_settled:
            self.listen(_AT_A_STOP)

    def listen(self, seconds: float = 0.0) -> bool:
        """Read the program's messages for at most `seconds`, until it rests or ends. Return True for news."""
        program, until, has_news = self.program, time.monotonic() + seconds, False
        while True:
            left = max(0.0, until - time.monotonic())
            has_news |= program.listen(min(left, CHUNK))
            if program.is_settled or left <= 0.0:
                break
        return self._take_in() or has_news

    def _take_in(self) -> bool:
        """Advance the newest moment to the known steps, and return True for news."""
        newest, known = self.history.newest, self.program.known
        has_news = newest.step < known or (newest.table is None and self.program.log.table is not None)
        if has_news:
            self.history.go_on(known)
        self._found = None  # the numbers in its code may have changed
        self.events = self._noticed_events()
        return has_news

    def _noticed_events(self) -> WatchedEvents:
        met, newest = self.program.stopped_by, self.history.newest
        if not self.program.is_at_rest or not newest.step:
            return NOTHING_NOTICED
        events = WatchedEvents(met == "reward", met == "policy", met == "value")
        last = steps_between(newest.recording, newest.step - 1, newest.step)
        if not len(last.state) or not (self._watching.states or self._watching.pairs):
            return events
        world = newest.world
        pair = world.pair(int(last.state[0]), int(last.action[0]), int(last.episode_step[0]))
        state = world.landing(
            int(last.next_state[0]), float(last.reward[0]), terminated=bool(last.terminated[0])
        )
        return events._replace(
            state=state if state in self._watching.states else None,
            pair=pair if pair in self._watching.pairs else None,
        )

    # Its past

    def seek_to(
        self, *, step: int | None = None, episode: int | None = None, branch: int | None = None
    ) -> None:
        """Show a step or the beginning of an episode (from 1), as far as recorded. There is one branch."""
        self.begun_at = None
        if episode is not None:
            step = self.begun_at = self.history.begin_of_episode(episode)
        if step is not None:
            self.history.show(step)

    def continue_seek(self, steps: int) -> int:
        """Return 0: a seek is over at once."""
        return 0

    def stop_seek(self) -> None:
        """Do nothing: a seek is over at once."""

    def return_to_newest(self) -> None:
        """Show the newest step, where the program goes on."""
        self.history.shown = self.history.newest

    def recorded_step(self, until: Until) -> int | None:
        """Return the first recorded step after the shown one at which `until` happened. None if there is
        none, or if it does not depend on steps only.
        """
        history, shown, newest = self.history, self.history.shown, self.history.newest
        match until.event:
            case Event.STEP if shown.step < until.number <= newest.step:
                return until.number
            case Event.EPISODE if shown.episodes < until.number - 1 <= newest.episodes:
                return history.begin_of_episode(until.number)
            case Event.EPISODE_END if shown.episodes + until.number < newest.episodes:
                return history.begin_of_episode(shown.episodes + until.number + 2)
            case Event.REWARD:
                rewarded = np.flatnonzero(steps_between(history.recording, shown.step, newest.step).reward)
                return shown.step + int(rewarded[0]) + 1 if len(rewarded) else None
        return None


def asked_for(watching: Watching, world: ProgramWorld) -> dict[str, Any]:
    """Translate `watching` to a request to the program, as in messages.py."""
    asked: dict[str, Any] = {}
    if watching.reward:
        asked["reward"] = True
    if watching.policy:
        asked["policy"] = True
    if watching.cell is not None:
        asked["value"] = [int(world.cell_of_pair[watching.cell]), watching.threshold]
    if watching.states:
        states = np.array(sorted(watching.states))
        seen = np.isin(world.state_of, states) | np.isin(world.first_state_of, states)
        asked["states"] = np.flatnonzero(seen).tolist()
    if watching.pairs:
        asked["cells"] = sorted({int(world.cell_of_pair[pair]) for pair in watching.pairs})
    return asked
