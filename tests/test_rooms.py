"""Imports run one way, and slow ones come late."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest

from rl_tui.commands.main import RlTui

ROOMS = ("common", "worlds", "agents", "runs", "studies", "programs", "lessons", "live", "screen", "commands")
SLOW = ("numba", "gymnasium", "textual")

LOADED = """
import json, sys
{code}
print(json.dumps(sorted(name for name in sys.modules if "." not in name or name.startswith("rl_tui."))))
"""

WHOLE_ROOM = """
import importlib, pkgutil
import rl_tui.{room}
for module in pkgutil.walk_packages(rl_tui.{room}.__path__, "rl_tui.{room}."):
    importlib.import_module(module.name)
"""

COMMAND_LINE = """
from rl_tui.commands.main import program
try:
    program({args!r}, prog_name="rl-tui")
except SystemExit as end:
    assert end.code == 0
"""


def loaded_by(code: str) -> set[str]:
    done = subprocess.run(
        [sys.executable, "-c", LOADED.format(code=code)], capture_output=True, text=True, check=True
    )
    return set(json.loads(done.stdout.splitlines()[-1]))


@pytest.mark.exhaustive("imports each room whole", but=["agents", "live"])
@pytest.mark.parametrize("room", ROOMS[:-2])
def test_a_lower_room_neither_draws_nor_looks_up(room: str) -> None:
    loaded = loaded_by(WHOLE_ROOM.format(room=room))
    assert f"rl_tui.{room}" in loaded
    assert "textual" not in loaded
    above = ROOMS[ROOMS.index(room) + 1 :]
    assert not loaded & {f"rl_tui.{each}" for each in above}


def test_the_screen_comes_up_without_what_is_slow() -> None:
    loaded = loaded_by("import rl_tui.screen.app.app, rl_tui.screen.catalogue.catalogue")
    assert "textual" in loaded
    assert not loaded & {"numba", "gymnasium", "scipy", "numpy"}


def test_a_world_that_is_written_out_is_solved_without_other_worlds() -> None:
    loaded = loaded_by(COMMAND_LINE.format(args=["solve", "student", "--json"]))
    assert "rl_tui.worlds.sections.mdp_section" in loaded
    assert not loaded & {*SLOW, "scipy"}
    assert not loaded & {"rl_tui.worlds.grid", "rl_tui.worlds.gym", "rl_tui.worlds.sections.bandit_section"}
    assert "rl_tui.agents.learner" not in loaded


def test_version_and_help_load_nothing_slow() -> None:
    asked = (["--version"], ["--help"], *([name, "--help"] for name in RlTui.modules))
    loaded = loaded_by("".join(COMMAND_LINE.format(args=args) for args in asked))
    assert "click" in loaded
    assert {f"rl_tui.commands.by_name.{name}" for name in ("list", "train")} <= loaded
    assert not loaded & {*SLOW, "numpy", "pydantic", "rl_tui.screen.keys.registry"}


def test_a_short_training_loads_neither_a_screen_nor_a_compiler() -> None:
    loaded = loaded_by(COMMAND_LINE.format(args=["train", "student", "--steps", "10"]))
    assert "rl_tui.agents.learner" in loaded
    assert not loaded & {*SLOW, "scipy"}
