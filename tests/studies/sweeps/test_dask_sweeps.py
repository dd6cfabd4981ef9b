"""Sweeps on a Dask cluster."""

from __future__ import annotations

import importlib.util
import json
import socket
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Final

import deadly_lake
import pytest
from click.testing import CliRunner
from dask_cluster import Cluster
from plans import csv_of, plan_of

from rl_tui.agents.kernels.environment_loop import MOST_SEEDS
from rl_tui.commands.by_name.sweeping.sweep import command
from rl_tui.common.errors import UserError
from rl_tui.common.streams import streams
from rl_tui.studies.sweeps.cell import Cell
from rl_tui.studies.sweeps.cluster import connection
from rl_tui.studies.sweeps.cluster import dask_workers as placement
from rl_tui.studies.sweeps.cluster.dask_workers import DaskWorkers
from rl_tui.studies.sweeps.merge import merge
from rl_tui.studies.sweeps.plan import SweepPlan
from rl_tui.studies.sweeps.runs import RunRow
from rl_tui.studies.sweeps.store import Store
from rl_tui.studies.sweeps.sweep import SweepProgress, run_sweep
from rl_tui.worlds.gym import modules

pytestmark = [
    pytest.mark.process,
    pytest.mark.xdist_group("dask"),
    pytest.mark.skipif(
        not importlib.util.find_spec("distributed"), reason="the package distributed is not installed"
    ),
]

VARY: Final = ("alpha=0.1:0.9:5", "algorithm=q-learning,sarsa")
ANOTHER_NUMBA: Final = """
import importlib.metadata
def version(name, real=importlib.metadata.version):
    return "0.1.2" if name == "numba" else real(name)
importlib.metadata.version = version
"""
ANOTHER_MACHINE: Final = """
import platform
platform.machine = lambda: "abacus"
"""


@pytest.fixture(scope="module")
def scheduler(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Cluster]:
    with Cluster(tmp_path_factory.mktemp("cluster")) as started:
        yield started


@pytest.fixture(autouse=True)
def _each_batch_goes_by_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(placement, "USUAL_TIME", 0.0)


@pytest.fixture
def cluster(scheduler: Cluster) -> Iterator[Cluster]:
    yield scheduler
    scheduler.clear()


@pytest.fixture(scope="module")
def plan() -> SweepPlan:
    return plan_of("cliff", *VARY, runs=12, episodes=100)


@pytest.fixture(scope="module")
def expected(plan: SweepPlan) -> str:
    with Store.without_file() as store:
        run_sweep(plan, store)
        return csv_of(plan, store)


def cells(plan: SweepPlan) -> list[Cell]:
    return [cell for cell in map(plan.cell, range(plan.count)) if isinstance(cell, Cell)]


def rows_of(plan: SweepPlan, store: Store) -> dict[tuple[int, int], RunRow]:
    return {(cell.index, row.seed): row for cell in cells(plan) for row in store.rows(cell.key, plan.seeds)}


class OnceHeld:
    def __init__(self, cluster: Cluster, worker: str, wanted: int, action: Callable[[str], object]) -> None:
        self._cluster, self._worker, self._wanted, self._action = cluster, worker, wanted, action
        self._is_held = self._is_done = False

    def __call__(self, progress: SweepProgress) -> None:
        if not self._is_held and progress.done >= self._wanted:
            self._is_held = True
            self._cluster.hold(self._worker)
        if self._is_held and not self._is_done and self._cluster.is_busy(self._worker):
            self._is_done = True
            self._action(self._worker)


