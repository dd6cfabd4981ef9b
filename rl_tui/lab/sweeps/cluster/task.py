"""What a batch is on its way: the order that is sent to a worker, and the answer that comes back.

All of it is data, so that a worker needs no file of a scenario.
"""

from __future__ import annotations

import pickle
import threading
import time
from collections import OrderedDict
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any, Final

from rl_tui.common.errors import UserError
from rl_tui.common.findings import one_line
from rl_tui.lab.experiments.training import Goal
from rl_tui.lab.run.recipe import Recipe
from rl_tui.lab.sweeps.cell import Cell
from rl_tui.lab.sweeps.cells.content import MOST_WORLDS, WorldContent, Worlds
from rl_tui.lab.sweeps.cluster.versions import difference, versions_here
from rl_tui.lab.sweeps.runs import RunRow, run_rows
from rl_tui.lab.sweeps.storing.machine import this_machine
from rl_tui.worlds.files.scenario import Scenario

HAND_OVER_AFTER: Final = 2.0
"""Seconds after which a worker hands over what it has of a batch: so much a kill costs, or one run."""
_LONGEST_REASON: Final = 300


@dataclass(frozen=True)
class Order:
    """Some seeds of one cell, to be trained on a worker."""

    sweep: str
    """A name of the sweep, by which all of its orders can be broken off."""
    recipe: Recipe
    goal: Goal
    seeds: tuple[int, ...]
    digest: str
    """The digest of the cell's world: what the worker builds has to be the same."""
    versions: Mapping[str, str]
    """The versions that rows have to be made with."""
    modules: tuple[str, ...] = ()
    """Modules that the person who started the sweep allowed environments to import."""


@dataclass(frozen=True)
class Answer:
    """What came of an order: rows of the first of its seeds, or why this worker can make none."""

    rows: tuple[RunRow, ...] = ()
    refusal: str = ""


class BrokenOffError(Exception):
    """Nobody waits for the rows any more."""


class Call:
    """A call, pickled: to unpickle it is to make it.

    So a scheduler passes on bytes, and needs neither rl-tui nor the Python of its workers.
    """

    def __init__(self, function: Callable[..., object], *arguments: object) -> None:
        self._call = function, arguments

    def __reduce__(self) -> tuple[Callable[..., object], tuple[object, ...]]:
        return self._call

    @property
    def pickled(self) -> bytes:
        """It as bytes, for :func:`pickle.loads`."""
        return pickle.dumps(self, protocol=pickle.HIGHEST_PROTOCOL)


def train(order: Order) -> Answer:
    """Train the runs of ``order``, until it has taken a while; at least one. It runs on a worker."""
    said = difference(versions_here(), order.versions)
    if said:
        return Answer(refusal=said)
    try:
        content = _CONTENTS.of(order)
    except UserError as reason:
        said = one_line(str(reason), _LONGEST_REASON)
        return Answer(refusal=f"cannot build the world of {order.recipe.scenario.id}: {said}")
    if content.digest != order.digest:
        return Answer(
            refusal=f"builds another world of {order.recipe.scenario.id}: another version of the environment?"
        )
    recipe = replace(order.recipe, scenario=content.scenario)
    return Answer(_rows(Cell(0, {}, recipe, order.goal, content), order))


def break_off(sweep: str) -> None:
    """End the orders of ``sweep`` that run in this process, soon."""
    _BROKEN_OFF.add(sweep)


def _rows(cell: Cell, order: Order) -> tuple[RunRow, ...]:
    def check() -> None:
        if order.sweep in _BROKEN_OFF:
            raise BrokenOffError(order.sweep)

    end = time.monotonic() + HAND_OVER_AFTER
    rows = list[RunRow]()
    with suppress(BrokenOffError):
        for row in run_rows(cell, order.seeds, check):
            rows.append(replace(row, machine=this_machine()))
            if time.monotonic() >= end:
                break
    return tuple(rows)


class _Contents:
    """The worlds that orders asked this process for; the orders' own copies of a scenario are many."""

    def __init__(self) -> None:
        self._scenarios = OrderedDict[str, Scenario]()
        self._worlds = Worlds()
        self._lock = threading.Lock()

    def of(self, order: Order) -> WorldContent:
        """Return the world of ``order``. Raises UserError where it cannot be built here."""
        with self._lock:
            scenario = self._scenarios.setdefault(order.digest, order.recipe.scenario)
            self._scenarios.move_to_end(order.digest)
            if len(self._scenarios) > MOST_WORLDS:
                self._scenarios.popitem(last=False)
        allow(order.modules)
        return self._worlds.of(scenario, {}, order.recipe.seed)


def allow(modules: tuple[str, ...]) -> None:
    """Let environments import ``modules``. Raises UserError where this process never imports any."""
    if modules:
        from rl_tui.worlds.gym.modules import allow_module

        for name in modules:
            allow_module(name)


def order_of(cell: Cell, seeds: tuple[int, ...], sweep: str, versions: Mapping[str, str]) -> Order:
    """Return the order for ``seeds`` of ``cell``."""
    return Order(
        sweep, cell.recipe, cell.goal, seeds, cell.content.digest, versions, tuple(sorted(_allowed_modules()))
    )


def _allowed_modules() -> set[str]:
    from rl_tui.worlds.gym.modules import ALLOWED

    return ALLOWED


_CONTENTS: Final[Any] = _Contents()
_BROKEN_OFF: Final = set[str]()
