"""Print this machine's timings for the project's targets: ``python tests/measure.py``.

They are not tests: nothing fails on a slow machine. Each runs the real program, in turns with its point of
comparison. Values are medians unless marked.
"""

from __future__ import annotations

import argparse
import asyncio
import json
import os
import re
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from compileall import compile_dir
from pathlib import Path
from statistics import median, quantiles
from tempfile import TemporaryDirectory
from typing import Final

from edit_times import edit_times
from frame_times import frame_times
from journeys import journeys
from pseudo_terminal import RL_TUI, PseudoTerminal
from seed_study_cost import seed_study_cost
from statistics_measured import comparison, coverage

import rl_tui

PACKAGE: Final = Path(rl_tui.__file__).parent
SCENARIO: Final = "frozenlake-slippery"
IMPORTS: Final = (sys.executable, "-c", "import numpy, numba, gymnasium")
EMPTY_APP: Final = (sys.executable, "-c", "from textual.app import App; App().run()")
FULL_SPEED: Final = " " + "+" * 9
LIVE_SECONDS: Final = 6.0
# The map's scale in each layer, in the order of the key v
SCALES: Final = ("exact value", "error", r"visits \d", "a line every", r"(?m)^ *value (?!.*a line every)")
STEPS: Final = re.compile(r"step +([\d,]+)\s")
MEMORY: Final = """
import os, sys
from rl_tui.agents.compiling.loops import compile_here
from rl_tui.runs.library import find, recipe_for
from rl_tui.runs.run import Run
run = Run(recipe_for(find({scenario!r})))
compile_here(run.learner.loop)
page = os.sysconf("SC_PAGE_SIZE") / 1e6
for steps in ({first}, {last}):
    while run.step < steps:
        run.advance(min(steps - run.step, 10_000_000))
    with open("/proc/self/statm", encoding="ascii") as file:
        print(int(file.read().split()[1]) * page, flush=True)
"""
ONE_STEP: Final = {
    "sarsa": "windy",
    "expected-sarsa": "cliff",
    "double-q-learning": "max-bias",
    "q-learning": "cliff",
}
SIDES: Final = (4, 16, 64, 256)
EVALUATE: Final = ("evaluate", "--policy", "uniform", "--gamma", "0.99", "--json")
OPEN_GRID: Final = """title = "Open grid"
[defaults]
epsilon = 0.1
[grid]
time_limit = {limit}
map = '''
{map}
'''
"""

BEGINNINGS: Final = {
    "solve student": ("solve student", "at most 1.3 times"),
    "train, 10 episodes": ("train frozenlake --episodes 10", "at most 1.6 times"),
    "train, 10 episodes, cold": ("train frozenlake --episodes 10", "at most 1.6 times"),
    "train": ("train frozenlake", ""),
    "train, cold": ("train frozenlake", "at most 5 times"),
}
FIRST_STEP: Final = "play to the first step, cold"

Rows = Iterator[tuple[str, str, str]]


def start_up(rounds: int) -> Rows:
    taken = [_time_of((*RL_TUI, "--version")) for _ in range(rounds)]
    yield "rl-tui --version", f"{median(taken):.3f} s", "at most 0.25 s"


def beginnings(rounds: int) -> Rows:
    """The first output of each command, as a multiple of the slow imports."""
    imports: list[float] = []
    times: dict[str, list[float]] = {what: [] for what in (*BEGINNINGS, FIRST_STEP)}
    for _ in range(rounds):
        imports.append(_time_of(IMPORTS))
        with TemporaryDirectory() as empty:
            for what, (command, _) in BEGINNINGS.items():
                cache = {"RL_TUI_CACHE_DIR": empty} if what.endswith("cold") else {}
                times[what].append(_time_of((*RL_TUI, *command.split()), cache))
        with TemporaryDirectory() as empty:
            times[FIRST_STEP].append(_time_to_first_step({"RL_TUI_CACHE_DIR": empty}))
    yield "import numpy, numba, gymnasium", f"{median(imports):.2f} s", ""
    wanted = {what: most for what, (_, most) in BEGINNINGS.items()} | {FIRST_STEP: "at most 2.5 times"}
    for what, taken in times.items():
        ratio = median(mine / other for mine, other in zip(taken, imports, strict=True))
        yield what, f"{median(taken):.2f} s, {ratio:.2f} times", wanted[what]


