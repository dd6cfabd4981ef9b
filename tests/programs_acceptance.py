"""Run every program of the corpus over many seeds; check that all faults, and only faults, are found.

python tests/programs_acceptance.py [--seeds 20] [--only TEXT] [--jobs 2]

Prints a row for each program. Exits with 1 if a fault was missed or claimed wrongly.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

sys.path.insert(0, str(Path(__file__).parent / "programs"))

from corpus import CORRECT, FAULTY, Program, line_of

from rl_tui.programs.diagnosis.diagnosis import verdict_of

_FIGURES = ("alpha", "gamma", "epsilon")


class Seen(NamedTuple):
    faults: tuple[str, ...]
    lines: tuple[str, ...]
    rule: str
    figures: dict[str, float | None]
    error: str


def seen(program: Program, seed: int) -> Seen:
    with TemporaryDirectory() as folder:
        log = program.watched(Path(folder), seed)
        verdict = verdict_of(log)
        return Seen(
            tuple(each.fault.value for each in verdict.findings),
            tuple(line_of(each) for each in verdict.findings),
            verdict.update.rule.value,
            {name: getattr(verdict.update, name) for name in _FIGURES},
            "" if log.error is None else f"{log.error.type}: {log.error.text}",
        )


def row_of_faulty(program: Program, runs: list[Seen]) -> tuple[bool, str]:
    wanted, line = (program.expect,), program.line
    found = sum(run.faults == wanted for run in runs)
    lines = sum(set(run.lines) == {line} for run in runs)
    others = Counter(run.faults for run in runs if run.faults != wanted)
    text = f"{program.name:32} {wanted[0]:30} found {found}/{len(runs)}  line {lines}/{len(runs)}"
    return found == lines == len(runs), text + _more(others, runs)


def row_of_correct(program: Program, runs: list[Seen]) -> tuple[bool, str]:
    said = program.expect
    claimed = Counter(run.faults for run in runs if run.faults)
    rule = said.get("rule") or "unknown"
    right = sum(run.rule == rule and _agrees(run, said) for run in runs)
    silent = len(runs) - sum(claimed.values())
    text = f"{program.name:32} {rule:30} rule {right}/{len(runs)}  no claim {silent}/{len(runs)}"
    return silent == len(runs), text + _more(claimed, runs)


def _agrees(run: Seen, said: dict[str, Any]) -> bool:
    for name in _FIGURES:
        wanted, got = said.get(name), run.figures[name]
        if name in said and (wanted is None) != (got is None):
            return False
        if wanted is not None and got is not None and abs(got - wanted) > 1e-6 * abs(wanted):
            return False
    return True


def _more(others: Counter[tuple[str, ...]], runs: list[Seen]) -> str:
    errors = {run.error for run in runs} - {""}
    text = "".join(f"  {count} × {', '.join(faults) or 'nothing'}" for faults, count in others.items())
    return text + "".join(f"  {error}" for error in errors)


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--only", default="", help="programs whose name holds this")
    parser.add_argument("--jobs", type=int, default=2)
    options = parser.parse_args()
    wrong = 0
    with ProcessPoolExecutor(options.jobs) as pool:
        for programs, row in ((FAULTY, row_of_faulty), (CORRECT, row_of_correct)):
            runs = {
                place: [pool.submit(seen, program, seed) for seed in range(options.seeds)]
                for place, program in enumerate(programs)
                if options.only in program.name
            }
            for place, futures in runs.items():
                is_well, text = row(programs[place], [each.result() for each in futures])
                wrong += not is_well
                print(" " if is_well else "!", text, flush=True)
    print(f"{wrong} programs with something missed or claimed" if wrong else "all found, nothing claimed")
    sys.exit(bool(wrong))


if __name__ == "__main__":
    main()
