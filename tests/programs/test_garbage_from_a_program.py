"""Foreign messages stop only the analysis."""

from __future__ import annotations

import json
from typing import Any

import pytest

from rl_tui.programs.watched.messages import MESSAGE, MessageKind
from rl_tui.programs.watched.program_log import GARBLED, ProgramLog

ENVIRONMENT: dict[str, Any] = {
    "kind": MessageKind.ENVIRONMENT,
    "number": 0,
    "id": "FrozenLake-v1",
    "kwargs": {},
    "states": [16],
    "first_state": [0],
    "actions": 4,
    "first_action": 0,
    "time_limit": 100,
    "wrappers": ["TimeLimit"],
}
TABLE: dict[str, Any] = {
    "kind": MessageKind.TABLE,
    "step": 0,
    "name": "q",
    "form": "array",
    "shape": [16, 4],
    "dtype": "float64",
    "actions": 4,
    "others": ["n"],
    "other_forms": ["array"],
    "shared": False,
    "file": "a.py",
    "line": None,
}
NO_COUNTS = (None, -1, 10**30, 0.5, "x", [])
NO_TEXTS = (None, 1, [], {})
ODD = [
    *((ENVIRONMENT, name, odd) for name in ("number", "actions", "time_limit") for odd in NO_COUNTS),
    *((ENVIRONMENT, "id", odd) for odd in NO_TEXTS),
    *((ENVIRONMENT, "states", odd) for odd in (None, 16, [], [0], ["x"], [4, 4])),
    *((ENVIRONMENT, "wrappers", odd) for odd in (None, "x", [1])),
    *((TABLE, "step", odd) for odd in (None, 10**30, "x")),
    *((TABLE, name, odd) for name in ("name", "form", "dtype") for odd in NO_TEXTS),
    *((TABLE, "shape", odd) for odd in (None, 16, ["x"])),
    *((TABLE, name, odd) for name in ("others", "other_forms") for odd in (None, "xy")),
    (TABLE, "others", [1]),
]


def said(message: dict[str, Any]) -> ProgramLog:
    log = ProgramLog()
    log.take(MESSAGE, json.dumps(message).encode())
    return log


@pytest.mark.parametrize("message", [ENVIRONMENT, TABLE], ids=["environment", "table"])
def test_a_message_of_ours_counts(message: dict[str, Any]) -> None:
    log = said(message)
    assert not log.is_garbled
    assert len(log.environments) + (log.table is not None) == 1


@pytest.mark.parametrize(("message", "name", "odd"), ODD)
def test_one_that_holds_something_else_is_garbled(message: dict[str, Any], name: str, odd: object) -> None:
    log = said({**message, name: odd})
    assert log.is_garbled
    assert log.error.text == GARBLED
    assert not log.environments
    assert log.table is None
