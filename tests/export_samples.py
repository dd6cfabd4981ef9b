"""Exported scripts, and their results."""

from __future__ import annotations

import ast
from pathlib import Path
from typing import Any, Final

import numpy as np

import rl_tui
from rl_tui.agents.catalogue import Algorithm, Policy
from rl_tui.runs.export.script import script
from rl_tui.runs.export.template import ENDING
from rl_tui.runs.library import recipe_for
from rl_tui.runs.recipe import Recipe, begin
from rl_tui.worlds.files.catalogue import find
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

PACKAGE: Final = Path(rl_tui.__file__).parent
ALLOWED: Final = {"gymnasium", "numpy", "bisect", "collections"}


def has_script(row: Algorithm | Policy) -> bool:
    return (PACKAGE.parent / row.module.replace(".", "/")).with_suffix(ENDING).is_file()


def recipe_of(scenario: str, **overrides: object) -> Recipe:
    return recipe_for(find(scenario), overrides)


def table_of(recipe: Recipe) -> TabularMDP:
    mdp = begin(recipe).world.mdp
    assert mdp is not None
    return mdp


def script_of(scenario: str, episodes: int = 100, **overrides: object) -> str:
    return script(recipe_of(scenario, **overrides), episodes)


def ran(text: str, until: str = "\nprint(") -> dict[str, Any]:
    names: dict[str, Any] = {"__name__": "script"}
    exec(compile(text.split(until)[0], "script", "exec"), names)
    return names


def q_of(names: dict[str, Any], mdp: TabularMDP) -> np.ndarray:
    rows = names["Q"]
    numbers = range(mdp.states)
    if len(rows) != mdp.states:
        numbers = [int(name) for name in mdp.state_names]
    elif "STATES" in names:
        numbers = [names["STATES"].index(name) for name in mdp.state_names]
    q = np.empty(mdp.pairs)
    for state in range(mdp.states):
        pairs = mdp.pairs_of(state)
        if pairs:
            assert len(rows[numbers[state]]) == len(pairs)
            q[pairs.start : pairs.stop] = rows[numbers[state]]
    return q


def imported(text: str) -> set[str]:
    names: set[str] = set()
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            names.update(alias.name.split(".")[0] for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            names.add((node.module or "").split(".")[0])
    return names
