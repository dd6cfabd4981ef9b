from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from result_samples import STEP_SIZES, grid, runs, sweep, written

from rl_tui.common.errors import UserError
from rl_tui.studies.pictures.reading import read_results
from rl_tui.studies.pictures.tables import CellSpread, CurveTable, SweepTable

CURVE: dict[str, list[float | None]] = {
    "episode": [1, 2],
    "return_mean": [1.0, None],
    "return_stderr": [0.5, None],
}


def test_the_curve_of_runs(tmp_path: Path) -> None:
    table = read_results(written(tmp_path, runs(CURVE)))
    assert isinstance(table, CurveTable)
    assert (table.name, table.runs) == ("cliff, sarsa", 3)
    assert dict(table.columns) == CURVE


def test_the_same_curve_as_csv(tmp_path: Path) -> None:
    path = tmp_path / "mine.csv"
    path.write_text("episode,return_mean,return_stderr\n1,1.0,0.5\n2,,\n", encoding="utf-8")
    table = read_results(path)
    assert isinstance(table, CurveTable)
    assert (table.name, table.runs) == ("mine", None)
    assert dict(table.columns) == CURVE


def test_the_cells_of_a_sweep(tmp_path: Path) -> None:
    table = read_results(written(tmp_path, sweep(*grid("sarsa", "q-learning"))))
    assert isinstance(table, SweepTable)
    assert (table.scenario, table.names) == ("cliff", ("alpha", "epsilon", "algorithm"))
    assert table.judged_by == "area"
    assert dict(table.measures) == {"area": "return per episode", "arrival": "episodes to 5 %"}
    assert len(table.cells) == 12
    first = table.cells[0]
    assert first.settings == {"alpha": 0.01, "epsilon": 0.0, "algorithm": "sarsa"}
    assert list(table.bests) == [first.settings]
    assert first.spreads["area"] == CellSpread(0.51, 0.51 - 1.0, 1.51)
    assert [cell.like_best for cell in table.cells[:3]] == [True, True, False]


def test_arrivals_of_which_some_are_not_known_have_the_mean_of_what_was_seen(tmp_path: Path) -> None:
    table = read_results(written(tmp_path, sweep(*grid())))
    assert isinstance(table, SweepTable)
    assert table.cells[0].spreads["arrival"] == CellSpread(7.0, 6.0, 8.0, is_restricted=True)


def test_measures_may_be_names_alone(tmp_path: Path) -> None:
    table = read_results(written(tmp_path, sweep(*grid(), measures=["arrival", "area"], measure=None)))
    assert isinstance(table, SweepTable)
    assert (dict(table.measures), table.judged_by) == ({"arrival": "arrival", "area": "area"}, "arrival")


@pytest.mark.parametrize(
    ("values", "vary", "logarithmic"),
    [
        (STEP_SIZES, None, {"alpha"}),
        ((0.1, 0.2, 0.3), None, set()),
        ((0.01, 0.02), None, set()),
        ((0.01, 0.5), ["alpha=0.01:0.5:log:2"], {"alpha"}),
        ((0.0, 0.1), ["alpha=0:0.1:2"], set()),
        ((0.01, 0.1, "sample-average"), None, set()),
    ],
)
def test_values_at_equal_ratios_stand_on_a_logarithmic_axis(
    tmp_path: Path, values: tuple[Any, ...], vary: list[str] | None, logarithmic: set[str]
) -> None:
    cells = [{"alpha": value} for value in values]
    document = sweep(*({"alpha": 0.0} for _ in values))
    for cell, settings in zip(document["cells"], cells, strict=True):
        cell.update(settings)
    table = read_results(written(tmp_path, {**document, "vary": vary}))
    assert isinstance(table, SweepTable)
    assert table.logarithmic == logarithmic


FAULTY: dict[str, tuple[str | Callable[[], object], str]] = {
    "no JSON": ("hello", "not a file of results"),
    "NaN": ('{"curve": {"episode": [NaN]}}', "NaN is not a number"),
    "a list": (list, "not a JSON object"),
    "something else": (lambda: {"a": 1}, "contains neither a curve nor a sweep"),
    "one run": (lambda: {"q": [], "policy": []}, "a single run has no curve"),
    "a curve of words": (lambda: runs({"episode": ["one"]}), "no lists of numbers"),  # type: ignore[list-item]
    "lists of different lengths": (
        lambda: runs({"episode": [1], "return_mean": []}),
        "no curve over episodes",
    ),
    "no episodes": (lambda: runs({"episode": [], "return_mean": []}), "has no episode"),
    "no names of episodes": (lambda: runs({"return_mean": [1.0]}), "no curve over episodes"),
    "no cells": (lambda: sweep({"alpha": 0.1}, cells=[]), "no trained cell"),
    "cells that are numbers": (lambda: sweep({"alpha": 0.1}, cells=[1, 2]), "not a JSON object"),
    "a mean that is too large": (
        lambda: sweep({"alpha": 0.1}, cells=[{"alpha": 0.1, "area": {"mean": -1e308}}]),
        "numbers within",
    ),
    "a setting of hundreds of digits": (
        lambda: sweep({"alpha": 0.1}, cells=[{"alpha": 10**400, "area": {"mean": 1.0}}]),
        "setting that varies",
    ),
    "a curve of hundreds of digits": (
        lambda: runs({"episode": [1], "return_mean": [10**400]}),
        "numbers within",
    ),
    "no measures": (lambda: sweep({"alpha": 0.1}, measures=[]), "has no metric"),
    "other measures": (lambda: sweep({"alpha": 0.1}, measures=["regret"]), "has a metric"),
    "a setting that is a list": (lambda: sweep({"alpha": 0.1}, {"epsilon": 0.2}), "setting that varies"),
    "a mean that is a word": (
        lambda: sweep({"alpha": 0.1}, cells=[{"alpha": 0.1, "area": {"mean": "much"}}]),
        "not a number",
    ),
}


@pytest.mark.parametrize(("content", "said"), FAULTY.values(), ids=FAULTY)
def test_what_is_no_results_is_told_in_one_line(
    tmp_path: Path, content: str | Callable[[], object], said: str
) -> None:
    path = tmp_path / "results.json"
    if isinstance(content, str):
        path.write_text(content, encoding="utf-8")
    else:
        written(tmp_path, content())
    with pytest.raises(UserError) as told:
        read_results(path)
    assert str(told.value).startswith(f"{path}: ")
    assert said in str(told.value)
    assert "\n" not in str(told.value)


@pytest.mark.parametrize("content", [b"", b"a,b\n1\n", b"a,b\n1,x\n", b"\xff\xfe", b'a\n"1'])
def test_a_csv_that_is_no_curve_is_told_in_one_line(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "curve.csv"
    path.write_bytes(content)
    with pytest.raises(UserError) as told:
        read_results(path)
    assert "\n" not in str(told.value)


def test_a_file_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="no such file"):
        read_results(tmp_path / "no.json")
    with pytest.raises(UserError, match="a folder"):
        read_results(tmp_path)