def _time_of(command: Sequence[str], variables: Mapping[str, str] | None = None) -> float:
    start = time.perf_counter()
    subprocess.run(command, env=os.environ | (variables or {}), check=True, capture_output=True)
    return time.perf_counter() - start


def _time_to_first_step(variables: Mapping[str, str]) -> float:
    with PseudoTerminal([*RL_TUI, "play", "frozenlake"], variables) as terminal:
        terminal.wait_for("no step yet")
        terminal.press("s")
        terminal.wait_for(r"step\s+1\s")
        taken = time.perf_counter() - terminal.started
        terminal.press("qq")
        terminal.wait_for_end()
    return taken


def bench(rounds: int) -> Rows:
    done = subprocess.run(
        [*RL_TUI, "bench", "--rounds", str(rounds), "--json"], check=True, capture_output=True
    )
    figures = json.loads(done.stdout)
    yield "headless training", f"{figures['kernel_steps_per_second'] / 1e6:.1f} million steps/s", ""
    yield "against the plain Gymnasium loop", f"{figures['ratio']:.0f} times", "at least 400 times"
    yield "the same with random ties", f"{figures['ratio_random_ties']:.0f} times", ""
    yield "64 runs, against one plain loop", f"{figures['ratio_many_runs']:.0f} times", "at least 1,000 times"


def algorithms(rounds: int) -> Rows:
    """Every one-step rule on its own scenario, against the plain Gymnasium loop."""
    speeds: dict[str, list[float]] = {name: [] for name in ONE_STEP}
    plain = []
    for _ in range(rounds):
        done = subprocess.run([*RL_TUI, "bench", "--rounds", "1", "--json"], check=True, capture_output=True)
        plain.append(json.loads(done.stdout)["gymnasium_steps_per_second"])
        for name, scenario in ONE_STEP.items():
            speeds[name].append(_headless_speed(scenario, "--algorithm", name, steps=20_000_000))
    for name, scenario in ONE_STEP.items():
        ratio = median(speeds[name]) / median(plain)
        speed = f"{median(speeds[name]) / 1e6:.1f} million/s, {ratio:.0f} times"
        yield f"{name} on {scenario}", speed, "at least 200 times"


def sizes(rounds: int) -> Rows:
    """Q-learning on growing grids: the cost of a step should stay constant."""
    with TemporaryDirectory() as folder:
        speeds: dict[int, list[float]] = {side: [] for side in SIDES}
        for side in SIDES:
            _write_open_grid(Path(folder) / f"grid-{side}.toml", side, limit=10 * side)
        for _ in range(rounds):
            for side in SIDES:
                speeds[side].append(
                    _headless_speed(str(Path(folder) / f"grid-{side}.toml"), steps=20_000_000)
                )
        for side in SIDES:
            share = median(speeds[side]) / median(speeds[SIDES[0]])
            speed = f"{median(speeds[side]) / 1e6:.1f} million/s, {share:.0%}"
            yield f"open grid of {side * side:,} states", speed, "flat"


def _write_open_grid(path: Path, side: int, limit: int) -> None:
    rows = ["S" + "." * (side - 1), *["." * side] * (side - 2), "." * (side - 1) + "G"]
    path.write_text(OPEN_GRID.format(map="\n".join(rows), limit=limit), encoding="utf-8")


def evaluation(rounds: int) -> Rows:
    limits = {"without a time limit": 0, "within 1,000 steps": 1_000}
    started: list[float] = []
    taken: dict[str, list[float]] = {what: [] for what in limits}
    with TemporaryDirectory() as folder:
        for limit in limits.values():
            _write_open_grid(Path(folder) / f"grid-{limit}.toml", 256, limit)
        for _ in range(rounds):
            started.append(_time_of((*RL_TUI, *EVALUATE, "student")))
            for what, limit in limits.items():
                file = str(Path(folder) / f"grid-{limit}.toml")
                taken[what].append(_time_of((*RL_TUI, *EVALUATE, file)))
    yield "evaluate student: the start of it", f"{median(started):.2f} s", ""
    for what, times in taken.items():
        yield f"65,536 states {what}", f"{median(times):.2f} s", "at most 2 s"


