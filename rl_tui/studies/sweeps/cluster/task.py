"""Messages to and from workers, as data without files."""

from __future__ import annotations

import pickle
import threading
import time
from collections import OrderedDict
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cache
from typing import Final

from rl_tui.agents.compiling.cache_key import cache_key
from rl_tui.common.errors import UserError
from rl_tui.common.findings import one_line
from rl_tui.runs.recipe import Recipe
from rl_tui.runs.training.seeded_runs import Goal
from rl_tui.studies.sweeps.cell import Cell
from rl_tui.studies.sweeps.cells.content import MOST_WORLDS, WorldContent, Worlds
from rl_tui.studies.sweeps.cluster.versions import difference, versions_here
from rl_tui.studies.sweeps.machine import this_machine
from rl_tui.studies.sweeps.runs import RunRow, run_rows
from rl_tui.worlds.files.scenario import Scenario

HAND_OVER_AFTER: Final = 2.0
"""Seconds after which a worker delivers its rows, which limits the loss if it is killed."""
_LONGEST_REASON: Final = 300


@dataclass(frozen=True)
class OrderPart:
    """Some seeds of one cell."""

    recipe: Recipe
    goal: Goal
    digest: str
    """Digest that the worker's world must have."""
    seeds: tuple[int, ...]


@dataclass(frozen=True)
class Order:
    """A unit of work for a worker."""

    sweep: str
    """Name of the sweep, to cancel all its orders."""
    parts: tuple[OrderPart, ...]
    versions: Mapping[str, str]
    """Versions that the rows require."""
    kernels: str
    """Digest of the kernels, which differ between development versions."""
    modules: tuple[str, ...] = ()
    """Modules that environments may import, allowed by the user."""


@dataclass(frozen=True)
class TaskAnswer:
    """Rows of the first seeds of the first parts of an order.

    `refusal` is the reason why this worker cannot do the rest. Without one, time ran out.
    """

    rows: tuple[tuple[RunRow, ...], ...] = ()
    refusal: str = ""
    seconds: float = 0.0


class TaskEndedError(Exception):
    """The rows are no longer needed."""


class RefusedError(Exception):
    """The requested rows cannot be made in this process."""


class Call:
    """A pickled call that is made when it is unpickled.

    A scheduler thus needs neither rl-tui nor the workers' Python version.
    """

    def __init__(self, function: Callable[..., object], *arguments: object) -> None:
        self._call = function, arguments

    def __reduce__(self) -> tuple[Callable[..., object], tuple[object, ...]]:
        return self._call

    @property
    def pickled(self) -> bytes:
        """Bytes for `pickle.loads`."""
        return pickle.dumps(self, protocol=pickle.HIGHEST_PROTOCOL)


def order_of(parts: Iterable[tuple[Cell, tuple[int, ...]]], sweep: str, versions: Mapping[str, str]) -> Order:
    """Return the order for some seeds of some cells."""
    from rl_tui.worlds.gym.modules import ALLOWED

    wanted = tuple(OrderPart(cell.recipe, cell.goal, cell.content.digest, seeds) for cell, seeds in parts)
    return Order(sweep, wanted, versions, _kernels(), tuple(sorted(ALLOWED)))


def train(order: Order) -> TaskAnswer:
    """Train the runs of `order`, at least one, until the time limit."""
    start = time.monotonic()
    rows: list[tuple[RunRow, ...]] = []
    try:
        if said := difference(versions_here(), order.versions):
            raise RefusedError(said)
        if order.kernels != _kernels():
            raise RefusedError("has another version of the kernels of rl-tui")
        for part in order.parts:
            rows.append(_rows(_cell(part, order.modules), part.seeds, order.sweep, start + HAND_OVER_AFTER))
            if len(rows[-1]) < len(part.seeds) or time.monotonic() - start >= HAND_OVER_AFTER:
                break
    except RefusedError as refusal:
        return TaskAnswer(tuple(rows), str(refusal))
    return TaskAnswer(tuple(rows), seconds=time.monotonic() - start)


def break_off(sweep: str) -> None:
    """Cancel the orders of `sweep` in this process."""
    _BROKEN_OFF.add(sweep)


@cache
def _kernels() -> str:
    return cache_key()


def _cell(part: OrderPart, modules: tuple[str, ...]) -> Cell:
    name = part.recipe.scenario.id
    try:
        content = _CONTENTS.of(part, modules)
    except UserError as reason:
        said = one_line(str(reason), _LONGEST_REASON)
        raise RefusedError(f"cannot build the world of {name}: {said}") from reason
    if content.digest != part.digest:
        raise RefusedError(f"builds a different {name}: its version of the environment may differ")
    return Cell(0, {}, replace(part.recipe, scenario=content.scenario), part.goal, content)


def _rows(cell: Cell, seeds: tuple[int, ...], sweep: str, end: float) -> tuple[RunRow, ...]:
    """Return the rows of `seeds`, or of the first ones (at least one) before `end`."""

    def check() -> None:
        if sweep in _BROKEN_OFF:
            raise TaskEndedError

    rows = list[RunRow]()
    with suppress(TaskEndedError):
        for row in run_rows(cell, seeds, check):
            rows.append(replace(row, machine=this_machine()))
            if time.monotonic() >= end:
                break
    return tuple(rows)


class _Contents:
    """A cache of worlds. Orders have many copies of a scenario."""

    def __init__(self) -> None:
        self._scenarios = OrderedDict[str, Scenario]()
        self._worlds = Worlds()
        self._lock = threading.Lock()

    def of(self, part: OrderPart, modules: tuple[str, ...]) -> WorldContent:
        with self._lock:
            scenario = self._scenarios.setdefault(part.digest, part.recipe.scenario)
            self._scenarios.move_to_end(part.digest)
            if len(self._scenarios) > MOST_WORLDS:
                self._scenarios.popitem(last=False)
        if modules:
            from rl_tui.worlds.gym.modules import allow_module

            for name in modules:
                allow_module(name)
        return self._worlds.of(scenario, {}, part.recipe.seed)


_CONTENTS: Final = _Contents()
_BROKEN_OFF: Final = set[str]()
