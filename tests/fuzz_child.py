"""A user's actions on a file, in a child process of fuzz.py."""

from __future__ import annotations

import asyncio
import io
import json
import re
import resource
import sys
import tempfile
import time
import traceback
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final, NamedTuple

sys.path.insert(0, str(Path(__file__).parent))

from fuzz_inputs import LESSON, SCENARIO, SESSION, input_of

ADDRESS_SPACE: Final = 2 << 30  # bytes in addition to the imports
MOST_STEPS: Final = 200
FARTHEST: Final = 20_000  # a session with more steps is not replayed to its end
MOST_STATES: Final = 300
LONGEST_LINE: Final = 2_000
MOST_LINES: Final = 120
LARGEST_JSON: Final = 3_000_000
SLOWEST: Final = 10.0  # seconds of CPU
MOST_MEMORY: Final = 700  # MB that one input may add to the process
WARNED: Final = re.compile(
    r"--[\w-]+ has no effect: |the budget of this bandit is "
    r"|.*: warning: state .* can never reach a terminal state"
    r"|.*: warning: (after (SARSA|Q-learning) has learned, |in a trial of SARSA, episode \d)"
    r"|[\d,]+ states: the exact values|.*: Q differs from the saved one: "
)
FAULT: Final = re.compile(
    r"^(:\d+)?: (.+; [a-z]|line \d+(, column \d+)?: not valid TOML \(.+\)$"
    r"|more than \d+ errors; fix these first$)"
)
AS_IT_IS: Final = (
    10  # one in this many scenarios trains with its own algorithm, which takes seconds to compile
)
QUICK: Final = (
    "--algorithm",
    "q-learning",
    "--policy",
    "epsilon-greedy",
)  # loops that other tests compile too
SIZES: Final = ((80, 24), (120, 40), (60, 18), (200, 60), (20, 5))
KEYS: Final = [
    *("wait:60", "v", "v", "v", "v", "v", "w", "m", "escape", "f", "f", "f", "f", "f", "escape"),
    *("a", "a", "escape", "w", "h", "e", "b", "B", "a", "t", "space", "space", "?", "escape", "a", "p"),
    "escape",
]


class Ended(NamedTuple):
    status: int
    out: str
    err: str


class FoundError(Exception):
    """Something that must not happen."""


def main() -> None:
    kind, (seed, first, count, screens) = sys.argv[1], map(int, sys.argv[2:6])
    quick = "quick" in sys.argv
    report = sys.stdout
    warnings.simplefilter("always", append=True)
    _import_all(screens)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / ("mine.json" if kind == SESSION else "mine.toml")
        for number in range(first, first + count):
            content = input_of(kind, seed, number)
            path.write_bytes(content)
            print("begin", number, file=report, flush=True)
            screen = screens > 0 and number % screens == 0
            compiled = quick or (kind == SCENARIO and number % AS_IT_IS > 0)
            outcome = _gone_through(path, kind, compiled, number if screen else None)
            print("end", number, json.dumps(outcome), file=report, flush=True)


def _import_all(screens: int) -> None:
    import gymnasium  # noqa: F401

    from rl_tui.runs.figures import training_figures  # noqa: F401

    if screens:
        from rl_tui.screen.app.screenshot import screenshot  # noqa: F401
    size = int(re.search(r"VmSize:\s+(\d+)", Path("/proc/self/status").read_text(encoding="utf-8"))[1]) << 10  # type: ignore[index]
    resource.setrlimit(resource.RLIMIT_AS, (size + ADDRESS_SPACE, size + ADDRESS_SPACE))


def _gone_through(path: Path, kind: str, quick: bool, screen: int | None) -> dict[str, Any]:
    begin, memory = time.process_time(), _memory()
    found = ""
    result = ""
    try:
        go_through = {SCENARIO: _scenario, SESSION: _session, LESSON: _lesson}[kind]
        result = go_through(path, quick, screen)
        if time.process_time() - begin > SLOWEST:  # a second time everything is compiled
            begin = time.process_time()
            result = go_through(path, quick, screen)
        spent, grown = time.process_time() - begin, _memory() - memory
        if spent > SLOWEST:
            raise FoundError(f"slow: {spent:.1f} s")
        if grown > MOST_MEMORY:
            raise FoundError(f"memory: {grown} MB")
    except FoundError as finding:
        found = str(finding)
    except BaseException as error:
        where = traceback.extract_tb(error.__traceback__)[-1]
        found = f"{type(error).__name__}: {error} at {where.filename}:{where.lineno}"
    return {
        "result": result,
        "found": found[:600],
        "seconds": time.process_time() - begin,
        "memory": _memory() - memory,
    }


def _memory() -> int:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss >> 10


