"""The playback of a watched program."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, Final

from rl_tui.agents.catalogue import OWN_PROGRAM
from rl_tui.common.errors import UserError
from rl_tui.live import commands
from rl_tui.live.handlers import HANDLERS
from rl_tui.live.pace.pacing import CHUNK, START_SPEED
from rl_tui.live.pace.until import Breakpoints, Event, Until
from rl_tui.live.playback import Playback
from rl_tui.live.program_run import ProgramRun, usual_recipe
from rl_tui.live.program_view import ProgramView
from rl_tui.live.questions import Questions
from rl_tui.live.record import LearnedTable, Record
from rl_tui.live.restarts import Restarts
from rl_tui.live.snapshot import Snapshot
from rl_tui.live.state import ENDED, State
from rl_tui.programs.watched.notebook import place_in_words
from rl_tui.programs.watched.program_process import ProgramRequest
from rl_tui.programs.watched.watched_program import LOOKS, ProgramFile, WatchedProgram
from rl_tui.runs.recipe import SetParameter, SwitchAlgorithm
from rl_tui.runs.timeline.branches import RunRecord
from rl_tui.runs.timeline.run_group import RunGroup
from rl_tui.worlds.world import World

_WHILE_RUNNING: Final = 0.01
_UNANSWERED: Final = 1.0
SHOWN_OUTPUT: Final = 200
"""Lines of output in a snapshot."""
_LOOKED_FOR: Final = (
    "an array of states × actions",
    "lists with one row per state",
    "a dictionary of rows, by state",
    "a dictionary of numbers, by (state, action)",
    "in the functions that call step, their globals, and attributes of objects there",
)

# What a program cannot do


_NOT_AVAILABLE: Final = "this is not available for a watched program"
_NO_BRANCHES: Final = "a program has no branches"
_NAMES: Final = {"alpha": "α", "gamma": "γ", "epsilon": "ε"}
REFUSED: Final[Mapping[type[commands.Command], str]] = {
    commands.Apply: "your program sets {setting}: change {change} in {file}, and save it",
    commands.Take: "your program takes its own steps: s takes one",
    commands.WatchLearning: "a program has no automatic speed: use + and −",
    commands.ChooseBranch: _NO_BRANCHES,
    commands.AddBranch: _NO_BRANCHES,
    commands.ChooseLane: "your program is the run in view; c o compares it with the other run",
    commands.StudySeeds: "rl-tui grade runs your program with many seeds",
    **dict.fromkeys((commands.RunSweep, commands.OpenEditor, commands.DrawWorld), _NOT_AVAILABLE),
    **dict.fromkeys((commands.UndoStroke, commands.RedoStroke, commands.AskCheck), _NOT_AVAILABLE),
    **dict.fromkeys((commands.KeepLesson, commands.WatchProgram), _NOT_AVAILABLE),
}


def _refuse(playback: ProgramPlayback, command: commands.Command) -> None:
    setting, change = "how it learns", "it"
    if isinstance(command, commands.Apply) and isinstance(command.change, SetParameter):
        setting, change = "this", _NAMES.get(command.change.name, command.change.name)
    file = playback.lead.program.request.path.name
    raise UserError(REFUSED[type(command)].format(setting=setting, change=change, file=file))


def _set_speed(playback: ProgramPlayback, command: commands.SetSpeed) -> None:
    playback.lead.program.hold()  # it may have permission for more steps than are due
    HANDLERS[commands.SetSpeed](playback, command)


def _choose_table(playback: ProgramPlayback, command: commands.ChooseTable) -> None:
    playback.restart(replace(playback.lead.program.request, table=command.name))


def _add_lane(playback: ProgramPlayback, command: commands.AddLane) -> None:
    changes = command.changes
    if playback.lead.found.algorithm == OWN_PROGRAM.id:
        changes = (SwitchAlgorithm(playback.lead.usual.algorithm), *changes)
    HANDLERS[commands.AddLane](playback, replace(command, changes=changes))


def _drop_lane(playback: ProgramPlayback, command: commands.DropLane) -> None:
    if command.lane == 0:
        raise UserError("your program cannot be ended here: end another run")
    HANDLERS[commands.DropLane](playback, command)


# The playback


class ProgramPlayback(Playback):
    """Plays `program`, ready for its first step, and built-in runs for comparison.

    The program needs permission for each step, and the steps arrive some time later. Without `automatic` it
    takes steps only on command, and its file is not checked.
    """

    handlers: Mapping[type, Callable[[Any, Any], None]] = {
        **HANDLERS,
        **dict.fromkeys(REFUSED, _refuse),
        commands.SetSpeed: _set_speed,
        commands.Restart: lambda playback, _: playback.restart(),
        commands.ChooseTable: _choose_table,
        commands.AddLane: _add_lane,
        commands.DropLane: _drop_lane,
        commands.AskWhy: lambda playback, _: None,  # how it explores is unknown
    }

    def __init__(
        self,
        program: WatchedProgram,
        on_exact: Callable[[], None],
        *,
        automatic: bool = True,
        speed: float | None = START_SPEED,
        clock: Callable[[], float] = time.perf_counter,
    ) -> None:
        self.lead = ProgramRun(program, on_exact, automatic=automatic)
        super().__init__(self.lead.usual, speed=speed, automatic=automatic, clock=clock, on_exact=on_exact)
        self.restarts = Restarts(ProgramFile(program.request.path, clock), self._go_over_to)
        self._on_news = on_exact
        self._owed = 0  # steps requested that have not arrived
        self._is_closed = False
        self.start(self._record, self.lead.world)
        self.changed = True

    @property
    def on_the_way(self) -> bool:
        """True while a requested operation is unfinished."""
        is_starting = self.restarts.newest is not None and self.restarts.is_awaited
        if is_starting or self._owed > 0 or super().on_the_way:
            return True
        return not self.automatic and self.group.seeking

    @property
    def unanswered(self) -> float:
        """Seconds without an expected message."""
        if self.lead.program.is_settled or (self.state is State.PAUSED and not self._owed):
            return 0.0
        silent = time.monotonic() - self.lead.program.heard_at
        return silent if silent > _UNANSWERED else 0.0

    @property
    def record(self) -> Record:
        """A fixed record: programs are not saved."""
        return self._record

    @property
    def table(self) -> LearnedTable | None:
        """None: programs are not saved."""
        return None

    def group_of(self, record: Record, world: World) -> RunGroup:
        """Return the program as the only run."""
        return RunGroup((), world, clock=self.clock, program=self.lead)

    def work(self) -> float | None:
        """Work for some milliseconds, and return the seconds to wait."""
        if self._is_closed:
            return None
        if self.automatic:
            self._look_at_file()
        wait = super().work()
        if self.state in (State.PAUSED, *ENDED):
            self._stand_still()
        is_behind = self.group.seeking
        if is_behind and self.state is not State.SEEKING:
            self.transport.continue_seek(CHUNK)
            self.changed = True
        is_still = self.state in (State.PAUSED, *ENDED)
        if self.lead.examine(is_still=is_still and self.lead.program.is_settled):
            self.changed = True
        if wait is None and is_behind:
            return 0.0
        if wait is None and not self.lead.program.is_settled:
            return _WHILE_RUNNING
        return LOOKS if wait is None and self.automatic else wait

    def _stand_still(self) -> None:
        if self._owed:
            self._take_owed()
        elif self.lead.listen():
            self.changed = True
        if self.state is State.PAUSED and self.end_if_over():
            self.changed = True

    def snapshot(self) -> Snapshot:
        """Return the newest snapshot."""
        if not self.automatic:
            self.lead.examine(is_still=self.lead.program.is_settled)
        return replace(super().snapshot(), program=self._program_view())

    def close(self) -> None:
        """End the program and its background work."""
        self._is_closed = True
        self.lead.program.end()
        self.restarts.close()
        super().close()

    # From one state to another

    def rest(self) -> None:
        """Pause."""
        self._owed = 0
        self.lead.hold()
        super().rest()

    def take_step(self) -> None:
        """Pause, and take or show one step."""
        if self.state is not State.PAUSED:
            self.rest()
        self.paused_by = ""
        self._owed += 1
        self._take_owed()

    def _take_owed(self) -> None:
        before = self.lead.step
        self.group.advance(self._owed)
        taken = self.lead.step - before
        self._owed = 0 if self.lead.over else max(0, self._owed - taken)
        if taken or self.lead.over:
            self.changed = True
            self.stop_if_due()

    def run(self) -> None:
        """Run at the chosen speed from the newest step."""
        self.lead.return_to_newest()
        if not self.end_if_over():
            super().run()

    def run_until(self, until: Until) -> None:
        """Run until an event, or show a recorded one. Raises UserError if impossible."""
        self.rest()
        recorded = self.lead.recorded_step(until) if self.lead.history.in_past else None
        if recorded is not None:
            self.group.seek_to(step=recorded)
            if until.event is Event.EPISODE:
                self.lead.begun_at = recorded
            self.seek()
            return
        self.lead.return_to_newest()
        if not self.end_if_over():
            super().run_until(until)

    def train(self, steps: int) -> None:
        """Take exactly `steps` steps (fewer if it ends) first."""
        self.rest()
        self.lead.return_to_newest()
        if not self.end_if_over():
            super().train(steps)

    # Restarts

    def restart(self, request: ProgramRequest | None = None) -> None:
        """Restart from the seed, with the current program shown meanwhile."""
        self.rest()
        self.restarts.begin(request or self.lead.program.request, self.lead.history)
        if not self.automatic:
            self.restarts.wait()

    def _look_at_file(self) -> None:
        restarts = self.restarts
        has_news = restarts.look_at_file(self.lead.program.request, self.lead.history)
        if restarts.newest is not None:
            has_news |= restarts.look()
            has_news |= restarts.compare(self.lead.history, is_over=self.lead.program.is_over)
        self.changed = self.changed or has_news

    def _go_over_to(self, program: WatchedProgram) -> None:
        """Replace the current program; questions remain if the world is the same."""
        was_running, old = self.state is State.RUNNING, self.lead
        is_same = old.program.world.is_same(program.world)
        if is_same:
            program.world = old.program.world
        old.program.end()
        edited = old.edited if is_same else None
        self.lead = ProgramRun(program, self._on_news, automatic=self.automatic, edited=edited)
        self.changed = True
        if is_same:
            self.group.replace_program(self.lead)
            self.rest()
            self.watch()
            self.seek()
        else:
            recipe = usual_recipe(program.world, program.request.seed)
            self._record = Record((RunRecord(recipe),), speed=self.transport.speed)
            self.questions.close()
            self.questions = Questions(self._record, self._on_news, automatic=self.automatic)
            self.breakpoints = Breakpoints()
            self.start(self._record, program.world.world)
        if was_running:
            self.run()

    def _program_view(self) -> ProgramView:
        program, log, found = self.lead.program, self.lead.program.log, self.lead.found
        request, found_at = program.request, log.recording.found_at
        has_exact = program.world is not None and program.world.world.mdp is not None
        return ProgramView(
            title=f"{request.path.name}:{request.agent}" if request.agent else request.path.name,
            environment=log.environments[0].id,
            table=log.table,
            table_from=found_at if self.lead.history.shown.step <= found_at else 0,
            wanted=request.table or "",
            looked_for=_LOOKED_FOR if log.table is None else (),
            verdict=self.lead.verdict,
            output=tuple(log.output)[-SHOWN_OUTPUT:],
            notes=tuple(log.notes),
            error=log.error,
            ended=program.is_over,
            stands_at=None if log.stands_at is None else place_in_words(*log.stands_at),
            refused=log.refused,
            reloaded=self.restarts.words,
            source=self.restarts.file.source,
            notebook=self.restarts.file.notebook,
            path=str(request.path),
            gamma=found.hyperparameters.gamma if has_exact else None,
            gamma_source=found.gamma_source,
        )
