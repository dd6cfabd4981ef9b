"""Run the real program at full speed for a long time: ``python tests/soak.py [MINUTES] [--untouched]``.

It prints one row a minute, sixty by default, then a comparison of the last minute with the first. With
``--untouched`` no key is pressed, and only memory counts, constant within 2 % after ten minutes.
"""

from __future__ import annotations

import fcntl
import os
import pty
import re
import select
import struct
import subprocess
import sys
import tempfile
import termios
import threading
import time
from collections import deque
from datetime import UTC, datetime
from itertools import pairwise
from pathlib import Path
from statistics import median
from types import TracebackType
from typing import Final, NamedTuple

import pyte

from rl_tui.live.sessions.session import sessions_in

SCENARIO: Final = "frozenlake-slippery"
UNTOUCHED: Final = "frozenlake"
SETTLED: Final = 10  # minutes after which memory must be constant,
MOST_DRIFT: Final = 0.02  # within this share
SIZE: Final = (120, 40)
FULL_SPEED: Final = "+" * 9
FULL: Final = "▶ max"  # in the format of the status line
PAUSED: Final = "paused"
MINUTE: Final = 60.0
MOST_GROWTH: Final = 1.25  # of memory and of frame time, from the first minute to the last
START: Final = 120.0  # seconds until the first frame at most: kernels may need compiling
PATIENCE: Final = 10.0  # seconds until the effect of a key is visible
QUIET: Final = 0.4  # seconds without a byte: the screen stands still
_FRAME_END: Final = b"\x1b[?2026l"
_MEGABYTE: Final = 2**20
_END_KEPT: Final = 1_000_000  # bytes kept to explain an early end
_TICKS: Final = os.sysconf("SC_CLK_TCK")
# Queries of the program to its terminal: support for synchronised output, and the cursor after a move
_KNOWS_SYNCHRONISED: Final = re.compile(rb"\x1b\[\?2026\$p")
_WHERE: Final = re.compile(rb"\x1b\[(\d+)(?:;(\d+))?H\x1b\[6n")
_TOLD: Final = re.compile(b"|".join((re.escape(_FRAME_END), _KNOWS_SYNCHRONISED.pattern, _WHERE.pattern)))
_LONGEST: Final = 16  # the length of such a sequence in bytes

# The keys of a minute, and the time for each. Space pauses and continues.
KEYS: Final = (
    *((" ", 0.5), ("v", 0.3), ("b", 0.5), ("bbb", 0.5), (" ", 0.5)),
    *(("1", 0.3), ("\x1b[C", 0.3), ("\x1b[D", 0.3), ("vvv", 0.5), ("?", 0.7), ("\x1b", 0.7), ("wm", 0.7)),
    *(("\x1b", 0.7), ("aa", 0.7), ("\x1b", 0.7), ("u", 0.7), ("\x1b", 0.7), ("d", 0.7), ("d", 0.5)),
    *(("f", 0.5), ("f", 0.5), ("mb", 0.7), ("\x1b", 0.7), ("\x10", 0.7), ("\x1b", 0.7)),
)
# From time to time: another scenario and back, which restarts the run, then two visible runs
ELSEWHERE: Final = (
    *(("w]", 2.0), (" " + FULL_SPEED, 2.0), ("w[", 2.0), (" " + FULL_SPEED, 2.0)),
    *(("ca", 1.0), ("\x1b[B\r", 5.0), ("cl", 1.0), ("cc", 1.0), ("\x1b[3~", 1.0), ("\x1b", 0.7)),
)
ELSEWHERE_EVERY: Final = 3  # minutes


class Minute(NamedTuple):
    """Measures of one minute.

    ``memory`` in bytes, ``steps`` a second, ``written`` bytes per frame, ``frame`` CPU milliseconds of the
    screen's thread, ``gap`` the 95th percentile of milliseconds between frames, ``key`` milliseconds until a
    paused run answers.
    """

    memory: int
    threads: int
    files: int
    steps: float
    frames: float
    frame: float
    gap: float
    written: float
    key: float

    def row(self, number: int) -> str:
        return (
            f"{number:6} {self.memory / _MEGABYTE:9.1f} {self.threads:7} {self.files:5} "
            f"{self.steps / 1e6:9.2f} {self.frames:8.1f} {self.frame:9.2f} {self.gap:8.1f} "
            f"{self.written:8.0f} {self.key:7.1f}"
        )


HEADER: Final = "minute  RSS (MB) threads files Msteps/s frames/s CPU ms/fr gap95 ms bytes/fr  key ms"


