"""What the process of an atlas sends, line by line: what is new, as JSON; and the atlas that it makes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, replace
from typing import Any, Final

from rl_tui.lab.atlas.figures import Atlas, AtlasCell, AtlasStandings, AtlasState

_PLAIN: Final = ("episodes", "done", "planned", "steps", "message")


def news(before: Atlas, after: Atlas) -> dict[str, Any]:
    """Return, as JSON, what of ``after`` is not in ``before``: cells are sent when they have changed."""
    return {
        "state": after.state,
        **{name: getattr(after, name) for name in _PLAIN},
        "cells": {
            str(index): asdict(cell)
            for index, cell in after.cells.items()
            if cell is not before.cells.get(index)
        },
        "impossible": {
            str(index): reason for index, reason in after.impossible.items() if index not in before.impossible
        },
        "standings": {
            measure: {"best": each.best, "alike": sorted(each.alike)}
            for measure, each in after.standings.items()
            if each != before.standings.get(measure)
        },
    }


def with_news(atlas: Atlas, document: Mapping[str, Any]) -> Atlas:
    """Return ``atlas`` with the news of ``document``.

    Raises KeyError, TypeError or ValueError where these are none.
    """
    cells = {int(index): AtlasCell(**cell) for index, cell in document["cells"].items()}
    impossible = {int(index): str(reason) for index, reason in document["impossible"].items()}
    standings = {
        measure: AtlasStandings(each["best"], frozenset(each["alike"]))
        for measure, each in document["standings"].items()
    }
    return replace(
        atlas,
        state=AtlasState(document["state"]),
        cells={**atlas.cells, **cells},
        impossible={**atlas.impossible, **impossible},
        standings={**atlas.standings, **standings},
        **{name: document[name] for name in _PLAIN},
    )