def frames(rounds: int) -> Rows:
    small, large = ([asyncio.run(frame_times(side)) for _ in range(rounds)] for side in (4, 1_000))
    for name in ("frame", "snapshot"):
        few, many = (median(getattr(each, name) for each in times) for times in (small, large))
        yield f"{name} of a 4×4 map", f"{few:.2f} ms", ""
        yield f"{name} of a 1,000×1,000 map", f"{many:.2f} ms, {many / few:.1f} times", "about as quick"


def edits(rounds: int) -> Rows:
    for side in (10, 30, 100):
        times = asyncio.run(edit_times(side, 4 * rounds))
        what = f"edit of a {side}×{side} map"
        yield f"{what}, its world", f"{times.made:.1f} ms", ""
        yield f"{what}, its exact answer", f"{times.answered:.1f} ms", "at most 66 ms"
        yield f"{what}, a frame of it", f"{times.frame:.1f} ms", ""
        yield f"{what}, the answer on the screen", f"{times.seen:.1f} ms", ""
    times = asyncio.run(edit_times(1_000, rounds))
    yield "edit of a 1,000×1,000 map, drawn", f"{times.drawn:.0f} ms", "at most 200 ms with a frame"
    yield "edit of a 1,000×1,000 map, its table", f"{times.made / 1e3:.2f} s", ""
    yield "the first frame of that table", f"{times.frame:.0f} ms", ""


def first_paint(rounds: int) -> Rows:
    empty, ours = [], []
    for _ in range(rounds):
        empty.append(_time_to(EMPTY_APP, _is_filled))
        ours.append(_time_to(RL_TUI, lambda terminal: "Begin here" in terminal.screen))
    later = median(mine - other for mine, other in zip(ours, empty, strict=True))
    yield "first paint of an empty Textual app", f"{median(empty):.2f} s", ""
    yield "first paint of the catalogue", f"{median(ours):.2f} s", ""
    yield "later by", f"{later:.2f} s", "at most 0.2 s"


def _is_filled(terminal: PseudoTerminal) -> bool:
    return terminal.emulator.cell(0, terminal.emulator.lines - 1).bg != "default"


def _time_to(command: tuple[str, ...], is_painted: Callable[[PseudoTerminal], bool]) -> float:
    with PseudoTerminal(command) as terminal:
        terminal.wait_until(lambda: is_painted(terminal))
        taken = time.perf_counter() - terminal.started
        terminal.press("\x11")
        terminal.wait_for_end()
    return taken


def live(rounds: int) -> Rows:
    """Full speed at 120×40 against headless training, and the delay of keys."""
    headless, on_screen, changes, layers = [], [], [], []
    for _ in range(rounds):
        headless.append(_headless_speed())
        with PseudoTerminal([*RL_TUI, "play", SCENARIO]) as terminal:
            terminal.wait_for("paused")
            terminal.press(FULL_SPEED)
            terminal.wait_for(r"step\s+\d{1,3}(,\d{3}){2,}")
            on_screen.append(_live_speed(terminal))
            for turn in range(12):
                layers += [_delay(terminal, turn, "v", scale) for scale in SCALES]
                changes.append(_delay(terminal, turn, "-", "100,000/s"))
                changes.append(_delay(terminal, turn, "+", "▶ max"))
            terminal.press("qq")
            terminal.wait_for_end()
    kept = median(on_screen) / median(headless)
    yield "headless, in the same minutes", f"{median(headless) / 1e6:.1f} million steps/s", ""
    yield "live at 120×40, full speed", f"{median(on_screen) / 1e6:.1f} million steps/s", ""
    yield "kept live", f"{kept:.0%}", "at least 90%"
    yield "key v to another layer, 95%", f"{_percentile(layers):.0f} ms", "at most 50 ms"
    yield "keys + - to another speed, 95%", f"{_percentile(changes):.0f} ms", "at most 50 ms"


