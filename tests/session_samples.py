"""Records for the tests of sessions."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from hypothesis import strategies as st
from recipes import recipe

from rl_tui.agents.catalogue import SWEEP_PHASES
from rl_tui.agents.hyperparameters import PARAMETERS
from rl_tui.live.pace.until import Breakpoints
from rl_tui.live.record import Record
from rl_tui.runs.recipe import (
    Change,
    JournalEntry,
    OrderSweep,
    Recipe,
    SetParameter,
    SwitchAlgorithm,
    TakeAction,
)
from rl_tui.runs.timeline.branches import FIRST, Branch, RunRecord

NAMES = st.text(st.characters(exclude_categories=("C", "Z")), min_size=1, max_size=20)


def fresh(made_from: Recipe, speed: float | None = 10.0) -> Record:
    return Record((RunRecord(made_from, (FIRST,)),), speed=speed)


def after(record: Record, step: int, *changes: tuple[int, Change]) -> Record:
    lane = record.lanes[0]
    journal = tuple(JournalEntry(at, change) for at, change in changes)
    branch = replace(lane.branches[0], end=step, here=step, journal=journal)
    return replace(record, lanes=(replace(lane, branches=(branch,)),))


def _values(name: str) -> st.SearchStrategy[float | str]:
    parameter = PARAMETERS[name]
    choices: list[st.SearchStrategy[Any]] = [st.sampled_from(parameter.words)] if parameter.words else []
    if parameter.range is not None:
        low, high = parameter.range.low, min(parameter.range.high, 1e6)
        numbers: st.SearchStrategy[Any] = st.floats(low, high, exclude_min=parameter.range.open_low)
        if parameter.whole:
            numbers = st.integers(int(low), int(high))
        choices.append(numbers)
    return st.one_of(choices)


CHANGES: st.SearchStrategy[Change] = st.one_of(
    st.sampled_from(list(PARAMETERS)).flatmap(
        lambda name: st.builds(SetParameter, st.just(name), _values(name))
    ),
    st.builds(SwitchAlgorithm, st.sampled_from(["q-learning", "sarsa", "dyna-q"])),
    st.builds(TakeAction, st.integers(0, 9)),
    st.builds(OrderSweep, st.sampled_from(SWEEP_PHASES)),
)


@st.composite
def branches(draw: st.DrawFn) -> tuple[Branch, ...]:
    made: list[Branch] = []
    for number in range(draw(st.integers(1, 5))):
        parent = None if number == 0 else draw(st.integers(0, number - 1))
        fork = 0 if parent is None else draw(st.integers(0, made[parent].end))
        shared = () if parent is None else tuple(e for e in made[parent].journal if e.step <= fork)
        end = draw(st.integers(fork, 10**15))
        steps = sorted(draw(st.lists(st.integers(fork, end), max_size=4)))
        journal = (*shared, *(JournalEntry(step, draw(CHANGES)) for step in steps))
        here = draw(st.integers(0, end))
        made.append(Branch(draw(NAMES), journal, parent, fork, end, here))
    return tuple(made)


@st.composite
def records(draw: st.DrawFn, scenario: str = "student") -> Record:
    started = recipe(scenario)
    lanes = []
    for _ in range(draw(st.integers(1, 4))):
        hyperparameters = started.hyperparameters
        for name in draw(st.lists(st.sampled_from(list(PARAMETERS)), max_size=3)):
            hyperparameters = hyperparameters.changed(name, draw(_values(name)))
        made_from = replace(
            started,
            seed=draw(st.integers(0, 2**70)),
            algorithm=draw(st.sampled_from(["q-learning", "sarsa"])),
            hyperparameters=hyperparameters,
        )
        grown = draw(branches())
        lanes.append(RunRecord(made_from, grown, draw(st.integers(0, len(grown) - 1))))
    numbers = st.frozensets(st.integers(0, 10), max_size=3)
    return Record(
        tuple(lanes),
        draw(st.integers(0, len(lanes) - 1)),
        Breakpoints(draw(numbers), draw(numbers)),
        draw(st.none() | st.floats(0.1, 1e6)),
        answer_is_hidden=draw(st.sampled_from([None, True, False])),
    )
