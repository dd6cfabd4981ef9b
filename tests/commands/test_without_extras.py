"""Commands without Numba and SciPy."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result

from rl_tui.agents.exact import policy_evaluation, policy_figures
from rl_tui.agents.exact.policy_figures import expected_visits, uniform_policy
from rl_tui.agents.exact.solve import solve
from rl_tui.commands.main import INTERPRETED, program
from rl_tui.common.packages import STAYS_INTERPRETED, is_installed, why_interpreted
from rl_tui.runs.library import recipe_named
from rl_tui.runs.recipe import begin
from rl_tui.worlds.mdp import reachable
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

SENTENCE = f"{STAYS_INTERPRETED}: the package numba is missing; install it: pip install numba\n"
LACKING = "exact values of more than 2,000 states need SciPy: pip install scipy"


COMMANDS = (
    ("train", "student", "--episodes", "20"),
    ("train", "student", "--episodes", "20", "--runs", "3"),
    ("solve", "student"),
    ("sweep", "student", "--vary", "alpha=0.1,0.5", "--episodes", "5", "--runs", "10"),
    ("evaluate", "student", "--policy", "optimal"),
    ("screenshot", "student", "--keys", "s,s,v", "--out", "-"),
    ("list",),
)
HIDDEN = """
import json, sys

sys.modules.update(dict.fromkeys(("numba", "scipy")))
from click.testing import CliRunner
from rl_tui.commands.main import program

for args in json.loads(sys.argv[1]):
    done = CliRunner().invoke(program, args)
    print(json.dumps([done.exit_code, done.stdout, done.stderr]))
"""


def run(*args: str) -> Result:
    return CliRunner().invoke(program, args)


@pytest.fixture
def _without_scipy(monkeypatch: pytest.MonkeyPatch) -> None:
    for module in {"scipy", *(each for each in sys.modules if each.startswith("scipy."))}:
        monkeypatch.setitem(sys.modules, module, None)


def open_grid(folder: Path, width: int, height: int) -> str:
    rows = ["." * width for _ in range(height - 1)]
    file = folder / "plain.toml"
    lines = "\n".join([f"S{rows[0][1:]}", *rows[1:], f"{rows[0][1:]}G"])
    file.write_text(f'title = "Plain"\n[grid]\nstep_reward = -1\nmap = """\n{lines}\n"""\n', encoding="utf-8")
    return str(file)


def table_of(scenario: str) -> TabularMDP:
    mdp = begin(recipe_named(scenario, {}, 0)).world.mdp
    assert mdp is not None
    return mdp


@pytest.mark.exhaustive("a new process imports all; .ci/run takes it where the packages are missing")
@pytest.mark.process
def test_commands_work_and_say_first_that_they_are_interpreted(tmp_path: Path) -> None:
    command = [sys.executable, "-c", HIDDEN, json.dumps(COMMANDS)]
    ended = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True)
    for args, line in zip(COMMANDS, ended.stdout.splitlines(), strict=True):
        status, out, err = json.loads(line)
        assert (status, bool(out)) == (0, True), err
        assert err.startswith(SENTENCE) == (args[0] in INTERPRETED)
        assert err.count("pip install") == (args[0] in INTERPRETED)


@pytest.mark.skipif(not is_installed("numba"), reason="Numba is not installed")
def test_where_numba_is_installed_nothing_is_said() -> None:
    assert why_interpreted() == ""
    assert run("solve", "student").stderr == ""


@pytest.mark.usefixtures("_without_scipy")
def test_a_world_of_five_hundred_states_has_exact_values() -> None:
    done = run("solve", "taxi", "--json")
    assert done.exit_code == 0, done.stderr
    assert json.loads(done.stdout)["value_at_start"] == pytest.approx(6.32746, abs=1e-5)


@pytest.mark.usefixtures("_without_scipy")
def test_numpy_alone_finds_the_same_values_and_visits(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    mdp = table_of(open_grid(tmp_path, 25, 20))
    solution, visits = solve(mdp, 0.99), expected_visits(mdp, uniform_policy(mdp), 300)
    monkeypatch.undo()
    if not is_installed("scipy"):
        pytest.skip("SciPy is not installed")
    assert mdp.states > max(policy_evaluation.MOST_DENSE, policy_figures.MOST_DENSE)
    np.testing.assert_allclose(solution.v, solve(mdp, 0.99).v, rtol=1e-12)
    np.testing.assert_allclose(visits, expected_visits(mdp, uniform_policy(mdp), 300), rtol=1e-12)


@pytest.mark.usefixtures("_without_scipy")
def test_reachable_states_are_found_in_large_worlds(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reachable, "MOST_PLAIN", 0)
    found = reachable.reachable(np.array([0, 1, 2, 2]), np.array([1, 0]), np.array([0]))
    assert found.tolist() == [True, True, False]


@pytest.mark.usefixtures("_without_scipy")
def test_a_larger_world_names_the_package_that_its_exact_values_need(tmp_path: Path) -> None:
    file = open_grid(tmp_path, 46, 44)
    solved = run("solve", file)
    assert (solved.exit_code, solved.stdout) == (1, "")
    assert solved.stderr.endswith(f"rl-tui: {LACKING}\n")
    trained = run("train", file, "--steps", "100")
    assert trained.exit_code == 0
    assert LACKING in trained.stdout
