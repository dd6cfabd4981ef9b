"""A watched program with a play button: what a player plays in place of runs of ours."""

from __future__ import annotations

import time
from collections.abc import Callable

from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.common.errors import UserError
from rl_tui.lab.detective.verdict import CodeFault
from rl_tui.lab.live.commands import LOOKING, MOVES, Command
from rl_tui.lab.live.record import LearnedTable, Record
from rl_tui.lab.live.snapshot import Phase, Snapshot
from rl_tui.lab.live.speed.pacing import CHUNK, START_SPEED
from rl_tui.lab.live.state import BUSY, ENDED, State, shows_trail
from rl_tui.lab.live.until import Breakpoints
from rl_tui.lab.live_programs.beside import RunsBeside
from rl_tui.lab.live_programs.history_of_program import ProgramHistory
from rl_tui.lab.live_programs.program_file import LOOKS, ProgramFile
from rl_tui.lab.live_programs.program_handlers import HANDLERS, refusal_of
from rl_tui.lab.live_programs.program_questions import ProgramQuestions
from rl_tui.lab.live_programs.program_snapshot import Found, ProgramSnapshots, found_of, usual_recipe
from rl_tui.lab.live_programs.program_transport import ProgramTransport
from rl_tui.lab.live_programs.restarts import Restarts
from rl_tui.lab.live_programs.verdicts import Verdicts
from rl_tui.lab.live_programs.watched_program import WatchedProgram
from rl_tui.lab.programs.program_process import ProgramRequest
from rl_tui.lab.run.exact_answers import Answer
from rl_tui.lab.timeline.branches import RunRecord


