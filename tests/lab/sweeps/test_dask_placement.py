"""Which batch goes where on a cluster, and who is to blame when workers die."""

from __future__ import annotations

import pytest
from plans import cell_of

from rl_tui.lab.sweeps.cluster.placement import AHEAD, MOST_KILLED, Job, Placement
from rl_tui.lab.sweeps.sweep import Batch


@pytest.fixture(scope="module")
def batch() -> Batch:
    return Batch(cell_of("maze", "alpha=0.5"), (0, 1, 2, 3))


def placement_of(**threads: int) -> Placement:
    placement = Placement()
    for address, number in threads.items():
        placement.come(address, number)
    return placement


def jobs(batch: Batch, number: int) -> list[Job]:
    return [Job(batch, batch.seeds) for _ in range(number)]


def start(placement: Placement, *waiting: Job) -> dict[Job, str]:
    for job in waiting:
        placement.add(job)
    return dict(placement.starts())


def test_each_worker_has_what_its_threads_can_do_and_a_little_more(batch: Batch) -> None:
    placement = placement_of(small=1, large=3)
    assert placement.room == 4 * AHEAD
    started = start(placement, *jobs(batch, 20))
    where = list(started.values())
    assert (where.count("small"), where.count("large")) == (AHEAD, 3 * AHEAD)
    assert placement.room == 0
    assert not dict(placement.starts())
    first, *_ = started
    assert placement.done(first, started[first])
    assert list(dict(placement.starts()).values()) == [started[first]]


def test_work_is_shared_out_evenly(batch: Batch) -> None:
    started = start(placement_of(first=2, second=2), *jobs(batch, 4))
    assert sorted(started.values()) == ["first", "first", "second", "second"]


def test_what_a_dead_worker_had_goes_out_again_seed_by_seed(batch: Batch) -> None:
    placement = placement_of(first=1)
    start(placement, *jobs(batch, 1))
    assert placement.leave("first") == []
    placement.come("second", 8)
    again = start(placement)
    assert sorted(job.seeds for job in again) == [(0,), (1,), (2,), (3,)]
    assert {job.killed for job in again} == {1}


def test_what_a_worker_had_that_said_goodbye_is_not_to_blame(batch: Batch) -> None:
    placement = placement_of(first=1)
    (job,) = start(placement, *jobs(batch, 1))
    assert placement.leave("first", innocent=[job]) == []
    placement.come("second", 1)
    assert start(placement) == {job: "second"}


def test_a_result_from_a_worker_that_was_given_up_counts_no_more(batch: Batch) -> None:
    placement = placement_of(first=1)
    (job,) = start(placement, *jobs(batch, 1))
    placement.leave("first")
    assert not placement.done(job, "first")


def test_a_suspect_is_alone_on_its_worker_and_others_wait_or_go_elsewhere(batch: Batch) -> None:
    placement = placement_of(first=2, second=2)
    busy = start(placement, *jobs(batch, 3))
    suspect = Job(batch, (7,), killed=MOST_KILLED - 1)
    rest = start(placement, suspect, *jobs(batch, 4))
    assert suspect not in rest
    (kept_free,) = {"first", "second"} - set(rest.values())
    for job, address in busy.items():
        if address == kept_free:
            placement.done(job, address)
    alone = start(placement)
    assert alone == {suspect: kept_free}
    assert kept_free not in start(placement, *jobs(batch, 2)).values()
    placement.done(suspect, kept_free)
    assert kept_free in start(placement).values()


def test_one_that_kills_has_failed_at_the_third_worker_whatever_was_beside_it(batch: Batch) -> None:
    deadly, placement, deaths, failed = 2, Placement(), 0, list[Job]()
    for job in jobs(batch, 3):
        placement.add(job)
    finished = dict.fromkeys(batch.seeds, 0)
    running: dict[Job, str] = {}
    while not failed:
        placement.come(f"worker {deaths}", 1)
        running |= dict(placement.starts())
        while not any(deadly in job.seeds for job in running):
            job, address = running.popitem()
            placement.done(job, address)
            for seed in job.seeds:
                finished[seed] += 1
            running |= dict(placement.starts())
        failed = placement.leave(f"worker {deaths}")
        running.clear()
        deaths += 1
    assert [(job.seeds, job.killed) for job in failed] == [((deadly,), MOST_KILLED)]
    # the three batches had it each: so many workers it takes for the first of them to fail, and no more
    assert deaths <= 3 * MOST_KILLED


def test_who_was_not_alone_has_not_failed_however_often_it_was_blamed(batch: Batch) -> None:
    placement = placement_of(first=1)
    for job, address in start(placement, Job(batch, (0,)), Job(batch, (1,))).items():
        placement.done(job, address)
        assert placement.killed(job, times=4) == []
    assert len(start(placement)) == 1
