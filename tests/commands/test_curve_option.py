"""``train --curve``."""

from __future__ import annotations

import csv
import json
from functools import partial
from pathlib import Path

import pytest
from called import called

run = partial(called, "train")


def columns_of(path: Path) -> dict[str, list[float | None]]:
    with path.open(encoding="utf-8", newline="") as stream:
        head, *rows = csv.reader(stream)
    return {
        name: [float(row[place]) if row[place] else None for row in rows] for place, name in enumerate(head)
    }


def curve_in_json(*args: str) -> dict[str, list[float | None]]:
    curve: dict[str, list[float | None]] = json.loads(run(*args, "--json").stdout)["curve"]
    return curve


@pytest.mark.parametrize("scenario", ["student", "bandit"])
def test_the_curve_of_runs_is_that_of_the_json(scenario: str, tmp_path: Path) -> None:
    out = tmp_path / "curve.csv"
    args = (scenario, "--episodes", "450", "--runs", "3")
    result = run(*args, "--curve", str(out), "--json")
    assert result.exit_code == 0
    assert columns_of(out) == json.loads(result.stdout)["curve"] == curve_in_json(*args)
    assert columns_of(out)["episode"][:2] == [3, 6]


@pytest.mark.parametrize("goal", [("--episodes", "450"), ("--steps", "1000")])
def test_one_run_has_the_curve_of_itself(goal: tuple[str, str], tmp_path: Path) -> None:
    out = tmp_path / "curve.csv"
    assert run("student", *goal, "--curve", str(out)).exit_code == 0
    assert columns_of(out) == curve_in_json("student", *goal, "--runs", "1")


def test_changes_on_the_way_are_in_it(tmp_path: Path) -> None:
    out, again = tmp_path / "curve.csv", tmp_path / "again.csv"
    changed = ("student", "--change", "100:epsilon=1")
    assert (
        run(*changed, "--episodes", "300", "--curve", str(out), "--csv", str(tmp_path / "rows")).exit_code
        == 0
    )
    steps = sum(int(row.split(",")[3]) for row in (tmp_path / "rows").read_text().splitlines()[1:])
    assert run(*changed, "--steps", str(steps), "--curve", str(again)).exit_code == 0
    assert columns_of(out) == columns_of(again)


def test_a_planner_has_none(tmp_path: Path) -> None:
    out = tmp_path / "curve.csv"
    assert run("student", "--algorithm", "value-iteration", "--curve", str(out)).exit_code == 0
    assert out.read_text() == "episode,return_mean,return_stderr,length_mean,length_stderr\n"


def test_on_stdout_it_is_alone() -> None:
    result = run("student", "--episodes", "20", "--curve", "-")
    assert result.stdout.count("\n") == 21
    assert "value at the start" in result.stderr


@pytest.mark.parametrize(
    ("args", "said"),
    [
        (("--curve", "-", "--json"), "--curve and --json both write to stdout"),
        (("--curve", "-", "--csv", "-"), "--csv and --curve both write to stdout"),
        (("--curve", "x.csv", "--csv", "x.csv"), "--csv and --curve both write to the same file"),
        (("--curve", "a/../x.csv", "--csv", "x.csv"), "--csv and --curve both write to the same file"),
    ],
)
def test_two_do_not_go_to_one_place(args: tuple[str, ...], said: str) -> None:
    result = run("student", *args)
    assert (result.exit_code, result.stdout) == (2, "")
    assert said in result.stderr


def test_of_a_run_that_fails_no_empty_file_is_left(tmp_path: Path) -> None:
    out = tmp_path / "curve.csv"
    assert run("student", "--change", "5:take=fly", "--curve", str(out)).exit_code == 1
    assert not out.exists()
    folder = run("student", "--curve", str(tmp_path / "missing" / "curve.csv"))
    assert (folder.exit_code, folder.stderr.count("\n")) == (1, 1)
