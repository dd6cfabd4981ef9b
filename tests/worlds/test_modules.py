"""Modules that ids of environments import."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from rl_tui.common.errors import ScenarioError, UserError
from rl_tui.common.streams import streams
from rl_tui.worlds.files.catalogue import find
from rl_tui.worlds.files.scenario import read_scenario, scenario_of
from rl_tui.worlds.gym import modules
from rl_tui.worlds.gym.modules import allow_module

MODULE = "foreign_environments"
CODE = """
import gymnasium
from gymnasium.envs.toy_text.frozen_lake import FrozenLakeEnv

gymnasium.register("ForeignLake-v0", entry_point=FrozenLakeEnv, max_episode_steps=9)
"""
TEXT = f'[gymnasium]\nid = "{MODULE}:ForeignLake-v0"\n'


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / f"{MODULE}.py").write_text(CODE)
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setattr(modules, "ALLOWED", set())
    sys.modules.pop(MODULE, None)
    return tmp_path


def test_a_file_cannot_ask_for_one(folder: Path) -> None:
    (folder / "lake.toml").write_text(TEXT)
    with pytest.raises(ScenarioError, match=f"if you trust it, add --allow-module {MODULE}$"):
        read_scenario(folder / "lake.toml", ask_environment=False)
    with pytest.raises(ScenarioError, match="names a module, which is not imported"):
        scenario_of(TEXT, Path("session.toml"), ask_environment=False)
    assert MODULE not in sys.modules


def test_nor_can_an_id() -> None:
    with pytest.raises(UserError, match=f"--allow-module {MODULE}$"):
        find(f"gym:{MODULE}:ForeignLake-v0")
    assert MODULE not in sys.modules


def test_a_person_can_allow_it_by_name(folder: Path) -> None:
    allow_module(MODULE)
    world = find(f"gym:{MODULE}:ForeignLake-v0").build(streams(0).world)
    assert (world.space.states, world.space.time_limit) == (16, 9)
    (folder / "lake.toml").write_text(TEXT)
    assert read_scenario(folder / "lake.toml").build(streams(0).world).space.states == 16


def test_one_that_ends_the_program_when_imported_does_not(folder: Path) -> None:
    (folder / f"{MODULE}.py").write_text("print('a word'); raise SystemExit(3)")
    allow_module(MODULE)
    with pytest.raises(UserError, match=rf"{MODULE} cannot be imported \(SystemExit: 3\)"):
        find(f"gym:{MODULE}:ForeignLake-v0")


def test_but_no_other_by_it() -> None:
    allow_module("foreign_environments.part")
    with pytest.raises(UserError, match="names a module, which is not imported"):
        find(f"gym:{MODULE}:ForeignLake-v0")


def test_one_that_fails_is_a_line(folder: Path) -> None:
    (folder / f"{MODULE}.py").write_text("raise RuntimeError('no\\n\\x1b[31m')")
    allow_module(MODULE)
    with pytest.raises(UserError) as refusal:
        find(f"gym:{MODULE}:ForeignLake-v0")
    assert f"{MODULE} cannot be imported (RuntimeError: no \\u001b[31m)" in str(refusal.value)


@pytest.mark.parametrize("name", ["", "a-b", "a;b", "a.", "../a", "a b", "é"])
def test_what_is_no_name(name: str) -> None:
    with pytest.raises(UserError, match="is not the name of a module"):
        allow_module(name)


@pytest.mark.parametrize("key", ["entry_point", "additional_wrappers", "disable_env_checker", "id", "env_id"])
def test_arguments_that_are_not_the_environments_own(key: str) -> None:
    text = f'[gymnasium]\nid = "FrozenLake-v1"\nkwargs = {{ {key} = "os:system" }}\n'
    with pytest.raises(ScenarioError, match=f'kwargs.{key}: found "os:system"; expected arguments of the'):
        scenario_of(text, Path("a.toml"), ask_environment=False)


def test_control_characters_deep_in_arguments_are_named() -> None:
    text = '[gymnasium]\nid = "FrozenLake-v1"\nkwargs = { a = [{ b = "x\\u202ey" }], "c\\u0007" = 1 }\n'
    with pytest.raises(ScenarioError) as refusal:
        scenario_of(text, Path("a.toml"), ask_environment=False)
    lines = str(refusal.value).splitlines()
    assert any("kwargs.a[0].b: found U+202E in" in line for line in lines)
    assert any("found U+0007 in" in line for line in lines)
