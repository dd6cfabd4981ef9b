"""Manipulated session files: each gives one short line."""

# ruff: noqa: E501

from __future__ import annotations

import json
import math
from typing import Any

import pytest
from fuzz_seeds import session_seeds, signed

from rl_tui.common.errors import UserError
from rl_tui.common.limits import LARGEST_SESSION
from rl_tui.live.sessions.replay import replay_target, replayed
from rl_tui.live.sessions.session import SessionError, read_session


def changed(place: str = "", value: Any = None) -> str:
    fields = json.loads(session_seeds()[0])
    holder: Any = fields
    *way, last = [int(step) if step.isdigit() else step for step in place.split(".")]
    for step in way:
        holder = holder[step]
    if last != "":
        holder[last] = value
    return signed(fields)


LANE = "lanes.0"
BRANCH = f"{LANE}.branches.0"
SOUND = json.loads(session_seeds()[0])
TABLE = {"q": [0.0] * 5, "visits": [0] * 5, "episodes": 0, "state": 0}

# Made on demand: some take megabytes
REFUSED = {
    "branches": (lambda: changed(f"{LANE}.branches", SOUND["lanes"][0]["branches"] * 2_000), "at most 1000"),
    "changes": (lambda: changed(f"{BRANCH}.journal", [{"step": 0, "take": 0}] * 200_001), "at most 200000"),
    "changes that are none": (lambda: changed(f"{BRANCH}.journal", [{"a": 1}] * 50_000), "journal[0]"),
    "keys": (lambda: changed(f"{LANE}.hyperparameters", dict.fromkeys(map(str, range(50_000)), 1)), "at most 100"),
    "more keys": (lambda: signed({**SOUND, **dict.fromkeys(map(str, range(50_000)), 1)}), "at most 100"),
    "breakpoints": (lambda: changed("breakpoints.states", list(range(100_001))), "at most 100000"),
    "a breakpoint before the first": (lambda: changed("breakpoints.pairs", [-1]), "breakpoints.pairs[0]"),
    "a step before the first": (lambda: changed(f"{BRANCH}.here", -1), "greater than or equal to 0"),
    "two changes in one": (lambda: changed(f"{BRANCH}.journal", [{"step": 1, "take": 0, "algorithm": "sarsa"}]), "not a change"),
    "an infinite setting": (
        lambda: changed(f"{BRANCH}.journal", [{"step": 1, "set": "alpha", "to": math.inf}]),
        "damaged",
    ),
    "a setting out of range": (lambda: changed(f"{LANE}.hyperparameters.gamma", 1e300), "gamma"),
    "a fork beyond the end": (lambda: changed(f"{BRANCH}.fork", 10**9), "after the last step"),
    "no speed": (lambda: changed("speed", math.inf), "damaged"),
    "a truth value": (lambda: changed("shown", False), "integer"),
    "half a letter": (lambda: changed("title", "\ud800"), "title"),
    "half a letter in the scenario": (lambda: changed("scenario.text", "\ud800"), "scenario.text"),
    "a title that moves the cursor": (lambda: changed("title", "\x1b[2J"), "U+001B is a control character"),
    "a long title": (lambda: changed("title", "x" * 5_000_000), "at most 80"),
    "a long text": (lambda: changed("scenario.text", "#" * 20_000_001), "at most 20000000"),
    "a key without end": (lambda: changed("scenario.text", ".".join("a" * 100_000) + "=1"), "20 parts"),
    "a world of 10^9 cells": (lambda: changed("scenario.text", "[grid]\nrandom = { rows = 100_000, columns = 10_000 }"), "10,000"),
    "10^9 arms": (lambda: changed("scenario.text", "[bandit]\narms = 1_000_000_000"), "10,000"),
    "a time after all": (lambda: changed("saved", "9999-12-31T23:59:59-23:59"), "expected a time"),
    "a module": (lambda: changed("scenario", {"id": "gym:os:X-v0", "kind": "gymnasium", "title": "t", "text": ""}), "names a module, which is not imported"),
    "nested lists": (lambda: signed({**SOUND, "more": json.loads("[" * 900 + "]" * 900)}), "more"),
    "brackets": (lambda: '{"format": "rl-tui session", "x": ' + "[" * 1_000_000, "incomplete or damaged"),
    "a number too long to read": (lambda: changed().replace('"shown": 0', '"shown": ' + "1" * 5_000), "damaged"),
    "a number beyond all": (lambda: changed().replace('"speed": 10.0', '"speed": 1e999'), "checksum"),
    "no number": (lambda: changed().replace('"speed": 10.0', '"speed": NaN'), "damaged"),
    "a byte order mark": (lambda: "\ufeff" + changed(), "damaged"),
    "a null character": (lambda: changed() + "\0", "damaged"),
    "a list": (lambda: "[" + changed() + "]", "not a session"),
    "a table of fewer visits": (lambda: changed("table", {**TABLE, "visits": [0] * 4}), "Q has 5 pairs, but visits has 4"),
    "a table of too many pairs": (lambda: changed("table", {**TABLE, "q": [0.0] * 2_501}), "at most 2500"),
    "a table of words": (lambda: changed("table", {**TABLE, "q": ["nan"] * 5}), "table.q[0]"),
    "a table of no numbers": (lambda: changed("table", {**TABLE, "q": [math.nan] * 5}), "damaged"),
    "a table beyond all numbers": (lambda: changed("table", {**TABLE, "q": [10**400] * 5}), "table.q[0]"),
    "visits before the first": (lambda: changed("table", {**TABLE, "visits": [-1] * 5}), "table.visits[0]"),
    "visits without end": (lambda: changed("table", {**TABLE, "visits": [10**18] * 5}), "table.visits[0]"),
    "parts of visits": (lambda: changed("table", {**TABLE, "visits": [0.5] * 5}), "table.visits[0]"),
    "a table without Q": (lambda: changed("table", {"visits": [0] * 5, "episodes": 0, "state": 0}), "table.q"),
    "a table with more": (lambda: changed("table", {**TABLE, "v": [0.0]}), "table.v"),
    "a table that is none": (lambda: changed("table", [0.0] * 5), "table"),
    "bytes": (lambda: "x" * (LARGEST_SESSION + 1), "at most 64 MB"),
}  # fmt: skip


