"""Kill a sweep at random moments and check its store: ``python tests/sweep_kills.py 50``."""

from __future__ import annotations

import io
import random
import sqlite3
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Final, NamedTuple

from rl_tui.runs.library import find
from rl_tui.studies.sweeps.cells.variation import read_variation
from rl_tui.studies.sweeps.document import write_csv
from rl_tui.studies.sweeps.plan import SweepPlan
from rl_tui.studies.sweeps.store import Store
from rl_tui.studies.sweeps.sweep import run_sweep

ALLOWED_LOSS: Final = 0.25  # seconds
# Reports each finished run with its time, and then stores it as every sweep does
CHILD: Final = """
import os, sys, time
from pathlib import Path
from sweep_kills import plan_of
from rl_tui.studies.sweeps.store import Store
from rl_tui.studies.sweeps.sweep import run_sweep

plan = plan_of(int(sys.argv[2]))

def tell(cell, rows):
    for row in rows:
        if row.seed in missing[cell.index]:
            os.write(1, f"{cell.index} {row.seed} {time.monotonic()}\\n".encode())

with Store.to_write(Path(sys.argv[1])) as store:
    missing = [store.missing(plan.cell(index).key, plan.seeds) for index in range(plan.count)]
    run_sweep(plan, store, on_rows=tell)
"""


class Kill(NamedTuple):
    """``lost`` is the age, in seconds, of the oldest finished run that was lost."""

    kept: int
    lost: float


def plan_of(cells: int) -> SweepPlan:
    vary = read_variation(f"alpha=0.01:1:{cells}")
    return SweepPlan(find("maze"), (vary,), {"algorithm": "q-learning"}, episodes=100, runs=2)


def kill(store: Path, cells: int, chance: random.Random) -> Kill:
    command = [sys.executable, "-c", CHILD, str(store), str(cells)]
    told = dict[tuple[int, int], float]()
    with subprocess.Popen(command, stdout=subprocess.PIPE, cwd=Path(__file__).parent) as child:
        assert child.stdout is not None
        if chance.random() < 0.1:  # while it starts
            time.sleep(chance.uniform(0.0, 0.6))
        for _ in range(chance.randint(0, cells // 4)):
            index, seed, moment = (child.stdout.readline() or b"-1 0 0").split()
            told[int(index), int(seed)] = float(moment)
        child.kill()
        killed = time.monotonic()
        child.wait()
    told.pop((-1, 0), None)  # it finished
    kept = kept_in(store, plan_of(cells))
    lost = [killed - moment for place, moment in told.items() if place not in kept]
    return Kill(len(kept), max(lost, default=0.0))


def kept_in(store: Path, plan: SweepPlan) -> set[tuple[int, int]]:
    if not store.exists():
        return set()
    with closing(sqlite3.connect(store)) as database:
        assert database.execute("PRAGMA integrity_check").fetchall() == [("ok",)]
        if database.execute("SELECT COUNT(*) FROM sqlite_master").fetchone() == (0,):
            return set()  # killed before its tables existed
        pairs = database.execute("SELECT key, seed FROM rows").fetchall()
    database.close()
    assert len(pairs) == len(set(pairs))
    number = {plan.cell(index).key: index for index in range(plan.count)}  # type: ignore[union-attr]
    return {(number[key], seed) for key, seed in pairs}


def csv_of(plan: SweepPlan, store: Store) -> str:
    stream = io.StringIO()
    write_csv(stream, plan, store)
    return stream.getvalue()


def kills(count: int, seed: int, cells: int = 400) -> Iterator[Kill]:
    """Continue until a sweep finishes. Raise if its result differs from one without kills."""
    chance, plan = random.Random(seed), plan_of(cells)
    with Store.without_file() as whole:
        run_sweep(plan, whole)
        expected = csv_of(plan, whole)
    with tempfile.TemporaryDirectory() as folder:
        for number in range(count):
            path = Path(folder) / f"{len(list(Path(folder).glob('*.done')))}.sqlite"
            yield kill(path, cells, chance)
            if number == count - 1 or len(kept_in(path, plan)) == cells * 2:
                with Store.to_write(path) as store:
                    run_sweep(plan, store)
                    assert csv_of(plan, store) == expected
                path.with_suffix(".done").touch()


def main() -> None:
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 50
    seed = int(sys.argv[2]) if len(sys.argv) > 2 else random.randrange(2**32)
    print(f"{count} kills, seed {seed}", flush=True)
    done = []
    for each in kills(count, seed):
        done.append(each)
        print(".", end="", flush=True)
    lost = sorted(each.lost for each in done)
    print(f"\nruns that were kept: {sum(each.kept for each in done):,}")
    print(f"oldest finished run lost: median {lost[len(lost) // 2]:.3f} s, most {lost[-1]:.3f} s")
    print("every store is sound, has nothing twice, and comes to the same CSV in the end")


if __name__ == "__main__":
    main()
