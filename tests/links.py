"""Print measures of the program on slow links: ``python tests/links.py``.

The playground trains at full speed in a terminal of 80×24 at the end of a throttled link. The measures are
the delay from key to screen, the size and rate of frames, and the learning speed. They are not tests: other
work on the machine changes them.
"""

from __future__ import annotations

import argparse
import json
import re
import subprocess
import time
from collections.abc import Iterator
from itertools import cycle
from statistics import mean, median, quantiles
from typing import Final, NamedTuple

from pseudo_terminal import RL_TUI
from throttled import ThrottledTerminal

SCENARIO: Final = "frozenlake-slippery"
FULL_SPEED: Final = " " + "+" * 9
RATES: Final = (None, 100_000, 30_000, 10_000)
DEPTHS: Final = ("truecolor", "256", "16")
ALLOWED: Final = {None: 0.3, 100_000: 0.3, 30_000: 0.3, 10_000: 0.6}  # seconds from a key to the screen
STEPS: Final = re.compile(r"step +([\d,.]+)([MG]?)\s")
END_OF_FRAME: Final = b"\x1b[?2026l"
SSH_BUFFER: Final = 65536
# keys and the screens they lead to, in cycles that end at their start
KEYS: Final = (
    ("pause", " ", r"❚❚ paused"),
    ("run", " ", r"▶"),
    ("layer", "v", r"▌Q\*▐"),
    ("layer", "v", r"▌Q−Q\*▐"),
    ("layer", "v", r"▌visits▐"),
    ("layer", "v", r"▌landscape▐"),
    ("layer", "v", r"▌Q▐"),
    ("speed", "-", r"100,000/s"),
    ("speed", "+", r"▶ max"),
    ("slider", "\x1b[C", r"α .* 0\.110"),
    ("slider", "\x1b[D", r"α .* 0\.100"),
    ("help", "?", r"Words  Pages"),
    ("close help", "\x1b", r"^(?!.*(Words  Pages|esc: close ─))"),
)


class Key(NamedTuple):
    name: str
    delay: float


class Frames(NamedTuple):
    sizes: list[int]
    frames_per_second: float
    bytes_per_second: float
    steps_per_second: float


def start(rate: float | None, depth: str, room: int, options: argparse.Namespace) -> ThrottledTerminal:
    terminal = ThrottledTerminal(
        [*RL_TUI, "play", options.scenario, "--colors", depth],
        rate=rate,
        room=room,
        tells_position=not options.silent,
    )
    terminal.wait_for("paused")
    terminal.press(FULL_SPEED)
    terminal.wait_for(r"▶ max +ep .* step +[\d,.]{5,}")
    terminal.press("1")  # focuses the first slider, for the arrow keys
    return terminal


def finish(terminal: ThrottledTerminal) -> None:
    """Quit. The next shell must find nothing in its input."""
    terminal.rate = None
    terminal.press("qq")
    terminal.wait_for_end()


def watch(terminal: ThrottledTerminal, seconds: float) -> Frames:
    before, began = len(terminal.written), time.perf_counter()
    steps: list[tuple[float, float]] = []
    while time.perf_counter() < began + seconds or len({step for _, step in steps}) < 3:
        steps += [(moment, step) for moment, screen in terminal.reading(1.0) if (step := step_of(screen))]
    taken = time.perf_counter() - began
    written = terminal.written[before:]
    sizes = [len(piece) for piece in written.split(END_OF_FRAME)[1:-1]]
    speed = (steps[-1][1] - steps[0][1]) / (steps[-1][0] - steps[0][0])
    return Frames(sizes, len(sizes) / taken, len(written) / taken, speed)


def step_of(screen: str) -> float | None:
    found = STEPS.search(screen)
    return float(found[1].replace(",", "")) * {"": 1, "M": 1e6, "G": 1e9}[found[2]] if found else None