def read(text: str, folder) -> Any:
    path = folder / "mine.json"
    path.write_bytes(text.encode("utf-8", "surrogatepass"))
    stored = read_session(path)
    return stored, stored.record()


@pytest.mark.parametrize("name", REFUSED)
def test_is_refused_in_one_short_line(name, tmp_path):
    text, message = REFUSED[name]
    with pytest.raises(SessionError) as error:
        read(text(), tmp_path)
    line = str(error.value)
    assert message in line
    assert len(line.splitlines()) == 1
    assert len(line) < 1_000


UNPLAYABLE = {
    "an action that is not there": (changed(f"{BRANCH}.journal", [{"step": 9, "take": 10**12}]), "not available"),
}  # fmt: skip


@pytest.mark.parametrize("name", UNPLAYABLE)
def test_what_shows_on_the_way_is_told_in_one_line_too(name, tmp_path):
    text, message = UNPLAYABLE[name]
    _, record = read(text, tmp_path)
    with pytest.raises(UserError, match=message) as error:
        replayed(replay_target(record))
    assert len(str(error.value).splitlines()) == 1


def test_the_last_of_keys_that_are_given_twice_counts(tmp_path):
    """The checksum covers the parsed content."""
    stored, _ = read(changed().replace('"shown": 0', '"shown": 9, "shown": 0'), tmp_path)
    assert stored.document.shown == 0


def test_a_seed_of_thousands_of_digits_is_a_seed(tmp_path):
    _, record = read(changed(f"{LANE}.seed", 10**4_000), tmp_path)
    assert record.lanes[0].recipe.seed == 10**4_000