class ProgramPlayback:
    """Takes commands and works them off in short pieces, as :class:`Playback` does for runs of ours.

    ``program`` was started and stands before its first step. A program cannot be taken back: what is shown of
    its past was recorded, and it goes on where it is. With ``automatic`` off it takes no step but those that
    commands ask for, and its file is not looked at.
    """

    def __init__(
        self,
        program: WatchedProgram,
        on_exact: Callable[[], None],
        *,
        automatic: bool = True,
        speed: float | None = START_SPEED,
        clock: Callable[[], float] = time.perf_counter,
    ) -> None:
        self.handled = 0
        self.touched = False
        self.transport: ProgramTransport = ProgramTransport(
            program, self._exact_answer, clock, automatic=automatic, speed=speed
        )
        """What lets the program go, and holds it."""
        self.automatic = automatic
        self._on_exact = on_exact
        self._snapshots = ProgramSnapshots()
        self.restarts = Restarts(ProgramFile(program.request.path, clock), self._go_over_to)
        """Starts it again."""
        self.verdicts = Verdicts(on_exact, automatic=automatic)
        self._traced: set[CodeFault] = set()  # for which the lines were asked for again
        """What the detective says of it."""
        self._is_closed = False
        self._set_up()

    def _set_up(self) -> None:
        """Begin anew all that depends on the world of the program."""
        program, transport = self.program, self.transport
        recipe = usual_recipe(program.world, program.request.seed)
        self.usual: Hyperparameters = recipe.hyperparameters
        """The hyper-parameters that the scenario suggests."""
        self._record = Record((RunRecord(recipe),), speed=transport.speed)
        self.questions: ProgramQuestions = ProgramQuestions(
            self._record, self._on_exact, automatic=self.automatic
        )
        """What a person asks beside it."""
        self.beside = RunsBeside(program.world.world, automatic=self.automatic)
        """Runs of ours beside it."""

    @property
    def program(self) -> WatchedProgram:
        """What is watched."""
        return self.transport.program

    @property
    def history(self) -> ProgramHistory:
        """What it has done so far."""
        return self.transport.history

    @property
    def state(self) -> State:
        """What it is doing."""
        return self.transport.state

    @property
    def phase(self) -> Phase:
        """What a snapshot says that it is doing."""
        return self.transport.phase

    @property
    def changed(self) -> bool:
        """Whether there is something new to show."""
        return self.transport.changed

    @property
    def loaded(self) -> tuple[bool, bool]:
        """Whether the world is there."""
        return self.state is not State.BUILDING, False

    @property
    def on_the_way(self) -> bool:
        """Whether something that was asked for and has an end is not done yet."""
        is_behind = not self.automatic and self.beside.is_behind(self.history.shown.step)
        return self.transport.on_the_way or is_behind or self.restarts.is_awaited

    @property
    def shows_trail(self) -> bool:
        """Whether the way that the agent went is shown."""
        return shows_trail(self.state, self.transport.speed)

    @property
    def found(self) -> Found:
        """What is known of how it learns."""
        return found_of(self.verdicts.newest.update, self.program.log.numbers, self.usual)

    @property
    def record(self) -> Record:
        """What would be needed to come back; a program is kept in no session."""
        return self._record

    @property
    def table(self) -> LearnedTable | None:
        """Nothing: a program is kept in no session."""
        return None

    @property
    def unanswered(self) -> float:
        """For how many seconds it has told nothing although it may go on."""
        return self.transport.unanswered

    def takes(self, command: Command) -> bool:
        """Return True if ``command`` need not wait."""
        if self.state in BUSY:
            return False
        return self.automatic or not self.on_the_way

    def handle(self, command: Command) -> None:
        """Carry out ``command``, or begin to; what cannot be done is told by the next snapshot."""
        kind = type(command)
        self.transport.changed = True
        self.handled += 1
        self.touched = self.touched or kind not in LOOKING
        if self.state in ENDED and kind in MOVES and not self.history.in_past:
            return
        handler = HANDLERS.get(kind)
        try:
            if handler is None:
                raise UserError(refusal_of(command, self.program.request.path.name))
            handler(self, command)
        except UserError as fault:
            if self.state in (State.RUNNING, State.UNTIL):
                self.transport.rest()
            self.transport.paused_by = str(fault)

    def work(self) -> float | None:
        """Do what is due, for some milliseconds; return in how many seconds to call again, None for never."""
        if self._is_closed:
            return None
        if self.automatic:
            self._look_at_file()
        transport = self.transport
        wait = transport.work()
        self.verdicts.look(self.program.log, is_still=transport.is_still and self.program.is_settled)
        self._trace_findings()
        step, beside = self.history.shown.step, self.beside
        if beside.runs and beside.follow(step, CHUNK):
            transport.changed = True
        if wait is None and beside.is_behind(step):
            return 0.0
        return LOOKS if wait is None and self.automatic else wait

    def _trace_findings(self) -> None:
        """Have lines told again once something new was found: the first changes may be of another part."""
        found = {each.fault for each in self.verdicts.newest.findings}
        if not found <= self._traced:
            self._traced |= found
            self.program.trace()

    def snapshot(self) -> Snapshot:
        """Return the newest picture."""
        self.transport.changed = False
        if not self.automatic:
            self.verdicts.look(self.program.log, is_still=self.program.is_settled)
        return self._snapshots.build(self)

    def close(self) -> None:
        """End the program, and what is worked out beside it."""
        self._is_closed = True
        self.program.end()
        self.restarts.close()
        self.questions.beside.close()

    def restart(self, request: ProgramRequest | None = None) -> None:
        """Start the program again from its seed; the one until now is shown until that has begun."""
        self.transport.rest()
        self.restarts.begin(request or self.program.request, self.history)
        if not self.automatic:
            self.restarts.wait()

    def _exact_answer(self) -> Answer:
        return self.questions.exact(self.history.newest, self.found.hyperparameters.gamma)

    def _look_at_file(self) -> None:
        """Start again where the file was saved; say then what became better."""
        restarts = self.restarts
        has_news = restarts.look_at_file(self.program.request, self.history)
        has_news |= restarts.look()
        if restarts.compare(self.history, is_over=self.program.is_over) or has_news:
            self.transport.changed = True

    def _go_over_to(self, program: WatchedProgram) -> None:
        """Watch ``program`` in place of the one until now; what was asked beside it may stay."""
        before = self.program.world
        is_same = before.is_same(program.world)
        if is_same:
            program.world = before
        else:
            self.transport.breakpoints = Breakpoints()
        self._traced.clear()
        self.verdicts.forget()
        self.transport.go_over_to(program)
        if not is_same:
            self._set_up()
