"""The way from a record to its document and back."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np

from rl_tui import __version__
from rl_tui.agents.catalogue import BY_ID
from rl_tui.agents.hyperparameters import PARAMETERS, Hyperparameters
from rl_tui.common.errors import UserError
from rl_tui.common.findings import near, shown
from rl_tui.lab.answers.drawn_policy import DrawnPolicy
from rl_tui.lab.live.record import LearnedTable, Record
from rl_tui.lab.live.until import Breakpoints
from rl_tui.lab.run.recipe import (
    Change,
    JournalEntry,
    OrderSweep,
    Recipe,
    SetParameter,
    SwitchAlgorithm,
    TakeAction,
)
from rl_tui.lab.sessions.document import (
    FORMAT,
    MOST_BRANCHES,
    MOST_DRAWN,
    MOST_ENTRIES,
    MOST_IN_ALL,
    MOST_PAIRS_KEPT,
    VERSION,
    Document,
    Entry,
    StoredBranch,
    StoredLane,
    StoredScenario,
    StoredTable,
)
from rl_tui.lab.timeline.branches import Branch, RunRecord
from rl_tui.worlds.files.gymnasium_ids import PREFIX, environment_scenario
from rl_tui.worlds.files.scenario import Scenario, scenario_of


def document_of(record: Record, *, title: str, kept: bool, digest: str) -> dict[str, Any]:
    """Return ``record`` as JSON, saved now.

    ``digest`` is that of Q where the lane shown stands, empty where it is not known. Raises UserError where
    it is larger than what is read again.
    """
    scenario = record.lanes[0].recipe.scenario
    fields = {
        "format": FORMAT,
        "version": VERSION,
        "program": __version__,
        "title": title,
        "kept": kept,
        "saved": datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ"),
        "scenario": _stored_scenario(scenario),
        "lanes": [_stored_lane(lane) for lane in record.lanes],
        "shown": record.shown,
        "breakpoints": {
            "states": sorted(record.breakpoints.states),
            "pairs": sorted(record.breakpoints.pairs),
        },
        "speed": record.speed,
        "digest": digest,
    }
    if record.drawn.choices:
        fields["drawn"] = _stored_drawing(record.drawn)
    table = None if record.table is None else _stored_table(record.table)
    asked = {"answer_hidden": record.answer_is_hidden, "table": table}
    return fields | {name: value for name, value in asked.items() if value is not None}


def _stored_drawing(drawn: DrawnPolicy) -> list[list[int]]:
    if len(drawn.choices) > MOST_DRAWN:
        raise UserError(f"the drawn policy has more than {MOST_DRAWN:,} choices")
    return [list(choice) for choice in drawn.choices]


def _stored_scenario(scenario: Scenario) -> dict[str, str]:
    if scenario.id.startswith(PREFIX):
        return {"id": scenario.id, "kind": "gymnasium", "title": scenario.title}
    if not scenario.text:
        raise UserError(f"the file of scenario {scenario.id} is not known")
    return {"id": scenario.id, "kind": "file", "title": scenario.title, "text": scenario.text}


def _stored_lane(lane: RunRecord) -> dict[str, Any]:
    if len(lane.branches) > MOST_BRANCHES:
        raise UserError(f"there are more than {MOST_BRANCHES:,} branches")
    return {
        "seed": lane.recipe.seed,
        "algorithm": lane.recipe.algorithm,
        "hyperparameters": lane.recipe.hyperparameters.as_dict(),
        "branches": [_stored_branch(branch, lane.branches) for branch in lane.branches],
        "branch": lane.branch,
    }


def _stored_branch(branch: Branch, branches: Sequence[Branch]) -> dict[str, Any]:
    shared = 0
    if branch.parent is not None:
        for own, of_parent in zip(branch.journal, branches[branch.parent].journal, strict=False):
            if own != of_parent:
                break
            shared += 1
    if len(branch.journal) > MOST_ENTRIES:
        raise UserError(f"there are more than {MOST_ENTRIES:,} changes")
    return {
        "name": branch.name,
        "parent": branch.parent,
        "fork": branch.fork,
        "end": branch.end,
        "here": branch.here,
        "shared": shared,
        "journal": [_stored_entry(entry) for entry in branch.journal[shared:]],
    }


def _stored_entry(entry: JournalEntry) -> dict[str, Any]:
    match entry.change:
        case SetParameter(name, value):
            return {"step": entry.step, "set": name, "to": value}
        case SwitchAlgorithm(algorithm):
            return {"step": entry.step, "algorithm": algorithm}
        case TakeAction(action):  # its number: names are known only where the world is built
            return {"step": entry.step, "take": action}
        case OrderSweep(phase):
            return {"step": entry.step, "sweep": phase}


def _stored_table(table: LearnedTable) -> dict[str, Any] | None:
    """Return ``table`` as JSON; None where it is large, or holds what JSON has no number for."""
    if len(table.q) > MOST_PAIRS_KEPT or not np.isfinite(table.q).all():
        return None
    return {
        "q": table.q.tolist(),
        "visits": table.visits.tolist(),
        "episodes": table.episodes,
        "state": table.state,
    }


# To a record


def record_of(document: Document) -> Record:
    """Return what ``document`` says. Raises UserError, in one line, where its parts do not fit together."""
    lanes = [_Lane(lane, f"lanes[{number}]") for number, lane in enumerate(document.lanes)]
    scenario = _scenario(document.scenario)
    return Record(
        lanes=tuple(lane.record(scenario) for lane in lanes),
        shown=document.shown,
        breakpoints=Breakpoints(
            frozenset(document.breakpoints.states), frozenset(document.breakpoints.pairs)
        ),
        speed=document.speed,
        answer_is_hidden=document.answer_hidden,
        drawn=DrawnPolicy(tuple(sorted(dict(document.drawn).items()))),
        table=None if document.table is None else _table(document.table),
    )


def _table(stored: StoredTable) -> LearnedTable:
    q, visits = np.array(stored.q, np.float64), np.array(stored.visits, np.int64)
    return LearnedTable(q, visits, stored.episodes, stored.state)


def _scenario(stored: StoredScenario) -> Scenario:
    if stored.kind == "gymnasium":
        return environment_scenario(stored.id)
    try:
        return scenario_of(stored.text, Path(f"{stored.id}.toml"), ask_environment=False)
    except UserError as fault:
        raise UserError(f"its scenario cannot be played: {str(fault).splitlines()[0]}") from fault


class _Lane:
    """One lane under examination; ``place`` is where it stands in the document."""

    def __init__(self, stored: StoredLane, place: str) -> None:
        self._stored = stored
        self._place = place

    def record(self, scenario: Scenario) -> RunRecord:
        stored = self._stored
        self._check_algorithm(stored.algorithm, "algorithm")
        hyperparameters = Hyperparameters()
        for name, value in stored.hyperparameters.items():
            hyperparameters = self._changed(hyperparameters, name, value, "hyperparameters")
        recipe = Recipe(scenario, stored.algorithm, hyperparameters, stored.seed)
        return RunRecord(recipe, tuple(self._branches()), stored.branch)

    def _branches(self) -> Iterator[Branch]:
        made: list[Branch] = []
        in_all = 0
        for number, stored in enumerate(self._stored.branches):
            place = f"branches[{number}]"
            parent = () if stored.parent is None else made[stored.parent].journal
            if stored.shared > len(parent):
                raise self._fault(f"{place}.shared is {stored.shared}; its parent has {len(parent)} changes")
            in_all += stored.shared + len(stored.journal)
            if in_all > MOST_IN_ALL:
                raise self._fault(f"its branches have more than {MOST_IN_ALL:,} changes")
            if max(stored.here, stored.fork) > stored.end:
                raise self._fault(f"{place} stands or forks beyond its end, step {stored.end}")
            journal = (*parent[: stored.shared], *self._entries(stored, place))
            self._check_order(journal, stored, place)
            made.append(Branch(stored.name, journal, stored.parent, stored.fork, stored.end, stored.here))
            yield made[-1]

    def _entries(self, stored: StoredBranch, place: str) -> Iterator[JournalEntry]:
        for number, entry in enumerate(stored.journal):
            yield JournalEntry(entry.step, self._change(entry, f"{place}.journal[{number}]"))

    def _change(self, entry: Entry, place: str) -> Change:
        kinds = [key for key in ("set", "algorithm", "take", "sweep") if getattr(entry, key) is not None]
        if len(kinds) != 1 or (entry.to is None) == (entry.set is not None):
            raise self._fault(f"{place} is no change; expected set and to, algorithm, take, or sweep")
        if entry.set is not None and entry.to is not None:
            values = self._changed(Hyperparameters(), entry.set, entry.to, place)
            return SetParameter(entry.set, values.value(entry.set))
        if entry.algorithm is not None:
            self._check_algorithm(entry.algorithm, f"{place}.algorithm")
            return SwitchAlgorithm(entry.algorithm)
        if entry.sweep is not None:
            return OrderSweep(entry.sweep)
        return TakeAction(entry.take or 0)

    def _check_order(self, journal: Sequence[JournalEntry], stored: StoredBranch, place: str) -> None:
        before = 0
        for entry in journal[max(0, stored.shared - 1) :]:
            if not before <= entry.step <= stored.end:
                raise self._fault(f"{place}.journal: step {entry.step} is out of order or beyond its end")
            before = entry.step

    def _check_algorithm(self, algorithm: str, place: str) -> None:
        if algorithm not in BY_ID:
            raise self._fault(f"{place} is {shown(algorithm)}, which is not known{near(algorithm, BY_ID)}")

    def _changed(self, values: Hyperparameters, name: str, value: float | str, place: str) -> Hyperparameters:
        if name not in PARAMETERS:
            raise self._fault(f"{place}: there is no hyper-parameter {shown(name)}{near(name, PARAMETERS)}")
        try:
            return values.changed(name, value)
        except ValueError as fault:
            raise self._fault(f"{place}: {fault}") from fault

    def _fault(self, what: str) -> UserError:
        return UserError(f"{self._place}.{what}")
