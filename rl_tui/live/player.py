"""The thread that owns a run on screen."""

from __future__ import annotations

import asyncio
import threading
import time
from collections import deque
from collections.abc import AsyncIterator, Callable
from typing import Final, Protocol

from rl_tui.agents.compiling.background import BACKGROUND
from rl_tui.common.errors import UserError
from rl_tui.live.commands import Command, Restart
from rl_tui.live.pace.interpreter import as_usual, leave_out_of_collections, switch_often
from rl_tui.live.pace.pacing import START_SPEED
from rl_tui.live.playback import Playback
from rl_tui.live.record import Record, RecordSink
from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.live.state import State
from rl_tui.runs.recipe import Recipe
from rl_tui.worlds.gym.env_call import seconds_in_call

LONGEST_GOODBYE: Final = 0.2
OFFERED_EVERY: Final = 0.25


class PlayerClosedError(Exception):
    """The player was closed before a request was carried out."""


class MakePlayback(Protocol):
    """Makes what a player plays."""

    def __call__(self, on_exact: Callable[[], None], *, automatic: bool) -> Playback:
        """Return a playback. Any thread may call `on_exact`."""


class Player:
    """Plays a run in its own thread, the only one that touches it.

    `send` takes commands, and one reader gets the results from `snapshots`. The run never waits for it.

    Args:
        recipe: Start of the run.
        speed: Steps per second, or None for full speed.
        automatic: False if only commands take steps and no speed is measured. Snapshots then depend on the
            commands only.
        record: Position at which to begin.
        record_sink: Gets the record after every command, and several times a second during a run.
        make_playback: Makes something else to play than a built-in run.
    """

    def __init__(
        self,
        recipe: Recipe,
        *,
        speed: float | None = START_SPEED,
        automatic: bool = True,
        clock: Callable[[], float] = time.perf_counter,
        record: Record | None = None,
        record_sink: RecordSink | None = None,
        make_playback: MakePlayback | None = None,
    ) -> None:
        self._playback: Playback = (
            make_playback(self._on_exact, automatic=automatic)
            if make_playback is not None
            else Playback(
                recipe, speed=speed, automatic=automatic, clock=clock, on_exact=self._on_exact, record=record
            )
        )
        self._automatic = automatic
        self._clock = clock
        self._record_sink = record_sink
        self._offered, self._offered_at = (0, Phase.PREPARING), clock()
        self._changed = threading.Condition()  # guards everything below
        self._commands: deque[Command | _Question] = deque()
        self._reader: _Reader | None = None
        self._wanted = False
        self._outdated = True
        self._put_off = False
        self._latest: Snapshot | None = None  # not read yet
        self._newest: Snapshot | None = None
        self._failure: BaseException | None = None
        self._closing = False
        self._thread: threading.Thread | None = None

    def send(self, command: Command) -> None:
        """Queue `command` without waiting, in order and never lost."""
        self._post(command)

    async def snapshots(self) -> AsyncIterator[Snapshot]:
        """Yield the newest snapshot whenever it has changed, until the player is closed.

        The first, `Phase.PREPARING`, comes with the world. Raises UserError without a world, or any exception
        that ended the player.
        """
        reader = _Reader()
        with self._changed:
            self._reader, self._outdated = reader, True
        while True:
            with self._changed:
                snapshot, self._latest = self._latest, None
                if self._closing:
                    return
                if snapshot is None and self._failure is not None:
                    raise self._failure
                if snapshot is None:
                    self._wanted = True
                    self._start_or_wake()
            if snapshot is None:
                await reader.woken()
            else:
                yield snapshot

    async def carried_out(self) -> Snapshot:
        """Wait until all sent commands are done, with episodes and training, and return the snapshot.

        The reader gets the same, or a newer one. Raises PlayerClosedError, or any exception that ended the
        player.
        """
        question = _Question()
        self._post(question)
        return await question.answer

    @property
    def is_automatic(self) -> bool:
        """True if it advances without commands."""
        return self._automatic

    @property
    def unanswered(self) -> float:
        """Seconds for which the run is blocked."""
        thread = self._thread
        if thread is None or not self._automatic:
            return 0.0
        return max(seconds_in_call(thread.ident), self._playback.unanswered)

    def close(self) -> None:
        """End thread and snapshots without waiting, even while compiling."""
        with self._changed:
            self._closing = True
            self._changed.notify_all()
            self._wake_reader()
        if self._thread is not None:
            self._thread.join(LONGEST_GOODBYE)
            self._playback.close()
            is_last = as_usual(self)
            if is_last and self._automatic:
                BACKGROUND.want(())
        if self._record_sink is not None:
            self._record_sink.close()
        self._refuse_questions(PlayerClosedError())

    def _post(self, item: Command | _Question) -> None:
        with self._changed:
            self._commands.append(item)
            self._start_or_wake()
            gone = self._closing or self._failure is not None
        if gone:
            self._refuse_questions(self._failure or PlayerClosedError())

    def _start_or_wake(self) -> None:
        if self._thread is None and not self._closing:
            thread = threading.Thread(target=self._live, name="player", daemon=True)
            try:
                thread.start()
            except RuntimeError as error:  # the system limits the number of threads
                self._failure = UserError(f"the run cannot start its thread: {error}")
                self._wake_reader()
                return
            switch_often(self)
            self._thread = thread
        else:
            self._changed.notify_all()

    def _wake_reader(self) -> None:
        if self._reader is not None:
            self._reader.wake()

    def _on_exact(self) -> None:
        with self._changed:
            self._outdated = True
            self._changed.notify_all()

    # The rest runs in the player's thread.

    def _live(self) -> None:
        playback = self._playback
        try:
            while not self._closing:
                self._take_commands()
                loaded = playback.loaded
                wait = playback.work()
                if self._automatic and playback.loaded != loaded:
                    leave_out_of_collections()
                if self._record_sink is not None:
                    self._offer_record(self._record_sink)
                self._publish()
                if wait != 0.0:
                    with self._changed:
                        self._changed.wait_for(self._has_news, wait)
            if self._record_sink is not None:
                self._offer_record(self._record_sink)
        except BaseException as failure:  # raised again where the snapshots are read
            with self._changed:
                self._failure = failure
                self._wake_reader()
            self._refuse_questions(failure)

    def _offer_record(self, sink: RecordSink, *, ends: bool = False) -> None:
        playback, now = self._playback, self._clock()
        if not playback.touched:
            return
        last = (playback.handled, playback.phase)
        goes_on = playback.phase is Phase.RUNNING and now - self._offered_at >= OFFERED_EVERY
        if last != self._offered or goes_on or ends or self._closing:
            self._offered, self._offered_at = last, now
            sink.offer(playback.record, playback.table)

    def _take_commands(self) -> None:
        """Carry out the commands sent so far. Later ones must not delay the run."""
        for _ in range(len(self._commands)):
            with self._changed:
                if self._closing or not self._may_take():
                    return
                item = self._commands.popleft()
            if isinstance(item, _Question):
                snapshot = self._newest
                if snapshot is None or self._playback.changed or self._outdated:
                    snapshot = self._snapshot()
                    self._hand_over(snapshot)
                item.reply(snapshot)
            elif isinstance(item, Restart) and self._record_sink is not None:
                self._offer_record(self._record_sink, ends=True)
                self._playback.handle(item)
                self._record_sink.begin_anew(self._playback.record)
            else:
                self._playback.handle(item)

    def _may_take(self) -> bool:
        if not self._commands:
            return False
        first = self._commands[0]
        return not self._playback.on_the_way if isinstance(first, _Question) else self._playback.takes(first)

    def _publish(self) -> None:
        playback = self._playback
        with self._changed:
            self._put_off = not self._put_off and self._may_take()
        if self._put_off:
            return
        if self._owes_snapshot() or (playback.changed and playback.phase is Phase.PREPARING):
            self._hand_over(self._snapshot())

    def _snapshot(self) -> Snapshot:
        with self._changed:
            self._outdated = False
        return self._playback.snapshot()

    def _hand_over(self, snapshot: Snapshot) -> None:
        with self._changed:
            self._latest = self._newest = snapshot
            self._wanted = False
            if self._reader is not None:
                self._reader.wake()

    def _owes_snapshot(self) -> bool:
        """Return True if the reader waits for news. Training publishes nothing before its end."""
        playback = self._playback
        has_news = playback.changed or self._outdated
        comes_to_an_end = playback.state is State.TRAINING if self._automatic else playback.on_the_way
        return self._wanted and has_news and not comes_to_an_end

    def _has_news(self) -> bool:
        return self._closing or bool(self._commands) or self._owes_snapshot()

    def _refuse_questions(self, failure: BaseException) -> None:
        with self._changed:
            questions = [item for item in self._commands if isinstance(item, _Question)]
            self._commands.clear()
        for question in questions:
            question.refuse(failure)


class _Reader:
    def __init__(self) -> None:
        self._loop = asyncio.get_running_loop()
        self._event = asyncio.Event()

    def wake(self) -> None:
        if not self._loop.is_closed():
            self._loop.call_soon_threadsafe(self._event.set)

    async def woken(self) -> None:
        await self._event.wait()
        self._event.clear()


class _Question:
    """A request for a snapshot in the order of the commands, answered from any thread."""

    def __init__(self) -> None:
        self._loop = asyncio.get_running_loop()
        self.answer: asyncio.Future[Snapshot] = self._loop.create_future()

    def reply(self, snapshot: Snapshot) -> None:
        self._settle(lambda: self.answer.set_result(snapshot))

    def refuse(self, failure: BaseException) -> None:
        self._settle(lambda: self.answer.set_exception(failure))

    def _settle(self, settle: Callable[[], None]) -> None:
        if not self._loop.is_closed():
            self._loop.call_soon_threadsafe(lambda: None if self.answer.done() else settle())
