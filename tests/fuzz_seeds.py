"""Valid files, the sources of broken ones."""

from __future__ import annotations

import hashlib
import json
import sys
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

sys.path.append(str(Path(__file__).parent / "lessons"))

from lesson_samples import SOUND
from lesson_sessions import TEXT as EVENING
from lesson_sessions import all_done, lesson, run_of, setup
from lesson_sessions import record as lesson_record
from recipes import recipe
from session_samples import after, fresh

from rl_tui.live.pace.until import Breakpoints
from rl_tui.live.record import Record
from rl_tui.live.sessions.session import encoded
from rl_tui.runs.recipe import JournalEntry, SetParameter, SwitchAlgorithm, TakeAction
from rl_tui.runs.timeline.branches import Branch
from rl_tui.worlds.files.shipped import shipped_folder

BINS = """
title = "bins"
[gymnasium]
id = "MountainCar-v0"
[gymnasium.bins]
low = [-1.2, -0.07]
high = [0.6, 0.07]
count = [4, 3]
"""
EDGES = """
[gymnasium]
id = "CartPole-v1"
kwargs = { sutton_barto_reward = true }
bins = { edges = [[], [-0.5, 0.5], [0.0], []] }
"""
OUTCOMES = """
[mdp]
start = { a = 0.25, "b c" = 0.75 }
time_limit = 9
transition = [
  { state = "a", action = "x", to = { a = { p = 0.5, reward = 1, std = 0.1}, "b c" = { p = 0.5, reward = 2}}},
  { state = "b c", action = "y", reward = 1e3, std = 2, to = "end" },
]
"""
LEGEND = """
[grid]
map = \"\"\"
S.A#
.x.B
G..E
\"\"\"
moves = "king+stay"
step_reward = -0.5
bump_reward = -1
wind = [0, 1, 0, -1]
wind_rows = [0, 0, 1]
gusts = true
time_limit = 30
[grid.legend]
A = { kind = "floor", jump = "B", reward = 3 }
x = { kind = "cliff", reward = -100, back = true }
E = { kind = "goal", reward = 2, exit = true }
B = { kind = "floor", only = ["left", "up"] }
"""


@cache
def scenario_seeds() -> tuple[str, ...]:
    shipped = [path.read_text(encoding="utf-8") for path in sorted(shipped_folder().glob("*.toml"))]
    # in a large map, mutations would rarely touch anything else
    return (*(text for text in shipped if len(text) < 10_000), BINS, EDGES, OUTCOMES, LEGEND)


@cache
def session_seeds() -> tuple[str, ...]:
    return tuple(encoded(record).decode() for record in _records())


def lesson_seeds() -> tuple[str, ...]:
    return EVENING, SOUND


def _records() -> list[Record]:
    student, lake, bandit = (fresh(recipe(name)) for name in ("student", "frozenlake", "bandit"))
    changed = after(
        student,
        300,
        (0, SetParameter("alpha", "sample-average")),
        (0, TakeAction(0)),
        (100, SetParameter("epsilon", 0.5)),
        (200, SwitchAlgorithm("sarsa")),
    )
    return [
        changed,
        after(lake, 500, (50, SetParameter("gamma", 0.5))),
        after(bandit, 90, (7, TakeAction(3)), (40, SetParameter("policy", "ucb"))),
        after(fresh(recipe("gym:FrozenLake8x8-v1"), speed=None), 100),
        _with_branches(lake),
        replace(changed, lanes=changed.lanes * 3, shown=1, breakpoints=Breakpoints({1}, {0, 2})),
        lesson_record(all_done(lesson()), run_of(setup(lesson()), 80)),
    ]


def _with_branches(record: Record) -> Record:
    shared = (JournalEntry(10, SetParameter("alpha", 0.2)),)
    later = (*shared, JournalEntry(60, SetParameter("ties", "first")))
    branches = (
        Branch("branch 1", later, None, 0, 200, 200),
        Branch("branch 2", (*shared, JournalEntry(30, SwitchAlgorithm("sarsa"))), 0, 30, 90, 40),
        Branch("third", (*later, JournalEntry(80, TakeAction(2))), 0, 80, 120, 120),
    )
    return replace(record, lanes=(replace(record.lanes[0], branches=branches, branch=2),))


def signed(fields: dict[str, Any]) -> str:
    unsigned = {key: value for key, value in fields.items() if key != "checksum"}
    text = json.dumps(unsigned, sort_keys=True, separators=(",", ":"))
    return json.dumps({**unsigned, "checksum": hashlib.sha256(text.encode()).hexdigest()})
