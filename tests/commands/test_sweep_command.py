"""``rl-tui sweep`` and ``rl-tui sweep merge``."""

from __future__ import annotations

import csv
import json
import re
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from called import assert_refused, called

from rl_tui.studies.sweeps.cell import MEASURES
from rl_tui.studies.sweeps.store import Store

SWEEP = ("maze", "--vary", "alpha=0.1:0.9:3", "--vary", "algorithm=q-learning,sarsa", "--episodes", "20")
TIMES = ("seconds", "steps_per_second")
run = partial(called, "sweep")


def in_json(*args: str) -> dict[str, Any]:
    result = run(*args, "--json")
    assert result.exit_code == 0, result.stderr
    found: dict[str, Any] = json.loads(result.stdout)
    return found


def test_the_document_of_a_sweep() -> None:
    document = in_json(*SWEEP, "--runs", "3")
    assert document["scenario"] == "maze"
    assert document["vary"] == ["alpha=0.1:0.9:3", "algorithm=q-learning,sarsa"]
    assert [each["id"] for each in document["measures"]] == list(MEASURES)
    assert len(document["cells"]) == 6
    for cell in document["cells"]:
        assert (cell["runs"], cell["failed"]) == (3, 0)
        for measure in MEASURES:
            assert {"mean", "median", "iqm", "low", "high"} <= set(cell[measure])
    assert set(document["best"]["again"]) > set(MEASURES)
    assert document["best"]["again"]["first_seed"] == 3
    assert document["steps_per_second"] > 0


def test_what_stands_in_it_does_not_depend_on_how_it_was_come_by(tmp_path: Path) -> None:
    store = str(tmp_path / "sweep.sqlite")
    whole = in_json(*SWEEP, "--runs", "3", "--jobs", "1")
    assert in_json(*SWEEP, "--runs", "2", "--store", store)["cells"]
    for _ in range(2):
        again = in_json(*SWEEP, "--runs", "3", "--store", store)
        assert {k: v for k, v in again.items() if k not in TIMES} == {
            k: v for k, v in whole.items() if k not in TIMES
        }
    assert again["steps_per_second"] is None


def test_the_csv_has_a_row_for_each_run() -> None:
    result = run(*SWEEP, "--runs", "2", "--seed", "5", "--csv", "-", "--no-again")
    assert result.exit_code == 0
    head, *rows = csv.reader(result.stdout.splitlines())
    assert head == ["alpha", "algorithm", "seed", *MEASURES, "arrived", "failed"]
    assert [row[:3] for row in rows] == [
        [alpha, algorithm, seed]
        for alpha in ("0.1", "0.5", "0.9")
        for algorithm in ("q-learning", "sarsa")
        for seed in ("5", "6")
    ]
    assert "area" in result.stderr  # the report


def test_parts_are_merged(tmp_path: Path) -> None:
    parts, merged = [str(tmp_path / f"{number}.sqlite") for number in (1, 2)], str(tmp_path / "merged.sqlite")
    for number, part in enumerate(parts, start=1):
        result = run(*SWEEP, "--runs", "1", "--shard", f"{number}/2", "--store", part)
        assert (result.exit_code, "merge" in result.stdout) == (0, True)
    result = run("merge", merged, *parts)
    assert (result.exit_code, result.stdout) == (0, f"{merged}: 6 new runs, 0 already there\n")


def test_the_report_names_the_best_and_what_is_like_it() -> None:
    result = run("frozenlake", "--vary", "epsilon=0.1,0.9", "--episodes", "200", "--runs", "10")
    assert result.exit_code == 0
    text = " ".join(result.stdout.split())
    assert "2 cells, 10 runs each, seeds 0 to 9" in text
    assert re.search(r"epsilon area from to median .*0\.1 \d", text)
    assert "Holm" in text
    assert re.search(r"The best, epsilon=0\.1, again on fresh seeds 10 to 19: ", text)


def test_the_report_writes_settings_as_people_do() -> None:
    said = run("maze", "--vary", "alpha=0.1:0.5:4", "--runs", "1", "--episodes", "1").stdout
    assert "0.233333" in said
    assert "0.2333333" not in said