def _headless_speed(scenario: str = SCENARIO, *options: str, steps: int = 100_000_000) -> float:
    command = [*RL_TUI, "train", scenario, *options, "--steps", str(steps), "--json"]
    done = subprocess.run(command, check=True, capture_output=True)
    return float(json.loads(done.stdout)["steps_per_second"])


def _live_speed(terminal: PseudoTerminal) -> float:
    samples = [
        (moment, int(found[1].replace(",", "")))
        for moment, screen in terminal.reading(LIVE_SECONDS)
        if (found := STEPS.search(screen))
    ]
    (start, first), (end, last) = samples[0], samples[-1]
    return (last - first) / (end - start)


def _delay(terminal: PseudoTerminal, turn: int, key: str, text: str) -> float:
    for _ in terminal.reading(0.1 + 0.011 * turn):
        pass
    start = time.perf_counter()
    terminal.press(key)
    terminal.wait_for(text)
    return (time.perf_counter() - start) * 1e3


def _percentile(delays: list[float]) -> float:
    return quantiles(delays, n=20)[-1]


def travel(steps: int) -> Rows:
    for scenario, length in ((SCENARIO, steps), ("cliff", steps), ("blackjack", min(steps, 20_000))):
        kinds: dict[str, list[float]] = {}
        for kind, milliseconds in journeys(scenario, length):
            kinds.setdefault(kind, []).append(milliseconds)
        for kind, times in kinds.items():
            wanted = "" if scenario == "blackjack" else "at most 200 ms"
            figures = f"{median(times):.1f} ms, at most {max(times):.0f}"
            yield f"{scenario} {length:,}: {kind}", figures, wanted


def seeds(rounds: int) -> Rows:
    """The live run's speed during a study of many seeds. It needs two quiet cores."""
    speeds, thrifts = zip(*asyncio.run(seed_study_cost(8 * rounds)), strict=True)
    load = f"load {os.getloadavg()[0]:.1f} of {os.cpu_count()}"
    yield "live speed beside many seeds", f"{median(speeds):.1%}, {load}", "at least 95 %"
    yield "its steps a second of processor", f"{median(thrifts):.1%}", ""


def memory(steps: int) -> Rows:
    """Resident memory of a run after ten million steps and after ``steps``."""
    code = MEMORY.format(scenario=SCENARIO, first=10_000_000, last=steps)
    done = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    first, last = map(float, done.stdout.split())
    yield "memory after 10,000,000 steps", f"{first:.0f} MB", ""
    yield f"after {steps:,} steps", f"{last - first:+.1f} MB", "at most +10 MB"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "what",
        nargs="*",
        help="start-up, beginnings, bench, algorithms, sizes, evaluation, frames, edits, first-paint, live, "
        "travel, seeds, coverage, comparison, memory; default: all",
    )
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--memory-steps", type=int, default=1_000_000_000)
    options = parser.parse_args()
    compile_dir(PACKAGE, quiet=1)  # an installed package has bytecode, even if Python may not write it
    measures: dict[str, Callable[[], Rows]] = {
        "start-up": lambda: start_up(options.rounds),
        "beginnings": lambda: beginnings(options.rounds),
        "bench": lambda: bench(options.rounds),
        "algorithms": lambda: algorithms(options.rounds),
        "sizes": lambda: sizes(options.rounds),
        "evaluation": lambda: evaluation(options.rounds),
        "frames": lambda: frames(options.rounds),
        "edits": lambda: edits(options.rounds),
        "first-paint": lambda: first_paint(options.rounds),
        "live": lambda: live(options.rounds),
        "travel": lambda: travel(100_000_000),
        "seeds": lambda: seeds(options.rounds),
        "coverage": lambda: coverage(2_000 * options.rounds),
        "comparison": lambda: comparison(800 * options.rounds),
        "memory": lambda: memory(options.memory_steps),
    }
    for name in options.what or measures:
        for what, figure, wanted in measures[name]():
            print(f"{what:36} {figure:>26}   {wanted}".rstrip(), flush=True)


if __name__ == "__main__":
    main()
