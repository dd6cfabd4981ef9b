"""Break files of scenarios, sessions and lessons: ``python tests/fuzz.py 10000 [SEED] [KIND]``.

Every file must work or be refused in one clear line. ``--show KIND SEED NUMBER`` writes a single input.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import threading
import time
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from queue import Empty, Queue
from typing import Final

sys.path.insert(0, str(Path(__file__).parent))

from fuzz_inputs import LESSON, SCENARIO, SESSION, input_of

CHILD: Final = Path(__file__).parent / "fuzz_child.py"
HANGS: Final = 120.0  # seconds of silence, on a busy machine
CHUNK: Final = 400  # inputs per process, to reveal one that grows
SCREENS: Final = 40


@dataclass
class Figures:
    inputs: int = 0
    results: Counter[str] = field(default_factory=Counter)
    found: list[tuple[int, str]] = field(default_factory=list)
    slowest: tuple[float, int] = (0.0, -1)
    largest: tuple[int, int] = (0, -1)

    def add(self, number: int, outcome: dict[str, object]) -> None:
        self.inputs += 1
        self.results[str(outcome["result"])] += 1
        self.slowest = max(self.slowest, (float(str(outcome["seconds"])), number))
        self.largest = max(self.largest, (int(str(outcome["memory"])), number))
        if outcome["found"]:
            self.found.append((number, str(outcome["found"])))


def fuzz(
    kind: str, count: int, seed: int, *, first: int = 0, screens: int = SCREENS, quick: bool = False
) -> Figures:
    """Try ``count`` inputs of a kind from number ``first`` on. One in several accepted inputs is drawn."""
    figures, number, end = Figures(), first, first + count
    while number < end:
        number = _child(figures, kind, seed, number, min(CHUNK, end - number), screens, quick)
    return figures


def _child(figures: Figures, kind: str, seed: int, first: int, count: int, screens: int, quick: bool) -> int:
    arguments = [kind, *map(str, (seed, first, count, screens)), *(["quick"] if quick else [])]
    with tempfile.TemporaryDirectory() as home, tempfile.TemporaryFile() as stderr:
        places = dict.fromkeys(("XDG_CONFIG_HOME", "XDG_DATA_HOME", "RL_TUI_SESSIONS_DIR"), home)
        child = subprocess.Popen(
            [sys.executable, str(CHILD), *arguments],
            stdout=subprocess.PIPE,
            stderr=stderr,
            text=True,
            env={**os.environ, **places},
        )
        lines: Queue[str] = Queue()
        reader = threading.Thread(target=_read, args=(child, lines), daemon=True)
        reader.start()
        number, at_work = first, False
        try:
            while line := lines.get(timeout=HANGS):
                word, position, *rest = line.split(" ", 2)
                at_work = word == "begin"
                number = int(position)
                if not at_work:
                    figures.add(number, json.loads(rest[0]))
                    number += 1
            status = child.wait()
        except Empty:
            status = 0
            figures.add(number, _killed("hangs", HANGS))
            number += 1
        finally:
            child.kill()
            child.wait()
            reader.join()
            child.stdout.close()
        stderr.seek(0)
        written = stderr.read().decode("utf-8", "replace")
        if status:
            figures.add(number, _killed(f"the process died with {status}: {written[-300:]}", 0.0))
            number += 1
        elif written:
            figures.found.append((number, f"written past Python: {written[:300]}"))
    return number


def _read(child: subprocess.Popen[str], lines: Queue[str]) -> None:
    assert child.stdout is not None
    for line in child.stdout:
        lines.put(line)
    lines.put("")


def _killed(found: str, seconds: float) -> dict[str, object]:
    return {"result": "killed", "found": found, "seconds": seconds, "memory": 0}


def main() -> None:
    if sys.argv[1] == "--show":
        kind, seed, number = sys.argv[2], int(sys.argv[3]), int(sys.argv[4])
        sys.stdout.buffer.write(input_of(kind, seed, number))
        return
    count = int(sys.argv[1])
    seed = int(sys.argv[2]) if len(sys.argv) > 2 else 0
    kinds = sys.argv[3:] or [SCENARIO, SESSION, LESSON]
    failed = False
    for kind in kinds:
        begin = time.monotonic()
        figures = fuzz(kind, count, seed)
        failed = failed or bool(figures.found)
        accepted = sum(number for result, number in figures.results.items() if result.startswith("accepted"))
        print(f"{kind}: {figures.inputs:,} inputs, seed {seed}, in {time.monotonic() - begin:,.0f} s")
        print(f"  accepted {accepted:,}, refused {figures.inputs - accepted:,}, faults {len(figures.found)}")
        print(f"  slowest {figures.slowest[0]:.2f} s of CPU (input {figures.slowest[1]})")
        print(f"  most memory {figures.largest[0]} MB more (input {figures.largest[1]})")
        for result, number in figures.results.most_common(40):
            print(f"  {number:6,}  {result}")
        for number, found in figures.found:
            print(f"  FAULT in input {number}: {found}")
    sys.exit(failed)


if __name__ == "__main__":
    main()
