"""Sweeps on a Dask cluster: a real scheduler, and workers that die, differ and come late."""

from __future__ import annotations

import io
import json
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Final

import pytest

pytest.importorskip("distributed", reason="the package distributed is not installed")

import deadly_lake
from click.testing import CliRunner
from dask_cluster import Cluster
from plans import plan_of

from rl_tui.agents.kernels.stepped_loop import MOST_SEEDS
from rl_tui.cli.commands.sweeping.sweep import command
from rl_tui.common.errors import UserError
from rl_tui.common.streams import streams
from rl_tui.lab.sweeps.cell import Cell
from rl_tui.lab.sweeps.cluster.dask_workers import DaskWorkers
from rl_tui.lab.sweeps.csv_rows import write_csv
from rl_tui.lab.sweeps.merge import merge
from rl_tui.lab.sweeps.plan import Shard, SweepPlan
from rl_tui.lab.sweeps.runs import RunRow
from rl_tui.lab.sweeps.store import Store
from rl_tui.lab.sweeps.sweep import run_sweep
from rl_tui.worlds.gym import modules

pytestmark = [pytest.mark.process, pytest.mark.xdist_group("dask")]

VARY: Final = ("alpha=0.1:0.9:5", "algorithm=q-learning,sarsa")
ANOTHER_NUMBA: Final = """
import importlib.metadata
real = importlib.metadata.version
importlib.metadata.version = lambda name: "0.1.2" if name == "numba" else real(name)
"""


@pytest.fixture(scope="module")
def cluster(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Cluster]:
    with Cluster(tmp_path_factory.mktemp("cluster")) as started:
        yield started


def csv_of(plan: SweepPlan, store: Store) -> str:
    stream = io.StringIO()
    write_csv(stream, plan, store)
    return stream.getvalue()


def on_this_machine(plan: SweepPlan) -> str:
    with Store.without_file() as store:
        run_sweep(plan, store)
        return csv_of(plan, store)


def machines(store: Store, plan: SweepPlan) -> list[str]:
    cells = [cell for cell in map(plan.cell, range(plan.count)) if isinstance(cell, Cell)]
    return [machine for cell in cells for machine, _ in store.rows_by_machine(cell.key)]


class After:
    """Does something once so many rows have come."""

    def __init__(self, rows: int, action: object) -> None:
        self._left, self._action = rows, action
        self.rows = 0

    def __call__(self, cell: Cell, rows: Sequence[RunRow]) -> None:
        self.rows += len(rows)
        self._left -= len(rows)
        if self._left <= 0 and self._action is not None:
            action, self._action = self._action, None
            action()


def test_a_worker_that_is_killed_half_way_changes_no_byte(cluster: Cluster) -> None:
    plan = plan_of("cliff", *VARY, runs=12, episodes=300)
    killed, _ = cluster.start(2)
    half_way = After(plan.count * plan.runs // 2, lambda: cluster.kill(killed))
    with Store.without_file() as store:
        done = run_sweep(plan, store, workers=DaskWorkers(cluster.address), on_rows=half_way)
        assert csv_of(plan, store) == on_this_machine(plan)
        assert len(machines(store, plan)) == plan.count * plan.runs
    lost = [each["processing-tasks"] for each in cluster.events(killed) if each.get("action") == "remove-worker"]
    assert lost[0]
    assert half_way.rows == done.done == plan.count * plan.runs
    assert done.failed == 0
