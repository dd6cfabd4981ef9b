"""The orders for the workers of a cluster."""

from __future__ import annotations

import json
import math
import pickle
from dataclasses import replace
from pathlib import Path
from typing import NoReturn

import pytest
from plans import cell_of, plan_of

from rl_tui.runs.library import find
from rl_tui.studies.sweeps import machine
from rl_tui.studies.sweeps.cell import Cell
from rl_tui.studies.sweeps.cluster import task
from rl_tui.studies.sweeps.cluster.task import Call, Order, TaskAnswer, break_off, order_of, train
from rl_tui.studies.sweeps.cluster.versions import PYTHON, difference, versions_here
from rl_tui.studies.sweeps.machine import this_machine
from rl_tui.studies.sweeps.runs import run_rows
from rl_tui.worlds.gym.section import GymnasiumSection
from rl_tui.worlds.sections.schema import WorldRefusedError

CELLS = {
    "a map": ("maze", "alpha=0.5"),
    "a map of another noise": ("windy", "world.noise=0.2"),
    "a map that is drawn": ("maze", "scenario=frozenlake-random"),
    "arms that drift": ("bandit", "world.drift=0.1"),
    "an environment that is stepped": ("gym:Blackjack-v1", "world.table=false"),
}


@pytest.fixture(autouse=True)
def _takes_its_time(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let a worker return everything at once, however long it takes. A test may override this."""
    monkeypatch.setattr(task, "HAND_OVER_AFTER", math.inf)


def order(*cells: Cell, sweep: str = "one") -> Order:
    return order_of([(cell, (3, 4)) for cell in cells], sweep, versions_here())


def with_digest(wanted: Order, digest: str) -> Order:
    return replace(wanted, parts=(*wanted.parts[:-1], replace(wanted.parts[-1], digest=digest)))


def sent(call: Call) -> TaskAnswer:
    answer = pickle.loads(call.pickled)
    assert isinstance(answer, TaskAnswer)
    return answer


@pytest.mark.parametrize("words", CELLS.values(), ids=CELLS)
def test_a_worker_makes_the_rows_that_are_made_here(words: tuple[str, str]) -> None:
    cell = cell_of(*words)
    answer = sent(Call(train, order(cell)))
    assert answer.refusal == ""
    (rows,) = answer.rows
    assert [(row.seed, row.figures) for row in rows] == [
        (row.seed, row.figures) for row in run_rows(cell, (3, 4))
    ]
    assert {row.machine for row in rows} == {this_machine()}


def test_a_worker_needs_no_file(tmp_path: Path) -> None:
    file = tmp_path / "mine.toml"
    file.write_text(find("maze").text)
    call = Call(train, order(cell_of(str(file), "alpha=0.5")))
    text = call.pickled
    file.unlink()
    assert len(pickle.loads(text).rows[0]) == 2


def test_a_scheduler_needs_no_rl_tui_to_pass_it_on() -> None:
    passed_on = pickle.dumps((pickle.loads, Call(train, order(cell_of("maze", "alpha=0.5"))).pickled))
    function, blob = pickle.loads(passed_on)
    assert function is pickle.loads
    assert type(blob) is bytes


@pytest.mark.parametrize(
    ("name", "theirs", "said"),
    [
        ("numba", "0.1", "has Numba 0.1 instead of {}"),
        ("rl-tui", "", "has no rl-tui instead of {}"),
        (PYTHON, "3.1", "has Python 3.1 instead of {}"),
    ],
)
def test_a_worker_of_another_version_makes_none(
    name: str, theirs: str, said: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    ours = versions_here()
    monkeypatch.setattr(task, "versions_here", lambda: ours | {name: theirs})
    assert train(order(cell_of("maze", "alpha=0.5"))) == TaskAnswer(refusal=said.format(ours[name]))


def test_versions_that_are_alike_are_no_difference() -> None:
    assert all(versions_here().values())
    assert difference(versions_here(), versions_here()) == ""


def test_a_worker_with_other_kernels_makes_none() -> None:
    other = replace(order(cell_of("maze", "alpha=0.5")), kernels="others")
    assert "has another version of the kernels of rl-tui" in train(other).refusal


def test_a_worker_with_another_world_makes_none() -> None:
    maze = cell_of("maze", "alpha=0.5")
    answer = train(with_digest(order(maze, maze), "0" * 64))
    assert "a different maze" in answer.refusal
    assert [len(rows) for rows in answer.rows] == [2], "what it could make is handed over"


def test_a_worker_that_cannot_build_the_world_makes_none(monkeypatch: pytest.MonkeyPatch) -> None:
    wanted = with_digest(order(cell_of("gym:Blackjack-v1", "world.table=false")), "1" * 64)

    def refused(section: GymnasiumSection, generator: object) -> NoReturn:
        raise WorldRefusedError(("id",), "an environment that is not here", "one that is")

    monkeypatch.setattr(GymnasiumSection, "build", refused)
    assert "cannot build the world of gym:Blackjack-v1: " in train(wanted).refusal


def test_long_batches_are_handed_over_in_parts(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(task, "HAND_OVER_AFTER", 0.0)
    maze = cell_of("maze", "alpha=0.5")
    assert [[row.seed for row in rows] for rows in train(order(maze, maze)).rows] == [[3]]


def test_a_sweep_that_is_broken_off_is_trained_no_further() -> None:
    cell = plan_of("maze", "alpha=0.5", episodes=10**12).cell(0)
    assert isinstance(cell, Cell)
    break_off("given up")
    assert train(order(cell, sweep="given up")).rows == ((),)
    assert len(train(order(cell_of("maze", "alpha=0.5"), sweep="another")).rows[0]) == 2


@pytest.mark.parametrize(
    ("said", "processor"),
    [
        (
            "processor : 0\nmodel name\t: an engine: 2\n\nprocessor : 1\nmodel name : another\n",
            "an engine: 2",
        ),
        ("CPU implementer\t: 0x41\nCPU part\t: 0xd0c\n", "0xd0c"),
        ("nothing\n", ""),
    ],
)
def test_a_row_says_on_what_it_was_made(
    said: str, processor: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "processors").write_text(said)
    monkeypatch.setattr(machine, "PROCESSORS", tmp_path / "processors")
    monkeypatch.setattr("platform.libc_ver", lambda: ("glibc", "2.99"))
    this_machine.cache_clear()
    found = json.loads(this_machine())
    this_machine.cache_clear()
    assert (found["libc"], found["processor"]) == ("glibc 2.99", processor)
