"""The placement of batches on a cluster."""

from __future__ import annotations

import pytest
from plans import cell_of

from rl_tui.studies.sweeps.cluster.dask_workers import (
    AHEAD,
    MOST_KILLED,
    USUAL_TIME,
    BatchPart,
    Job,
    Placement,
)
from rl_tui.studies.sweeps.sweep import Batch


@pytest.fixture(scope="module")
def batch() -> Batch:
    return Batch(cell_of("maze", "alpha=0.5"), tuple(range(20)))


def placement_of(**threads: int) -> Placement:
    placement = Placement()
    for address, number in threads.items():
        placement.come(address, number)
    return placement


def start(placement: Placement, *waiting: Batch | Job) -> dict[Job, str]:
    for each in waiting:
        if isinstance(each, Job):
            placement.add_again(each)
        else:
            placement.add(each)
    return dict(placement.starts())


def run(batch: Batch, *seeds: int, killed: int = 0) -> Job:
    return Job((BatchPart(batch, seeds),), killed)


def seeds_of(jobs: dict[Job, str]) -> list[int]:
    return sorted(seed for job in jobs for part in job.parts for seed in part.seeds)


def test_each_worker_has_what_its_threads_can_do_and_a_little_more(batch: Batch) -> None:
    placement = placement_of(small=1, large=3)
    assert placement.room == 4 * AHEAD
    started = start(placement, *[batch] * 20)
    where = list(started.values())
    assert (where.count("small"), where.count("large")) == (AHEAD, 3 * AHEAD)
    assert placement.room == 0
    assert not dict(placement.starts())
    first, *_ = started
    assert placement.done(first, started[first])
    assert list(dict(placement.starts()).values()) == [started[first]]


def test_work_is_shared_out_evenly(batch: Batch) -> None:
    started = start(placement_of(first=2, second=2), *[batch] * 4)
    assert sorted(started.values()) == ["first", "first", "second", "second"]


def test_short_batches_go_together_and_long_ones_alone(batch: Batch) -> None:
    placement = placement_of(only=1)
    for _ in range(50):
        placement.took(1, USUAL_TIME / 10)
    assert 9 * AHEAD <= placement.room <= 10 * AHEAD
    assert {len(job.parts) for job in start(placement, *[batch] * 100)} <= {9, 10}
    assert placement.room == 0
    for _ in range(50):
        placement.took(9, 100 * USUAL_TIME)
    placement.leave("only", innocent=[])
    placement.come("another", 3)
    assert {len(job.parts) for job in start(placement)} == {1}


def test_no_place_is_left_empty_for_the_sake_of_a_large_bundle(batch: Batch) -> None:
    placement = placement_of(first=1, second=1)
    placement.took(1, USUAL_TIME / 200)
    started = start(placement, *[batch] * 2 * AHEAD)
    assert [len(job.parts) for job in started] == [1] * 2 * AHEAD


def test_what_a_dead_worker_had_goes_out_again_in_pieces_and_then_run_by_run(batch: Batch) -> None:
    placement = placement_of(first=1)
    start(placement, batch)
    assert placement.leave("first") == []
    placement.come("second", 8)
    pieces = start(placement)
    assert 1 < len(pieces) < len(batch.seeds)
    assert seeds_of(pieces) == list(batch.seeds)
    assert not any(job.alone for job in pieces)
    assert placement.leave("second") == []
    found: dict[Job, str] = {}
    while len(found) < len(batch.seeds):
        placement.come(f"one {len(found)}", 8)
        started = start(placement)
        assert len(started) == 1
        assert all(job.alone for job in started)
        found |= started
    assert seeds_of(found) == list(batch.seeds)


def test_what_a_worker_had_that_said_goodbye_is_not_to_blame(batch: Batch) -> None:
    placement = placement_of(first=1)
    (job,) = start(placement, batch)
    assert placement.leave("first", innocent=[job]) == []
    placement.come("second", 1)
    assert start(placement) == {job: "second"}


def test_a_result_from_a_worker_that_was_given_up_counts_no_more(batch: Batch) -> None:
    placement = placement_of(first=1)
    (job,) = start(placement, batch)
    placement.leave("first")
    assert not placement.done(job, "first")


def test_a_suspect_is_alone_on_its_worker_and_others_wait_or_go_elsewhere(batch: Batch) -> None:
    placement = placement_of(first=2, second=2)
    busy = start(placement, *[batch] * 3)
    suspect = run(batch, 7, killed=MOST_KILLED - 1)
    rest = start(placement, suspect, *[batch] * 4)
    assert suspect not in rest
    (kept_free,) = {"first", "second"} - set(rest.values())
    for job, address in busy.items():
        if address == kept_free:
            placement.done(job, address)
    alone = start(placement)
    assert alone == {suspect: kept_free}
    assert kept_free not in start(placement, batch, batch).values()
    placement.done(suspect, kept_free)
    assert kept_free in start(placement).values()


def test_one_that_kills_has_failed_at_its_third_worker_whatever_was_beside_it(batch: Batch) -> None:
    deadly, deaths, failed, finished = 11, 0, list[BatchPart](), list[int]()
    others = Batch(batch.cell, tuple(range(100, 120)))
    placement = placement_of(first=1)
    running = start(placement, others, batch, others)
    while running:
        job, address = next(iter(running.items()))  # a thread takes them in sequence
        if deadly in seeds_of({job: address}):
            deaths += 1
            failed += placement.leave(address)
            placement.come(f"another {deaths}", 1)
            running.clear()
        else:
            finished += seeds_of({job: running.pop(job)})
            placement.done(job, address)
        running |= dict(placement.starts())
    assert (failed, deaths) == ([BatchPart(batch, (deadly,))], MOST_KILLED)
    assert sorted(finished) == sorted({*batch.seeds} - {deadly}) + sorted(2 * others.seeds)


def test_who_was_not_alone_has_not_failed_however_often_it_was_blamed(batch: Batch) -> None:
    placement = placement_of(first=1)
    for job, address in start(placement, run(batch, 0), run(batch, 1)).items():
        placement.done(job, address)
        assert placement.killed(job, times=4) == []
    assert len(start(placement)) == 1
