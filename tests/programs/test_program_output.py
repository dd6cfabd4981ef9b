"""The output and the messages of a program."""

from __future__ import annotations

import json
import sys
from typing import Any

import pytest

from rl_tui.programs.watched.messages import MESSAGE, MessageKind
from rl_tui.programs.watched.program_log import GARBLED, ProgramLog
from rl_tui.programs.watched.program_process import LAST_KEPT, LONGEST_LINE, MOST_A_SECOND, WrittenLines

LINES = [
    (b"one\ntwo\n", ["one", "two"]),
    (b"windows\r\n", ["windows"]),
    (b"10 %\r20 %\r", ["20 %"]),
    (b"10 %\r20 %\rdone\n", ["done"]),
    ("ä€😀\n".encode(), ["ä€😀"]),
    (b"\xff\n", ["�"]),
    (b"\x1b[1;32mgreen\x1b[0m \x1b]0;title\x07text\n", ["green text"]),
    (b"bell\x07 and null\x00\n", ["bell\\u0007 and null\\u0000"]),
    (b"a\tb\n", ["a       b"]),
    (b"\n", [""]),
    (b"x" * 10_000 + b"\n", ["x" * (LONGEST_LINE - 1) + "…"]),
    (b"no end", ["no end"]),
    (b"no end" * 1000, [("no end" * 100)[: LONGEST_LINE - 1] + "…"]),
]
each_line = pytest.mark.parametrize(("written", "lines"), LINES, ids=range(len(LINES)))


def shown(pieces: list[bytes], now: float = 0.0) -> list[str]:
    """Return the text on a screen after carriage returns have replaced its lines."""
    lines, screen = WrittenLines(), list[str]()
    for line in [*(each for piece in pieces for each in lines.take(piece, now)), *lines.end()]:
        if line.replaces:
            screen.pop()
        screen.append(line.text)
    return screen


@each_line
def test_lines(written: bytes, lines: list[str]) -> None:
    assert shown([written]) == lines


@each_line
def test_lines_in_pieces(written: bytes, lines: list[str]) -> None:
    assert shown([bytes([each]) for each in written]) == lines


def test_of_a_flood_the_first_and_the_last_lines_are_kept() -> None:
    lines = WrittenLines()
    flood = [f"{number}\n".encode() for number in range(MOST_A_SECOND + 1000)]
    first = [line.text for each in flood for line in lines.take(each, 5.5)]
    assert first == [str(number) for number in range(MOST_A_SECOND)]
    later = [line.text for line in lines.take(b"later\n", 6.0)]
    assert later[0] == f"… {1000 - LAST_KEPT:,} lines left out"
    assert later[1:-1] == [each.decode().strip() for each in flood[-LAST_KEPT:]]
    assert later[-1] == "later"


def test_an_endless_line_takes_no_memory() -> None:
    lines = WrittenLines()
    for _ in range(200):
        list(lines.take(b"x" * 100_000, 0.0))
    assert sum(map(sys.getsizeof, vars(lines).values())) < 50_000


def test_the_log_keeps_so_many_lines_and_replaces_those_without_an_end() -> None:
    log = ProgramLog()

    def say(stream: str, text: str, replaces: bool) -> None:
        log.take(
            b"O",
            f'{{"kind": "output", "step": null, "stream": "{stream}", "text": "{text}", '
            f'"replaces": {str(replaces).lower()}}}'.encode(),
        )

    say("err", "1 %", False)
    say("out", "between", False)
    say("err", "2 %", True)
    assert [line.text for line in log.output] == ["2 %", "between"]
    for number in range(3000):
        say("out", str(number), False)
    say("err", "3 %", True)
    assert len(log.output) == 2000
    assert log.output[-1].text == "3 %"


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
