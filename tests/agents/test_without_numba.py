"""Agents run without numba."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from rl_tui.agents.compiling.cache_key import DECORATORS, NAME, PACKAGE, imports

NEEDS_NUMBA = {f"rl_tui.agents.compiling.{module}" for module in ("jit", "machine_cache", "native")}

RUNS = """
import importlib, sys

for module in sys.argv[1:]:
    importlib.import_module(module)

from rl_tui.agents.exact.backward_induction import best_values
from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.agents.kernels.watch import Watching
from rl_tui.agents.learner import Learner
from rl_tui.common.streams import streams
from rl_tui.worlds.mdp.tabular_mdp import smallest_mdp

mdp = smallest_mdp()
for algorithm in ("q-learning", "value-iteration"):
    learner = Learner(mdp, algorithm, Hyperparameters(), streams(0))
    learner.watch(Watching(policy=True))
    learner.advance(10)
best_values(mdp, 0.9, 3)
print(sorted({"numba", "llvmlite"} & sys.modules.keys()))
"""

CALLED_FROM_PYTHON = """
from rl_tui.agents.compiling.loops import compile_what_all_share
from rl_tui.agents.kernels.compiled import CALLED_FROM_PYTHON

compile_what_all_share()
print(*sorted({function.__module__ for function in CALLED_FROM_PYTHON}))
"""


def name_of(file: Path) -> str:
    return ".".join((NAME, *file.relative_to(PACKAGE).with_suffix("").parts)).removesuffix(".__init__")


AGENTS = {name_of(file): file for file in sorted((PACKAGE / "agents").rglob("*.py"))}


def printed(script: str, *args: str, **also: str) -> str:
    command = [sys.executable, "-W", "error", "-c", script, *args]
    done = subprocess.run(command, env=os.environ | also, capture_output=True, text=True, check=True)
    return done.stdout.strip()


@pytest.mark.process
def test_all_modules_are_imported_and_run_without_numba() -> None:
    assert AGENTS.keys() > NEEDS_NUMBA
    assert printed(RUNS, *(AGENTS.keys() - NEEDS_NUMBA)) == "[]"


@pytest.mark.process
def test_who_compiles_knows_all_that_python_calls() -> None:
    marked = {
        name for name, file in AGENTS.items() if f"{DECORATORS}.compiled_for" in imports(file.read_bytes())
    }
    assert marked
    assert set(printed(CALLED_FROM_PYTHON, NUMBA_DISABLE_JIT="1").split()) == marked