def test_a_single_cell_has_nothing_to_compare_with() -> None:
    words = run("student", "--vary", "alpha=0.1", "--runs", "2", "--episodes", "9").stdout
    assert "a single cell" in words
    assert "Too few runs" not in words


def test_the_winner_is_kept_like_any_other_run(tmp_path: Path) -> None:
    path = tmp_path / "sweep.sqlite"
    assert run(*SWEEP, "--runs", "2", "--store", str(path)).exit_code == 0
    with Store.to_read(path) as store:
        assert store.count() == 6 * 2 + 2
    assert run(*SWEEP, "--runs", "2", "--store", str(path), "--no-again").exit_code == 0


def test_several_scenarios_have_a_best_each_and_a_sensitivity() -> None:
    vary = ("--vary", "scenario=frozenlake,cliff", "--vary", "alpha=0.1,0.9")
    args = ("frozenlake", *vary, "--runs", "2", "--episodes", "50", "--no-again")
    document = in_json(*args)
    assert document["best"] is None
    assert [each["scenario"] for each in document["bests"]] == ["frozenlake", "cliff"]
    assert document["sensitivity"][0]["algorithm"] == "q-learning"
    text = " ".join(run(*args).stdout.split())
    assert "Sensitivity: mean score" in text


def test_what_has_no_effect_is_told() -> None:
    result = run("maze", "--vary", "lambda=0.1,0.2", "--runs", "1", "--episodes", "5", "--no-again")
    assert result.exit_code == 0
    assert "lambda has no effect" in result.stderr


@pytest.mark.parametrize(
    ("args", "status", "expected"),
    [
        (("maze",), 2, "--vary"),
        (("maze", "--vary", "alhpa=1"), 2, "alpha"),
        (("maze", "--vary", "alpha=0:1:3"), 2, "(0, 1]"),
        (("maze", "--vary", "alpha=0.1,0.2", "--shard", "1/3"), 2, "--store"),
        (("maze", "--vary", "alpha=0.1,0.2", "--shard", "4/3", "--store", "x"), 2, "4/3"),
        (("maze", "--vary", "alpha=0.1,0.2", "--shard", "1/3", "--store", "x", "--json"), 2, "merge"),
        (("maze", "--vary", "alpha=0.1,0.2", "--measure", "aera"), 2, "area"),
        (("maze", "--vary", "alpha=0.1,0.2", "--json", "--csv", "-"), 2, "stdout"),
        (("maze", "--vary", "policy=gradient,ucb"), 1, "policy=gradient"),
        (("maze", "--vary", "world.nosie=0.1"), 1, "noise"),
        (("nowhere", "--vary", "alpha=0.1"), 1, "nowhere"),
        (("maze", "--vary", "alpha=0.1", "--store", "no/such/folder/x.sqlite"), 1, "there is no folder"),
        (("maze", "--vary", "alpha=0.1,0.2", "--alpha", "0.3"), 2, "give --vary alpha or --alpha, not both"),
        (("maze", "--vary", "alpha=0.1,0.2", "--seed", "9" * 20), 1, "too large"),
        (("maze", "--vary", "alpha=0.1", "--store", ""), 1, "not a file name"),
        (("merge", "out.sqlite"), 2, "IN.sqlite"),
        (("merge", "out.sqlite", "no-such.sqlite"), 1, "no-such.sqlite"),
    ],
)
def test_what_is_wrong_is_one_line(
    args: tuple[str, ...], status: int, expected: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert_refused(run(*args), status, expected)


def test_a_wrong_plan_makes_no_store(tmp_path: Path) -> None:
    assert run("maze", "--vary", "policy=gradient", "--store", str(tmp_path / "x.sqlite")).exit_code == 1
    assert list(tmp_path.iterdir()) == []


def test_the_help_of_both() -> None:
    assert "merge" in run("--help").stdout
    assert "OUT.sqlite" in run("merge", "--help").stdout