@pytest.mark.exhaustive("kills workers")
def test_a_worker_that_is_killed_half_way_changes_no_byte(
    cluster: Cluster, plan: SweepPlan, expected: str
) -> None:
    killed, _ = cluster.start(2)
    wanted, told = plan.count * plan.runs, list[int]()
    half_way = OnceHeld(cluster, killed, wanted // 2, cluster.kill)
    with Store.without_file() as store:
        done = run_sweep(
            plan,
            store,
            workers=DaskWorkers(cluster.address),
            on_progress=half_way,
            on_rows=lambda _, rows: told.append(len(rows)),
        )
        assert csv_of(plan, store) == expected
        assert store.count() == wanted
    assert cluster.dead() == 1
    left = [each for each in cluster.events(killed) if each.get("action") == "remove-worker"]
    assert left[0]["processing-tasks"]
    assert (sum(told), done.done, done.failed) == (wanted, wanted, 0)


@pytest.mark.exhaustive("kills workers")
@pytest.mark.parametrize("allowed_failures", [0, 3])
def test_a_run_that_kills_three_workers_has_failed_and_all_others_are_there(
    allowed_failures: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(modules, "ALLOWED", {deadly_lake.__name__})
    deadly = int(streams(2).world.integers(MOST_SEEDS))
    lake = f"gym:{deadly_lake.__name__}:DeadlyLake-v0"
    small = plan_of(lake, "world.table=false", f"world.kwargs.deadly={deadly},-2", runs=5, episodes=30)
    with Store.without_file() as alone:
        run_sweep(small, alone)
        wanted = rows_of(small, alone)
    with Cluster(tmp_path, allowed_failures) as cluster, Store.without_file() as store:
        cluster.start(4, {deadly_lake.ALLOWED: "yes"})
        done = run_sweep(small, store, workers=DaskWorkers(cluster.address))
        found = rows_of(small, store)
        assert cluster.dead() == 3
    assert (done.done, done.failed) == (10, 1)
    failed = found.pop((0, 2))
    assert failed.failed is not None
    assert "its worker died 3 times" in failed.failed
    assert set(failed.figures.values()) == {None}
    del wanted[0, 2]
    assert {place: row.figures for place, row in found.items()} == {
        place: row.figures for place, row in wanted.items()
    }


@pytest.mark.exhaustive("starts many workers")
def test_a_worker_of_another_version_gets_nothing_whenever_it_comes(
    cluster: Cluster, plan: SweepPlan, expected: str
) -> None:
    (other,) = cluster.start(1, preload=ANOTHER_NUMBA)
    with pytest.raises(
        UserError, match=rf"{cluster.address}: none .*: {other} has Numba 0\.1\.2 instead of "
    ):
        DaskWorkers(cluster.address)
    (good,) = cluster.start(1)
    cluster.client.get_task_stream()  # from now on
    said: list[str] = []
    workers = DaskWorkers(cluster.address, tell=said.append)
    assert [line.split(": it has Numba 0.1.2 instead of ")[0] for line in said] == [f"{other} gets no work"]
    room = workers.room
    (late,) = cluster.start(1, preload=ANOTHER_NUMBA)
    while len(said) == 1:
        workers.finished(1.0)
    assert said[1].startswith(f"{late} gets no work: it has Numba 0.1.2 instead of ")
    assert workers.room == room
    with Store.without_file() as store:
        run_sweep(plan, store, workers=workers)
        assert csv_of(plan, store) == expected
    assert {task["worker"] for task in cluster.client.get_task_stream()} == {good}


@pytest.mark.exhaustive("starts a cluster and a process for each shard")
def test_three_shards_from_two_kinds_of_machine_are_the_whole(
    cluster: Cluster, expected: str, tmp_path: Path
) -> None:
    cluster.start(1, preload=ANOTHER_MACHINE)
    words = [
        "cliff",
        *(word for each in VARY for word in ("--vary", each)),
        "--runs",
        "12",
        "--episodes",
        "100",
    ]
    stores = [tmp_path / f"{number}.sqlite" for number in (1, 2, 3)]
    for number, store in enumerate(stores, start=1):
        own = ["--shard", f"{number}/3", "--store", str(store)]
        there = ["--dask", cluster.address] if number < 3 else []
        result = CliRunner().invoke(command, [*words, *own, *there])
        assert result.exit_code == 0, result.output
    whole = tmp_path / "whole.sqlite"
    merge(whole, stores)
    again = CliRunner().invoke(
        command, [*words, "--store", str(whole), "--no-again", "--csv", str(tmp_path / "csv")]
    )
    assert again.exit_code == 0, again.output
    assert (tmp_path / "csv").read_bytes() == expected.encode()
    with Store.to_read(whole) as store:
        machines = [
            json.loads(machine) for cell in store.cells() for machine, _ in store.rows_by_machine(cell.key)
        ]
    assert len(machines) == 120
    assert 0 < sum(machine["machine"] == "abacus" for machine in machines) < 120


@pytest.mark.exhaustive("starts two clusters")
def test_what_is_finished_stays_when_the_scheduler_goes_and_the_rest_can_follow(
    tmp_path: Path, plan: SweepPlan, expected: str
) -> None:
    with Cluster(tmp_path) as cluster, Store.without_file() as store:
        (worker,) = cluster.start(1)
        gone = OnceHeld(cluster, worker, 20, lambda _: cluster.kill_scheduler())
        with pytest.raises(UserError, match=f"^{cluster.address}: the scheduler is gone; .* continue"):
            run_sweep(plan, store, workers=DaskWorkers(cluster.address), on_progress=gone)
        assert 20 <= store.count() < 120
        run_sweep(plan, store)
        assert csv_of(plan, store) == expected


def test_a_sweep_that_is_interrupted_leaves_its_workers_free(cluster: Cluster) -> None:
    cluster.start(1)
    endless = plan_of("cliff", "alpha=0.1,0.2,0.3", episodes=10**9, runs=1)

    def interrupt(progress: SweepProgress) -> None:
        if any(cluster.client.processing().values()):
            raise KeyboardInterrupt

    with Store.without_file() as store, pytest.raises(KeyboardInterrupt):
        run_sweep(endless, store, workers=DaskWorkers(cluster.address), on_progress=interrupt)
    assert cluster.client.submit(pow, 2, 5).result(timeout=30) == 32


def test_a_cluster_without_workers_is_a_line(cluster: Cluster) -> None:
    said: list[str] = []
    with pytest.raises(UserError, match=f"^{cluster.address}: .* no workers; start some: dask worker"):
        DaskWorkers(cluster.address, patience=0.5, tell=said.append)
    assert said == [f"{cluster.address}: no workers; waiting 0.5 s for one"]


@pytest.mark.exhaustive("starts workers late")
def test_workers_are_waited_for(cluster: Cluster, plan: SweepPlan, expected: str) -> None:
    gone = list[SweepProgress]()

    def lose(progress: SweepProgress) -> None:
        if not gone and progress.done >= plan.runs:
            gone.append(progress)
            cluster.kill(cluster.workers[0])

    with Store.without_file() as store:
        # start one after each report that there is none: at first, and after one has gone
        workers = DaskWorkers(cluster.address, tell=lambda _: cluster.start(1))
        run_sweep(plan, store, workers=workers, on_progress=lose)
        assert csv_of(plan, store) == expected
    assert (len(cluster.workers), cluster.dead()) == (1, 1)


@pytest.mark.exhaustive("stops workers")
def test_a_worker_that_does_not_answer_gets_nothing(
    cluster: Cluster, monkeypatch: pytest.MonkeyPatch, plan: SweepPlan, expected: str
) -> None:
    monkeypatch.setattr(connection, "LONGEST_LOOK", 2.0)
    silent, _ = cluster.start(2)
    cluster.hold(silent)
    said: list[str] = []
    with Store.without_file() as store:
        run_sweep(plan, store, workers=DaskWorkers(cluster.address, tell=said.append))
        assert csv_of(plan, store) == expected
    assert said == [f"{silent} gets no work: it does not answer"]


def test_no_scheduler_is_a_line() -> None:
    with socket.create_server(("127.0.0.1", 0)) as silent:
        address = f"tcp://127.0.0.1:{silent.getsockname()[1]}"
        with pytest.raises(UserError, match=f"^{address}: no Dask scheduler answers"):
            DaskWorkers(address, patience=0.5)
    with pytest.raises(UserError, match=f"^{address}: no Dask scheduler answers"):
        DaskWorkers(address, patience=0.5)


def test_a_worker_is_no_scheduler(cluster: Cluster) -> None:
    (worker,) = cluster.start(1)
    with pytest.raises(UserError, match=f"^{worker} is a Dask worker; give the address of its scheduler"):
        DaskWorkers(worker)