def press_keys(terminal: ThrottledTerminal, count: int) -> Iterator[Key]:
    """Press at least ``count`` keys until their cycle is complete, at random moments of a frame."""
    for number, (name, key, pattern) in enumerate(cycle(KEYS)):
        if number >= count and number % len(KEYS) == 0:
            return
        for _ in terminal.reading(0.5 + 0.037 * (number % 11)):
            pass
        pressed = time.perf_counter()
        terminal.press(key)
        expected = re.compile(pattern, re.DOTALL if pattern.startswith("^") else 0)
        terminal.wait_until(lambda expected=expected: bool(expected.search(terminal.screen)), what=name)
        yield Key(name, time.perf_counter() - pressed)


def headless(scenario: str) -> float:
    command = [*RL_TUI, "train", scenario, "--steps", "100000000", "--json"]
    done = subprocess.run(command, check=True, capture_output=True)
    return float(json.loads(done.stdout)["steps_per_second"])


def report(rate: float | None, depth: str, room: int, options: argparse.Namespace) -> None:
    with start(rate, depth, room, options) as terminal:
        frames = watch(terminal, options.seconds)
        keys = list(press_keys(terminal, options.keys))
        finish(terminal)
    delays = [key.delay for key in keys]
    waits = (
        f"key {median(delays):.2f} s, 95 % {quantiles(delays, n=20)[-1]:.2f}, worst {max(delays):.2f} "
        f"(at most {ALLOWED.get(rate, 'any')})   "
        if delays
        else ""
    )
    print(
        f"{name_of(rate):>10} {depth:>9} {room // 1024:>3} kB buffer:  {waits}"
        f"frame {mean(frames.sizes) / 1e3:.2f} kB, "
        f"{frames.frames_per_second:.1f}/s, {frames.bytes_per_second / 1e3:.1f} kB/s   "
        f"{frames.steps_per_second / 1e6:.1f} million steps/s, "
        f"headless {headless(options.scenario) / 1e6:.1f}",
        flush=True,
    )
    if options.each:
        for name in dict.fromkeys(key.name for key in keys):
            each = [key.delay for key in keys if key.name == name]
            print(f"{'':12}{name:12} {median(each):.2f} s, worst {max(each):.2f}", flush=True)


def come_back(options: argparse.Namespace) -> None:
    with start(None, "256", SSH_BUFFER, options) as terminal:
        rates = []
        for rate in (None, 10_000, None):
            terminal.rate = rate
            watch(terminal, 1.0)
            rates.append(watch(terminal, options.seconds).frames_per_second)
        finish(terminal)
    print(f"frames/s before, at 10 kB/s, and after: {', '.join(f'{rate:.1f}' for rate in rates)}", flush=True)


def name_of(rate: float | None) -> str:
    return f"{rate / 1e3:.0f} kB/s" if rate else "no limit"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rates", type=float, nargs="*", default=RATES, help="bytes a second, 0: no limit")
    parser.add_argument("--depths", nargs="*", default=DEPTHS, choices=DEPTHS)
    parser.add_argument("--rooms", type=int, nargs="*", default=(0, SSH_BUFFER), help="buffer before it")
    parser.add_argument("--scenario", default=SCENARIO, help="what is played; --keys knows this one only")
    parser.add_argument("--keys", type=int, default=24, help="keys pressed on each link; 0: frames only")
    parser.add_argument("--seconds", type=float, default=6.0, help="how long frames are watched")
    parser.add_argument("--silent", action="store_true", help="the terminal never says where its cursor is")
    parser.add_argument("--each", action="store_true", help="each kind of key by itself")
    parser.add_argument("--no-return", action="store_true", help="leave out that the frame rate comes back")
    options = parser.parse_args()
    for rate in options.rates:
        for depth in options.depths:
            for room in options.rooms if rate else (0,):
                report(rate or None, depth, room, options)
    if not options.no_return:
        come_back(options)


if __name__ == "__main__":
    main()