def _scenario(path: Path, quick: bool, screen: int | None) -> str:
    checked = _run_command(["check", str(path)], path)
    options = QUICK if quick else ()
    trained = _run_command(["train", str(path), "--steps", str(MOST_STEPS), "--json", *options], path)
    if checked.status != trained.status and not re.search(
        r"maps drawn|failed|left ±1e12|is not a number", checked.err + trained.err
    ):
        raise FoundError(
            f"check ended with {checked.status} and train with {trained.status}: {checked.err}{trained.err}"
        )
    if trained.status:
        return _kind_of(trained.err)
    from rl_tui.runs.library import find, recipe_for
    from rl_tui.runs.recipe import begin

    recipe = recipe_for(find(str(path)))
    world = begin(recipe).world
    if world.mdp is not None and world.space.states <= MOST_STATES:
        _run_command(["solve", str(path)], path)
    if screen is not None:
        _shown(recipe, screen)
    return "accepted"


def _lesson(path: Path, quick: bool, screen: int | None) -> str:
    checked = _run_command(["check", str(path), "--quick"], path)
    if not checked.status:
        return "accepted"
    for line in checked.err.splitlines():
        if not FAULT.search(line.removeprefix(str(path))):
            raise FoundError(f"check wrote {line!r}, without a place, what is found and what is expected")
    return _kind_of(checked.err)


def _session(path: Path, quick: bool, screen: int | None) -> str:
    from rl_tui.common.errors import UserError
    from rl_tui.live.sessions.replay import replay_target
    from rl_tui.live.sessions.session import read_session

    try:
        stored = read_session(path)
        record = stored.record()
        target = replay_target(record)
    except UserError as refusal:
        replayed = _run_command(["replay", str(path)], path)
        if replayed.status != 1:
            raise FoundError(f"replayed all the same: {refusal}") from refusal
        return _kind_of(replayed.err)
    switches = any(hasattr(entry.change, "algorithm") for entry in target.branch.journal)
    if quick and (switches or target.lane.recipe.algorithm != "q-learning"):
        return "accepted, not replayed"
    if target.branch.here > FARTHEST:
        return "accepted, too far to replay"
    replayed = _run_command(["replay", str(path), "--json"], path)
    if replayed.status:
        return _kind_of(replayed.err)
    if screen is not None and all(
        branch.end <= FARTHEST for lane in record.lanes for branch in lane.branches
    ):
        _shown(stored, screen)
    return "accepted"


def _shown(start: Any, number: int) -> None:
    import random

    from rl_tui.common.errors import UserError
    from rl_tui.screen.app.screenshot import screenshot

    chance = random.Random(number)
    keys = ["wait:60", *chance.choices(KEYS, k=8)]
    try:
        _quietly(lambda: asyncio.run(screenshot(start, chance.choice(SIZES), keys)))
    except UserError as refusal:
        _check_lines(str(refusal))


def _quietly(do: Callable[[], Any]) -> tuple[str, str]:
    kept = sys.stdout, sys.stderr
    sys.stdout, sys.stderr = (io.TextIOWrapper(io.BytesIO(), "utf-8", write_through=True) for _ in kept)
    try:
        do()
    finally:
        written = [stream.buffer.getvalue().decode("utf-8") for stream in (sys.stdout, sys.stderr)]  # type: ignore[union-attr]
        sys.stdout, sys.stderr = kept
    return written[0], written[1]


def _run_command(arguments: list[str], path: Path) -> Ended:
    from rl_tui.commands.main import program

    status = 0

    def run() -> None:
        nonlocal status
        try:
            program.main(arguments, prog_name="rl-tui")
        except SystemExit as end:
            status = int(end.code or 0)

    out, err = _quietly(run)
    ended = Ended(status, out, err)
    if "unexpected " in err and "RL_TUI_TRACEBACK" in err:
        raise FoundError(f"{arguments[0]}: {err.strip()}")
    if status not in (0, 1) or "Traceback" in err:
        raise FoundError(f"{arguments[0]} ended with {status}: {err}")
    if status == 1 and not err.strip():
        raise FoundError(f"{arguments[0]} failed without a word")
    _check_lines(err)
    for line in err.splitlines():
        if not (WARNED.match(line) if status == 0 else line.startswith(("rl-tui: ", str(path)))):
            raise FoundError(f"{arguments[0]} wrote {line!r}")
    if status == 0 and "--json" in arguments and len(out) < LARGEST_JSON:
        json.loads(out, parse_constant=_refuse)
    return ended


def _check_lines(text: str) -> None:
    lines = text.splitlines()
    if len(lines) > MOST_LINES:
        raise FoundError(f"{len(lines)} lines, the first {lines[0][:200]!r}")
    for line in lines:
        if len(line) > LONGEST_LINE:
            raise FoundError(f"a line of {len(line)} characters: {line[:200]!r}")
        if not line.isprintable():
            raise FoundError(f"a line that is not printable: {line[:200]!r}")


def _refuse(name: str) -> None:
    raise FoundError(f"{name} in JSON")


def _kind_of(message: str) -> str:
    line = message.splitlines()[0].split("mine.", 1)[-1]
    line = re.sub(r'"[^"]*"', '""', line)
    line = re.sub(r"[-+]?\d[\d,.e+]*", "0", line)
    return " ".join(re.findall(r"[a-z ]{4,}", line.split("; expected")[-1].lower()))[:60].strip()


if __name__ == "__main__":
    main()
