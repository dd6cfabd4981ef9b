"""The scripts of the folder examples."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.exhaustive("imports large packages and trains")

ROOT = Path(__file__).parents[1]
EXAMPLES = ROOT / "examples"


def printed(*command: object) -> str:
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def numbers(pattern: str, text: str) -> list[float]:
    return [float(each) for each in re.findall(pattern, text)]


def test_dqn_learns_the_exact_values_of_a_small_world() -> None:
    pytest.importorskip("stable_baselines3")
    text = printed(sys.executable, EXAMPLES / "dqn_against_exact_values.py")
    rows = re.findall(r"^(?!state)\S.*? +(-?\d+\.\d\d) +(-?\d+\.\d\d)$", text, re.MULTILINE)
    assert len(rows) > 2
    assert all(float(learned) == pytest.approx(float(exact), abs=1.0) for exact, learned in rows)
    ((got, best),) = re.findall(r"policy: (\S+) of (\S+)", text)
    assert float(got) == pytest.approx(float(best), abs=0.5)


def test_optuna_finds_settings_that_are_good_under_fresh_seeds_too() -> None:
    pytest.importorskip("optuna")
    text = printed(sys.executable, EXAMPLES / "tune_with_optuna.py", 8)
    (best,) = numbers(r"trials: (-[\d.]+) with \{'alpha'", text)
    (fresh,) = numbers(r"fresh seeds: (-[\d.]+)", text)
    assert -60 < fresh < -13
    assert -60 < best < -13


def test_pandas_reads_the_store_of_a_sweep(tmp_path: Path) -> None:
    pytest.importorskip("pandas")
    store = tmp_path / "student.sqlite"
    vary = ("--vary", "alpha=.1,.2", "--vary", "algorithm=q-learning,sarsa")
    printed(
        sys.executable,
        "-m",
        "rl_tui",
        "sweep",
        "student",
        *vary,
        "--no-again",
        "--runs",
        3,
        "--episodes",
        50,
        "--store",
        store,
    )
    lines = printed(sys.executable, EXAMPLES / "sweep_in_pandas.py", store).splitlines()
    assert [each.split()[-1] for each in lines[-4:]] == ["3"] * 4
    assert {word for line in lines for word in line.split()} >= {
        "alpha",
        "algorithm",
        "q-learning",
        "sarsa",
        "0.1",
        "0.2",
    }
