"""The way from a record to its document and back."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from datetime import UTC, datetime
from typing import Any

import numpy as np

from rl_tui import __version__
from rl_tui.common.errors import UserError
from rl_tui.live.pace.until import Breakpoints
from rl_tui.live.record import LearnedTable, Record
from rl_tui.live.sessions.document import (
    FORMAT,
    MOST_BRANCHES,
    MOST_DRAWN,
    MOST_ENTRIES,
    MOST_IN_ALL,
    MOST_PAIRS_KEPT,
    VERSION,
    Document,
    StoredLane,
    StoredTable,
    journal_from,
    recipe_from,
    scenario_from,
    stored_journal,
    stored_recipe,
    stored_scenario,
)
from rl_tui.live.sessions.stored_lesson import lesson_from, stored_lesson
from rl_tui.runs.answers.policy_values import DrawnPolicy
from rl_tui.runs.timeline.branches import Branch, RunRecord
from rl_tui.worlds.files.scenario import Scenario


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
        "scenario": stored_scenario(scenario),
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
    lesson = None if record.lesson is None else stored_lesson(record.lesson)
    asked = {"answer_hidden": record.answer_is_hidden, "table": table, "lesson": lesson}
    return fields | {name: value for name, value in asked.items() if value is not None}


def _stored_drawing(drawn: DrawnPolicy) -> list[list[int]]:
    if len(drawn.choices) > MOST_DRAWN:
        raise UserError(f"the drawn policy has more than {MOST_DRAWN:,} choices")
    return [list(choice) for choice in drawn.choices]


def _stored_lane(lane: RunRecord) -> dict[str, Any]:
    if len(lane.branches) > MOST_BRANCHES:
        raise UserError(f"there are more than {MOST_BRANCHES:,} branches")
    return {
        **stored_recipe(lane.recipe),
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
        "journal": stored_journal(branch.journal[shared:]),
    }


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
    scenario = scenario_from(document.scenario)
    lanes = enumerate(document.lanes)
    return Record(
        lanes=tuple(_lane(lane, scenario, f"lanes[{number}]") for number, lane in lanes),
        shown=document.shown,
        breakpoints=Breakpoints(
            frozenset(document.breakpoints.states), frozenset(document.breakpoints.pairs)
        ),
        speed=document.speed,
        answer_is_hidden=document.answer_hidden,
        drawn=DrawnPolicy(tuple(sorted(dict(document.drawn).items()))),
        lesson=None if document.lesson is None else lesson_from(document.lesson),
        table=None if document.table is None else _table(document.table),
    )


def _table(stored: StoredTable) -> LearnedTable:
    q, visits = np.array(stored.q, np.float64), np.array(stored.visits, np.int64)
    return LearnedTable(q, visits, stored.episodes, stored.state)


def _lane(stored: StoredLane, scenario: Scenario, place: str) -> RunRecord:
    """Return the lane that stands at ``place`` in the document."""
    recipe = recipe_from(scenario, stored.algorithm, stored.hyperparameters, stored.seed, place)
    return RunRecord(recipe, tuple(_branches(stored, place)), stored.branch)


def _branches(lane: StoredLane, lane_place: str) -> Iterator[Branch]:
    made: list[Branch] = []
    in_all = 0
    for number, stored in enumerate(lane.branches):
        place = f"{lane_place}.branches[{number}]"
        parent = () if stored.parent is None else made[stored.parent].journal
        if stored.shared > len(parent):
            raise UserError(f"{place}.shared is {stored.shared}; its parent has {len(parent)} changes")
        in_all += stored.shared + len(stored.journal)
        if in_all > MOST_IN_ALL:
            raise UserError(f"{lane_place}: its branches have more than {MOST_IN_ALL:,} changes")
        if max(stored.here, stored.fork) > stored.end:
            raise UserError(f"{place} stands or forks beyond its end, step {stored.end}")
        shared = parent[: stored.shared]
        latest = shared[-1].step if shared else 0
        journal = (*shared, *journal_from(stored.journal, place, stored.end, latest))
        made.append(Branch(stored.name, journal, stored.parent, stored.fork, stored.end, stored.here))
        yield made[-1]
