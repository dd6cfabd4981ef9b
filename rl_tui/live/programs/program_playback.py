"""The playback of a watched program, the counterpart of `Playback` for built-in agents."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Final

from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.common.errors import UserError
from rl_tui.common.findings import one_line
from rl_tui.common.words import counted
from rl_tui.live.commands import LOOKING, MOVES, Command
from rl_tui.live.pace.pacing import CHUNK, START_SPEED
from rl_tui.live.pace.until import Breakpoints
from rl_tui.live.programs.beside import RunsBeside
from rl_tui.live.programs.program_handlers import HANDLERS, refusal_of
from rl_tui.live.programs.program_questions import ProgramQuestions
from rl_tui.live.programs.program_snapshot import Found, ProgramSnapshots, found_of, usual_recipe
from rl_tui.live.programs.program_transport import ProgramTransport
from rl_tui.live.programs.progress import ProgramHistory
from rl_tui.live.programs.watched_program import LOOKS, ProgramFile, WatchedProgram
from rl_tui.live.record import LearnedTable, Record
from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.live.state import BUSY, ENDED, State, shows_trail
from rl_tui.programs.diagnosis.diagnosis import verdict_of
from rl_tui.programs.evidence.verdict import CodeFault, ProgramVerdict
from rl_tui.programs.watched.program_log import ProgramLog
from rl_tui.programs.watched.program_process import ProgramRequest
from rl_tui.runs.exact_answers import Answer
from rl_tui.runs.timeline.branches import RunRecord

# Starting the program again


class Reload:
    """A restart of the program of `request`. `before` is the history of the previous run. `is_saved` is
    True if the file was saved, so that the results are to be compared.

    Raises:
        UserError: No process can be started.
    """

    def __init__(self, request: ProgramRequest, before: ProgramHistory, *, is_saved: bool) -> None:
        self.is_saved = is_saved
        self.is_watched = False
        """True once it has replaced the previous run."""
        self._program = WatchedProgram(request)
        results = before.newest.results
        self._step, self._episodes = before.newest.step, before.newest.episodes
        self._return = results.greedy_return
        self._mean = results.return_last_100

    def is_ready(self) -> bool:
        """Return True if it is ready for its first step. Raises UserError if it failed."""
        self._program.listen()
        self._program.check()
        is_there = bool(self._program.log.environments) and self._program.is_settled
        return is_there and self._program.world is not None  # a world that is too large is refused here

    def wait(self) -> None:
        """Wait until it is ready. Raises UserError if it failed."""
        self._program.wait_for_environment()

    def taken(self) -> WatchedProgram:
        """Return the program, which the caller owns from now on."""
        self.is_watched = True
        return self._program

    def compared(self, now: ProgramHistory, *, is_over: bool) -> str:
        """Compare the results with the previous run; "" until it is as long. The comparison is after
        equally many episodes, because a better agent takes fewer steps; or after equally many steps if no
        episode had ended.
        """
        newest, episodes = now.newest, self._episodes
        has_come_as_far = newest.episodes >= episodes if episodes else newest.step >= self._step
        if not self._step or not (has_come_as_far or is_over):
            return ""
        results, mine, before = newest.results, "", ""
        if has_come_as_far:
            kept = now.shown
            now.show(now.begin_of_episode(episodes + 1) if episodes else self._step)
            results, now.shown = now.shown.results, kept
            where = f"after {counted(episodes, 'episode')}" if episodes else f"at step {self._step:,}"
        else:
            where, mine = "at its end", f" after {counted(newest.episodes, 'episode')}"
            before = f" after {counted(episodes, 'episode')}" if episodes else f" at step {self._step:,}"
        which, then, after = "the greedy policy's exact return", self._return, results.greedy_return
        if then is None or after is None:
            which, then, after = "the mean of the last 100 returns", self._mean, results.return_last_100
        if then is None or after is None:
            return f"restarted from its seed: {where}{mine} there is nothing to compare"
        word = "better than" if after > then else "worse than" if after < then else "the same as"
        return f"{word} before {where}: {which} is {after:.4g}{mine}, it was {then:.4g}{before}"

    def close(self) -> None:
        """End the program, unless the caller owns it."""
        if not self.is_watched:
            self._program.end()


class Restarts:
    """Restarts the program in `file`. `go_over_to` is called when the new one is ready."""

    def __init__(self, file: ProgramFile, go_over_to: Callable[[WatchedProgram], None]) -> None:
        self.file = file
        """File of the program."""
        self.words = ""
        """Result of the last save, usually empty."""
        self._go_over_to = go_over_to
        self._newest: Reload | None = None

    @property
    def is_awaited(self) -> bool:
        """True while a requested restart is not ready."""
        newest = self._newest
        return newest is not None and not (newest.is_watched or newest.is_saved)

    def begin(self, request: ProgramRequest, before: ProgramHistory, *, is_saved: bool = False) -> None:
        """Restart with `request`. `before` is the current run. Raises UserError if no process can be
        started.
        """
        self.close()
        self._newest = Reload(request, before, is_saved=is_saved)

    def wait(self) -> None:
        """Wait until the restart has replaced the current run."""
        try:
            if self._newest is not None:
                self._newest.wait()
        except UserError as fault:
            self._give_up(fault)
        self.look()

    def look_at_file(self, request: ProgramRequest, before: ProgramHistory) -> bool:
        """Restart if the file was saved and return True if there is news."""
        if not self.file.was_saved():
            return False
        fault = self.file.fault()
        try:
            if not fault:
                self.begin(request, before, is_saved=True)
                self.words = "saved: it restarts, and appears when it has created its environment"
        except UserError as error:
            fault = str(error)
        if fault:
            self.words = f"not restarted: {fault}"
        return True

    def look(self) -> bool:
        """Switch to the restarted program once it is ready and return True if there is news."""
        newest = self._newest
        if newest is None or newest.is_watched:
            return False
        try:
            if not newest.is_ready():
                return False
        except UserError as fault:
            self._give_up(fault)
            return True
        self.file.read_again()
        self.words = "restarted from its seed" if newest.is_saved else ""
        self._newest = newest if newest.is_saved else None
        self._go_over_to(newest.taken())
        return True

    def compare(self, now: ProgramHistory, *, is_over: bool) -> bool:
        """Compare once the new run is as long as the old one and return True when it happens."""
        newest = self._newest
        words = newest.compared(now, is_over=is_over) if newest is not None and newest.is_watched else ""
        if words:
            self.words, self._newest = words, None
        return bool(words)

    def close(self) -> None:
        """End a program that has not replaced the current one."""
        if self._newest is not None:
            self._newest.close()
            self._newest = None

    def _give_up(self, fault: UserError) -> None:
        self.close()
        self.words = str(fault)


# Verdicts while it runs


EVERY: Final = 1.0
"""Seconds between two verdicts on a running program."""
NOT_EXAMINED: Final = "your program could not be examined, because of a bug in rl-tui"
_LONGEST: Final = 300
_REST: Final = 4.0
"""The pause after a verdict is at least this many times its duration."""


class Verdicts:
    """The newest verdict on a program. `on_news` is called from another thread when there is one. With
    `automatic` off, verdicts are computed on request and do not depend on timing.
    """

    def __init__(self, on_news: Callable[[], None], *, automatic: bool) -> None:
        self.newest = ProgramVerdict()
        """The newest verdict."""
        self._on_news = on_news
        self._automatic = automatic
        self._judged: tuple[int, ...] = ()  # amount of evidence at the last verdict
        self._next = 0.0  # earliest time of the next verdict
        self._thread: threading.Thread | None = None
        self._generation = 0

    def forget(self) -> None:
        """Forget everything, because the program has restarted."""
        self.newest, self._judged, self._next = ProgramVerdict(), (), 0.0
        self._generation += 1

    def look(self, log: ProgramLog, *, is_still: bool) -> None:
        """Start a verdict on `log` when one is due, or at once if it `is_still`."""
        known = (
            log.recording.count,
            len(log.recording.changes.step),
            len(log.numbers),
            sum(log.lines.values()),
        )
        if known == self._judged or (self._thread is not None and self._thread.is_alive()):
            return
        if not self._automatic:
            if is_still:
                self.newest, self._judged = _judged(log), known
        elif is_still or time.monotonic() >= self._next:
            self._judged = known
            arguments = (log.frozen(), self._generation)
            self._thread = threading.Thread(target=self._work, args=arguments, name="diagnosis", daemon=True)
            try:
                self._thread.start()
            except RuntimeError:  # the program may have used up all threads
                self._thread, self._judged, self._next = None, (), time.monotonic() + EVERY

    def _work(self, log: ProgramLog, generation: int) -> None:
        begun = time.monotonic()
        verdict = _judged(log)
        taken = time.monotonic() - begun
        if generation == self._generation:
            self.newest = verdict
            self._next = begun + taken + max(EVERY, _REST * taken)
            self._on_news()


def _judged(log: ProgramLog) -> ProgramVerdict:
    """Return the verdict on `log`. An error in the diagnosis must not end the program on screen."""
    try:
        return verdict_of(log)
    except Exception as error:
        return ProgramVerdict(notes=(one_line(f"{NOT_EXAMINED}: {type(error).__name__}: {error}", _LONGEST),))


# The playback


class ProgramPlayback:
    """Handles commands in short pieces, as `Playback` does for built-in runs. `program` is ready for its
    first step. A program cannot go back: its past is shown from the recording, and it continues where it
    is. With `automatic` off it takes steps only on command, and its file is not checked.
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
        """Controls the program."""
        self.automatic = automatic
        self._on_exact = on_exact
        self._snapshots = ProgramSnapshots()
        self.restarts = Restarts(ProgramFile(program.request.path, clock), self._go_over_to)
        """Restarts the program."""
        self.verdicts = Verdicts(on_exact, automatic=automatic)
        """Results of the diagnosis."""
        self._traced: set[CodeFault] = set()  # findings for which lines were already requested
        self._is_closed = False
        self._set_up()

    def _set_up(self) -> None:
        """Create everything that depends on the world of the program."""
        program, transport = self.program, self.transport
        recipe = usual_recipe(program.world, program.request.seed)
        self.usual: Hyperparameters = recipe.hyperparameters
        """Default hyper-parameters of the scenario."""
        self._record = Record((RunRecord(recipe),), speed=transport.speed)
        self.questions: ProgramQuestions = ProgramQuestions(
            self._record, self._on_exact, automatic=self.automatic
        )
        """Background questions about the program."""
        self.beside = RunsBeside(program.world.world, automatic=self.automatic)
        """Built-in runs for comparison."""

    @property
    def program(self) -> WatchedProgram:
        """The watched program."""
        return self.transport.program

    @property
    def history(self) -> ProgramHistory:
        """Its recorded history."""
        return self.transport.history

    @property
    def state(self) -> State:
        """Current state."""
        return self.transport.state

    @property
    def phase(self) -> Phase:
        """State as snapshots report it."""
        return self.transport.phase

    @property
    def changed(self) -> bool:
        """True if the next snapshot differs from the last."""
        return self.transport.changed

    @property
    def loaded(self) -> tuple[bool, bool]:
        """True once the world is built."""
        return self.state is not State.BUILDING, False

    @property
    def on_the_way(self) -> bool:
        """True while a requested operation with an end is unfinished."""
        is_behind = not self.automatic and self.beside.is_behind(self.history.shown.step)
        return self.transport.on_the_way or is_behind or self.restarts.is_awaited

    @property
    def shows_trail(self) -> bool:
        """True if the trail of the agent is shown."""
        return shows_trail(self.state, self.transport.speed)

    @property
    def found(self) -> Found:
        """What is known about its learning."""
        return found_of(self.verdicts.newest.update, self.program.log.numbers, self.usual)

    @property
    def record(self) -> Record:
        """A fixed record; programs are not saved in sessions."""
        return self._record

    @property
    def table(self) -> LearnedTable | None:
        """None, since programs are not saved in sessions."""
        return None

    @property
    def unanswered(self) -> float:
        """Seconds without a message although the program may continue."""
        return self.transport.unanswered

    def takes(self, command: Command) -> bool:
        """Return True if `command` need not wait."""
        if self.state in BUSY:
            return False
        return self.automatic or not self.on_the_way

    def handle(self, command: Command) -> None:
        """Carry out or start `command`. The next snapshot reports a refusal."""
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
        """Work for some milliseconds and return the seconds until the next call, None for never."""
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
        """Request lines of code again after a new finding, because earlier ones may be from another part."""
        found = {each.fault for each in self.verdicts.newest.findings}
        if not found <= self._traced:
            self._traced |= found
            self.program.trace()

    def snapshot(self) -> Snapshot:
        """Return the newest snapshot."""
        self.transport.changed = False
        if not self.automatic:
            self.verdicts.look(self.program.log, is_still=self.program.is_settled)
        return self._snapshots.build(self)

    def close(self) -> None:
        """End the program and its background work."""
        self._is_closed = True
        self.program.end()
        self.restarts.close()
        self.questions.beside.close()

    def restart(self, request: ProgramRequest | None = None) -> None:
        """Restart the program from its seed. The current one is shown until the new one is ready."""
        self.transport.rest()
        self.restarts.begin(request or self.program.request, self.history)
        if not self.automatic:
            self.restarts.wait()

    def _exact_answer(self) -> Answer:
        return self.questions.exact(self.history.newest, self.found.hyperparameters.gamma)

    def _look_at_file(self) -> None:
        """Restart after the file was saved, and compare the results."""
        restarts = self.restarts
        has_news = restarts.look_at_file(self.program.request, self.history)
        has_news |= restarts.look()
        if restarts.compare(self.history, is_over=self.program.is_over) or has_news:
            self.transport.changed = True

    def _go_over_to(self, program: WatchedProgram) -> None:
        """Replace the current program by `program`; questions remain if the world is the same."""
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