class Program:
    def __init__(self, sessions: Path, scenario: str = SCENARIO) -> None:
        self._ours, theirs = pty.openpty()
        self._resize(SIZE)
        environment = {
            "PATH": os.environ.get("PATH", ""),
            "HOME": os.environ.get("HOME", "/"),
            "TERM": "xterm-256color",
            "LC_ALL": "C.UTF-8",
            "RL_TUI_SESSIONS_DIR": str(sessions),
            **{name: os.environ[name] for name in ("PYTHONPATH", "RL_TUI_CACHE_DIR") if name in os.environ},
        }
        self._process = subprocess.Popen(
            [sys.executable, "-m", "rl_tui", "play", scenario],
            stdin=theirs,
            stdout=theirs,
            stderr=theirs,
            env=environment,
            start_new_session=True,
            preexec_fn=lambda: fcntl.ioctl(0, termios.TIOCSCTTY, 0),  # for the signals of new sizes
        )
        os.close(theirs)
        self.pid = self._process.pid
        self.bytes = 0
        self.frames = 0
        self.last_byte = time.perf_counter()
        self.frame_ends: deque[float] = deque(maxlen=100_000)
        self.end = b""
        self._copies: list[bytes] | None = None
        self._reader = threading.Thread(target=self._drain, daemon=True)
        self._reader.start()

    def __enter__(self) -> Program:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._process.poll() is None:
            self._process.kill()
        self._process.wait()
        self._reader.join()
        os.close(self._ours)

    @property
    def ended(self) -> bool:
        return self._process.poll() is not None

    def press(self, keys: str) -> None:
        os.write(self._ours, keys.encode())

    def quit(self) -> int:
        if not self.ended:
            self.press("qq")
        return self._process.wait(START)

    def look(self) -> str:
        screen = pyte.Screen(*SIZE)
        stream = pyte.ByteStream(screen)
        self._copies = []
        for columns in (SIZE[0] - 1, SIZE[0]):
            self._resize((columns, SIZE[1]))
            self.wait_until(lambda: False, 0.7)
        written, self._copies = b"".join(self._copies), None
        stream.feed(written)
        return "\n".join(screen.display)

    def wait_for_quiet(self) -> None:
        self.wait_until(lambda: time.perf_counter() - self.last_byte > QUIET, PATIENCE)

    def answer_time(self, keys: str) -> float:
        self.wait_for_quiet()
        before, start = self.bytes, time.perf_counter()
        self.press(keys)
        self.wait_until(lambda: self.bytes > before, PATIENCE)
        return self.last_byte - start if self.bytes > before else PATIENCE

    def memory(self) -> int:
        pages = int(Path(f"/proc/{self.pid}/statm").read_text(encoding="utf-8").split()[1])
        return pages * os.sysconf("SC_PAGE_SIZE")

    def share(self) -> int:
        """Return the resident set in bytes; shared pages count by their share."""
        rollup = Path(f"/proc/{self.pid}/smaps_rollup").read_text(encoding="utf-8")
        return sum(int(line.split()[1]) << 10 for line in rollup.splitlines() if line.startswith("Pss:"))

    def count(self, folder: str) -> int:
        return len(os.listdir(f"/proc/{self.pid}/{folder}"))

    def screen_seconds(self) -> float:
        fields = (
            Path(f"/proc/{self.pid}/task/{self.pid}/stat")
            .read_text(encoding="utf-8")
            .rpartition(")")[2]
            .split()
        )
        return (int(fields[11]) + int(fields[12])) / _TICKS

    def wait_until(self, is_over: object, seconds: float) -> None:
        deadline = time.perf_counter() + seconds
        while time.perf_counter() < deadline and not (callable(is_over) and is_over()):
            time.sleep(0.002)

    def _resize(self, size: tuple[int, int]) -> None:
        fcntl.ioctl(self._ours, termios.TIOCSWINSZ, struct.pack("HHHH", size[1], size[0], 0, 0))

    def _drain(self) -> None:
        tail = b""
        while True:
            ready, _, _ = select.select([self._ours], [], [], 1.0)
            if not ready:
                if self.ended:
                    return
                continue
            try:
                data = os.read(self._ours, 65536)
            except OSError:  # the other end is closed
                return
            self.last_byte = time.perf_counter()
            if self._copies is not None:
                self._copies.append(data)
            seen = tail + data
            self.bytes += len(data)
            # a sequence may be divided, but none may count twice
            done = max((match.end() for match in _TOLD.finditer(seen)), default=0)
            tail = seen[done:][-_LONGEST:]
            ends = seen.count(_FRAME_END, 0, done)
            self.frame_ends.extend([self.last_byte] * min(ends, 1))
            self.frames += ends
            for _ in _KNOWS_SYNCHRONISED.finditer(seen, 0, done):
                os.write(self._ours, b"\x1b[?2026;2$y")
            for line, column in _WHERE.findall(seen, 0, done):
                os.write(self._ours, b"\x1b[%d;%dR" % (int(line), int(column or 1)))
            self.end = (self.end + data)[-_END_KEPT:]


def plain(written: bytes) -> str:
    return re.sub(rb"\x1b\[[0-?]*[ -/]*[@-~]", b"", written).decode(errors="replace")


def steps_kept(folder: Path) -> int:
    sessions, _ = sessions_in(folder)
    return max(sessions, key=lambda session: session.written[1]).step if sessions else 0


def run_on(program: Program) -> None:
    for _ in range(60):
        if program.ended:
            return
        seen = program.look()
        drawn = program.frames
        if FULL in seen:
            time.sleep(1.0)  # a key may still be on its way
            if program.frames > drawn:
                return
        if PAUSED in seen:
            program.press(" " + FULL_SPEED)
        time.sleep(1.0)
    sys.exit(f"it does not run at full speed any more:\n{seen}")


