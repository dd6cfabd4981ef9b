"""The run of a watched program, played like a built-in one."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from rl_tui.agents.kernels.watch import NOTHING_NOTICED, WatchedEvents, Watching
from rl_tui.live.pace.pacing import CHUNK
from rl_tui.live.pace.until import Event, Until
from rl_tui.programs.diagnosis.program_learner import Found, ProgramLearner, found_of
from rl_tui.programs.diagnosis.verdicts import Verdicts
from rl_tui.programs.evidence.verdict import CodeFault, UpdateFound
from rl_tui.programs.watched.messages import NO_LIMIT
from rl_tui.programs.watched.program_history import ProgramHistory, steps_between
from rl_tui.programs.watched.watched_program import WatchedProgram, error_in_words
from rl_tui.runs.answers.policy_kind import PolicyKind
from rl_tui.runs.edited_world import EditedWorld
from rl_tui.runs.library import recipe_for
from rl_tui.runs.recipe import UNLIMITED, Recipe
from rl_tui.runs.timeline.branches import Branch, RunRecord, Timeline
from rl_tui.runs.timeline.run_group import PROGRAM

if TYPE_CHECKING:
    from rl_tui.programs.watched.program_world import ProgramWorld
    from rl_tui.runs.results import RunResults
    from rl_tui.runs.timeline.table_samples import CellHistory
    from rl_tui.runs.timeline.trail import Trail


def usual_recipe(world: ProgramWorld, seed: int) -> Recipe:
    """Return the default recipe for `world`."""
    return recipe_for(world.scenario, {}, seed)


# The run


ENDED_BY_ITSELF: Final = "your program has ended"
NOT_OURS: Final = "how your program explores is not known"
_UNKNOWN: Final[Mapping[PolicyKind, str]] = {PolicyKind.BEHAVIOUR: NOT_OURS}
_NO_TABLE: Final = {**_UNKNOWN, PolicyKind.GREEDY: "no table was found in your program"}
_AT_A_STOP: Final = 0.05
"""Seconds that a pause waits for the program. It usually responds at once."""


class ProgramRun:
    """The recording of `program`, ready for its first step: a `Playing` and its `PlayedRun`.

    Its past is shown from the recording, and cannot be changed. `on_news` is called from any thread for a
    verdict. `edited` is its world, if other runs share it.
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
        self.run = self
        self.program = program
        self.history = ProgramHistory(program.log.recording, program.world)
        self.verdicts = Verdicts(on_news, automatic=automatic)
        self.usual = usual_recipe(program.world, program.request.seed)
        """Default recipe of its world."""
        self.edited = edited or EditedWorld(program.world.world)
        self.world = self.edited.world
        self.verdict = self.verdicts.newest
        """The verdict that the agent's settings follow."""
        self.begun_at: int | None = None
        """Step at which an episode was sought by its beginning."""
        self.step = 0
        self.found: Found
        self.recipe: Recipe
        """Its world and seed, with what is known about its learning."""
        self.learner: ProgramLearner
        self.unknown_policies: Mapping[PolicyKind, str] = _NO_TABLE
        self.events = NOTHING_NOTICED
        """Watched events of the last step, if it rests after it."""
        self.noticed = False
        self.over = False
        """True if it has ended, and its last step is shown."""
        self.message = ""
        self._watching = Watching()
        self._is_to_arm = False  # new events to stop at, once it rests
        self._last_episode: int | None = None  # number of finished episodes at which it stops
        self._traced: set[CodeFault] = set()  # findings for which lines were already requested
        self._known: tuple[UpdateFound, Mapping[str, float]] | None = None
        self._moment: tuple[object, ...] = ()
        self._take_in()

    def look(self) -> None:
        """Update agent and settings to the shown moment and the newest verdict."""
        shown, log, update = self.history.shown, self.program.log, self.verdict.update
        if self._known is None or self._known[0] is not update or self._known[1] is not log.numbers:
            self._known = update, log.numbers
            self.found = found_of(update, log.numbers, self.usual.hyperparameters)
            algorithm, hyperparameters, _ = self.found
            self.recipe = replace(self.usual, algorithm=algorithm, hyperparameters=hyperparameters)
        moment = (shown, shown.step, shown.table is None, update, self.found)
        if moment != self._moment:
            self._moment = moment
            self.step = shown.step
            self.learner = ProgramLearner(shown, update, self.found)
            self.unknown_policies = _NO_TABLE if shown.table is None else _UNKNOWN
        self.learner.noticed, self.noticed = self.events, self.events != NOTHING_NOTICED
        self.over = self.program.is_over and shown is self.history.newest
        self.message = self._why_over() if self.over else ""

    def examine(self, *, is_still: bool) -> bool:
        """Start a verdict when due, or if the program `is_still`. Return True for a new one."""
        self.verdicts.look(self.program.log, is_still=is_still)
        newest = self.verdicts.newest
        if newest is self.verdict:
            return False
        self.verdict = newest
        found = {each.fault for each in newest.findings}
        if not found <= self._traced:
            self._traced |= found
            self.program.trace()
        self.look()
        return True

    @property
    def results(self) -> RunResults:
        """Results up to the shown step."""
        return self.history.shown.results

    @property
    def timeline(self) -> Timeline:
        """The shown step in the recording."""
        return Timeline((Branch(PROGRAM, end=self.history.newest.step, here=self.step),), 0)

    @property
    def record(self) -> RunRecord:
        """Its recipe: programs are not saved."""
        return RunRecord(self.usual)

    @property
    def trail(self) -> Trail:
        """Last steps, oldest first."""
        return self.learner.trail

    def find_trail(self, seconds: float) -> None:
        """Do nothing: the trail is known."""

    def cell_history(self, pair: int) -> CellHistory | None:
        """Return an estimate's history up to the shown step."""
        return self.history.cell(pair)

    @property
    def spent(self) -> bool:
        """True if its code has ended."""
        log = self.program.log
        return self.over and log.error is None and not log.refused

    def _why_over(self) -> str:
        log = self.program.log
        if log.refused:
            return f"your program cannot be watched: {log.refused}"
        return ENDED_BY_ITSELF if log.error is None else f"your program stopped: {error_in_words(log.error)}"

    # Going on

    def watch(self, watching: Watching | None) -> None:
        """Stop right after an event, within a moment if running."""
        self._watching = watching or Watching()
        if self._last_episode is None:
            self._arm()
        else:  # episodes are counted from a rest
            self._is_to_arm = True
            self.program.hold()

    def _arm(self, episodes: int | None = None) -> None:
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
            self.look()
            return
        before = self._last_episode
        self._last_episode = None if episodes == UNLIMITED else history.newest.episodes + episodes
        self._is_to_arm |= self._last_episode != before
        if self._is_to_arm or self._last_episode is not None:
            if program.is_settled:
                self._arm(None if self._last_episode is None else episodes)
            elif self._is_to_arm:
                program.hold()
        if not self._is_to_arm:
            program.let(min(history.newest.step + steps, NO_LIMIT))
        self.listen(CHUNK)

    def hold(self) -> None:
        """Take no further step, and wait for rest."""
        self.program.hold()
        if not self.program.is_settled:
            self.listen(_AT_A_STOP)

    def listen(self, seconds: float = 0.0) -> bool:
        """Return True for news within `seconds`."""
        program, until, has_news = self.program, time.monotonic() + seconds, False
        while True:
            left = max(0.0, until - time.monotonic())
            has_news |= program.listen(min(left, CHUNK))
            if program.is_settled or left <= 0.0:
                break
        return self._take_in() or has_news

    def _take_in(self) -> bool:
        program, newest, known = self.program, self.history.newest, self.program.known
        has_news = newest.step < known or (newest.table is None and program.log.table is not None)
        if has_news:
            self.history.go_on(known)
        is_seen = program.stopped_by or self._watching.states or self._watching.pairs
        has_events = is_seen and program.is_at_rest and newest.step
        self.events = self._events(program.stopped_by) if has_events else NOTHING_NOTICED
        self.look()
        return has_news

    def _events(self, met: str | None) -> WatchedEvents:
        newest, world = self.history.newest, self.history.newest.world
        events = WatchedEvents(met == "reward", met == "policy", met == "value")
        last = steps_between(newest.recording, newest.step - 1, newest.step)
        if not len(last.state):
            return events
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
        """Show a recorded step, or the beginning of an episode (from 1)."""
        self.begun_at = None
        if episode is not None:
            step = self.begun_at = self.history.begin_of_episode(episode)
        if step is not None:
            self.history.show(step)
        self.look()

    def continue_seek(self, steps: int) -> int:
        """Return 0: a seek is over at once."""
        return 0

    def stop_seek(self) -> None:
        """Do nothing: a seek is over at once."""

    def return_to_newest(self) -> None:
        """Show the newest step, where the program goes on."""
        self.history.shown = self.history.newest
        self.look()

    def recorded_step(self, until: Until) -> int | None:
        """Return the next recorded step at which `until` happened, if steps alone determine it."""
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
    """Translate `watching` to a request, as in messages.py."""
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
