"""Results from the store of a sweep: the document of ``sweep --json`` of what it was filled by."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, Final

from rl_tui.common.errors import UserError
from rl_tui.common.text_file import UnreadableError, open_plain
from rl_tui.lab.sweeps.document import best_documents, json_pieces
from rl_tui.lab.sweeps.measures import MEASURES
from rl_tui.lab.sweeps.ranking import standings_of
from rl_tui.lab.sweeps.store import Store
from rl_tui.lab.sweeps.storing.plan_text import read_plan

_HEAD: Final = b"SQLite format 3\0"


def is_store(path: Path) -> bool:
    """Return whether the file is an SQLite database, as stores are; False where it cannot be read."""
    try:
        with open_plain(path, "a store") as file:
            return file.read(len(_HEAD)) == _HEAD
    except (OSError, UnreadableError):
        return False


def document_of(path: Path, measure: str | None) -> Any:
    """Return the document of the sweep that filled the store last; cells compare by ``measure`` if it is one.

    Raises UserError where the file is no store of sweeps, or holds no sweep.
    """
    with Store.to_read(path) as store:
        plans = store.plans()
        if not plans:
            raise UserError(f"{path}: no sweep is in this store; fill it by rl-tui sweep --store {path}")
        plan = read_plan(plans[-1])
        standings = standings_of(plan, store, MEASURES.get(measure or ""))
        bests = best_documents(standings, plan, store, again=False)
        return json.loads("".join(json_pieces(plan, store, standings, bests)))