def minute(program: Program, folder: Path, number: int) -> Minute:
    deadline = time.perf_counter() + MINUTE
    undisturbed = MINUTE / 2
    begun, frames, written, worked = (
        time.perf_counter(),
        program.frames,
        program.bytes,
        program.screen_seconds(),
    )
    steps = steps_kept(folder)
    program.frame_ends.clear()
    while time.perf_counter() - begun < undisturbed and not program.ended:
        time.sleep(0.1)
    seconds = time.perf_counter() - begun
    frames, written = program.frames - frames, program.bytes - written
    worked, steps = program.screen_seconds() - worked, steps_kept(folder) - steps
    ends = list(program.frame_ends)
    gaps = sorted(later - earlier for earlier, later in pairwise(ends))
    for keys, pause in KEYS + (ELSEWHERE if number % ELSEWHERE_EVERY == 0 else ()):
        program.press(keys)
        time.sleep(pause)
    program.press(" ")
    keys_answered = [program.answer_time("v") for _ in range(4)]
    program.press(" ")
    run_on(program)
    while time.perf_counter() < deadline and not program.ended:
        time.sleep(0.1)
    return Minute(
        memory=program.memory(),
        threads=program.count("task"),
        files=program.count("fd"),
        steps=steps / seconds,
        frames=frames / seconds,
        frame=worked * 1e3 / max(1, frames),
        gap=gaps[len(gaps) * 95 // 100] * 1e3 if gaps else 0.0,
        written=written / max(1, frames),
        key=median(keys_answered) * 1e3,
    )


def verdict(first: Minute, last: Minute) -> tuple[str, bool]:
    memory, frame = last.memory / first.memory, last.frame / first.frame
    is_flat = memory <= MOST_GROWTH and frame <= MOST_GROWTH and last.threads <= first.threads + 2
    words = (
        f"last minute against the first: memory {memory - 1:+.1%}, frame time {frame - 1:+.1%}, "
        f"speed {last.steps / max(1.0, first.steps) - 1:+.1%}, threads {last.threads - first.threads:+d}, "
        f"files {last.files - first.files:+d}: {'flat' if is_flat else 'NOT FLAT'}"
    )
    return words, is_flat


def untouched(minutes: int) -> int:
    with tempfile.TemporaryDirectory() as name, Program(Path(name), UNTOUCHED) as program:
        program.wait_until(lambda: program.frames > 0, START)
        program.wait_for_quiet()
        run_on(program)
        now = datetime.now(UTC)
        print(f"{UNTOUCHED} at {SIZE[0]}x{SIZE[1]}, at full speed, no keys, {minutes} min, {now:%Y-%m-%d}")
        print("minute   time UTC  RSS (MB)  PSS (MB)    million steps", flush=True)
        begun, settled = time.monotonic(), list[int]()
        for number in range(1, minutes + 1):
            program.wait_until(lambda: program.ended, max(0.0, begun + number * MINUTE - time.monotonic()))
            if program.ended:
                print(f"the program has ended with status {program.quit()}:\n{plain(program.end)}")
                return 1
            memory, share, steps = program.memory(), program.share(), steps_kept(Path(name))
            settled += [memory] if number >= SETTLED else []
            print(
                f"{number:6}   {datetime.now(UTC):%H:%M:%S}  {memory / _MEGABYTE:8.2f}  "
                f"{share / _MEGABYTE:8.2f}  {steps / 1e6:15,.0f}",
                flush=True,
            )
        status = program.quit()
    drift = max((abs(memory / settled[0] - 1) for memory in settled), default=0.0)
    is_flat = drift <= MOST_DRIFT
    flat = "flat" if is_flat else "NOT FLAT"
    print(f"from minute {SETTLED} on {drift:.2%} at most: {flat}; exit status {status}")
    return 0 if is_flat and status == 0 else 1


def main() -> int:
    numbers = [argument for argument in sys.argv[1:] if argument.isdecimal()]
    minutes = int(numbers[0]) if numbers else 60
    if "--untouched" in sys.argv:
        return untouched(minutes)
    with tempfile.TemporaryDirectory() as name, Program(Path(name)) as program:
        program.wait_until(lambda: program.frames > 0, START)
        program.wait_for_quiet()
        run_on(program)
        print(f"{SCENARIO} at {SIZE[0]}x{SIZE[1]}, at full speed, {minutes} min", flush=True)
        print(HEADER, flush=True)
        figures = []
        for number in range(minutes):
            figures.append(minute(program, Path(name), number))
            print(figures[-1].row(number + 1), flush=True)
            if program.ended:
                print(f"the program has ended with status {program.quit()}:\n{plain(program.end)}")
                return 1
        print(program.look().splitlines()[0].strip())
        status = program.quit()
        words, is_flat = verdict(figures[0], figures[-1])
    print(f"{words}; exit status {status}")
    return 0 if is_flat and status == 0 else 1


if __name__ == "__main__":
    sys.exit(main())
