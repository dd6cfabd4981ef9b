"""``figure``."""

from __future__ import annotations

import csv
import json
import sys
from functools import partial
from pathlib import Path

import pytest
from called import called

from rl_tui.studies.book_figures.catalogue import FIGURES
from rl_tui.studies.book_figures.figure import MeasuredCurve, MeasuredFigure
from rl_tui.studies.pictures.picture import Chart, ChartCurve, Picture, round_axis

run = partial(called, "figure")


@pytest.mark.exhaustive("measures figures of the book, which other tests hold")
def test_ours_stand_beside_the_numbers_of_the_book() -> None:
    result = run("8.2", "--runs", "4")
    assert (result.exit_code, result.stderr) == (0, "")
    assert "figure 8.2, page 165" in result.stdout
    assert "means of 4 runs, in the book of 30" in result.stdout
    table = result.stdout.split("\n\n")[1].splitlines()
    assert table[0].split() == ["book", "where", "ours", "agrees"]
    assert all(line.endswith(("yes", "no")) for line in table[1:])
    assert "868.7 steps" in result.stdout
    assert "⣀" in result.stdout  # the curves


@pytest.mark.exhaustive("measures a figure of the book")
def test_with_a_file_the_picture_is_there_and_nowhere_else(tmp_path: Path) -> None:
    path = tmp_path / "maze.svg"
    result = run("8.2", "--runs", "3", "--out", str(path))
    assert result.exit_code == 0
    assert "⣀" not in result.stdout
    assert path.read_text(encoding="utf-8").startswith("<svg")


@pytest.mark.exhaustive("measures a figure of the book")
def test_json_is_one_document_and_csv_has_its_curves(tmp_path: Path) -> None:
    path = tmp_path / "maze.csv"
    result = run("8.2", "--runs", "3", "--json", "--csv", str(path), "--seed", "5")
    assert (result.exit_code, result.stderr) == (0, "")
    document = json.loads(result.stdout)
    assert (document["figure"], document["runs"], document["book_runs"], document["seed"]) == (
        "8.2",
        3,
        30,
        5,
    )
    with path.open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert [float(row["mean"]) for row in rows] == [
        mean for each in document["curves"] for mean in each["mean"]
    ]
    assert {row["curve"] for row in rows} == {each["curve"] for each in document["curves"]}


def test_csv_on_stdout_is_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    chart = Chart(
        "", round_axis("", [0.0, 1.0]), round_axis("", [0.0, 1.0]), (ChartCurve("a", (0, 1), (0, 1)),)
    )
    curve = MeasuredCurve("", "a", [0, 1], [0.0, 0.5], [None, 0.25])
    measured = MeasuredFigure((), (curve,), Picture("", "", (chart,)))
    monkeypatch.setattr("rl_tui.studies.book_figures.catalogue.measure", lambda *_: measured)
    result = run("8.2", "--csv", "-")
    assert (result.exit_code, result.stdout) == (0, "panel,curve,x,mean,stderr\n,a,0,0.0,\n,a,1,0.5,0.25\n")
    assert "page 165" in result.stderr
    assert any("⠀" < character <= "⣿" for character in result.stderr)


@pytest.mark.parametrize(
    ("args", "said"),
    [
        (("9.9",), "'9.9' is not one of"),
        ((), "Missing argument"),
        (("8.2", "--out", "x.jpg"), "does not end in .svg or .png"),
        (("8.2", "--runs", "0"), "a whole number in"),
        (("8.2", "--csv", "x.svg", "--out", "x.svg"), "both write to the same file"),
    ],
)
def test_wrong_usage(args: tuple[str, ...], said: str) -> None:
    result = run(*args)
    assert (result.exit_code, result.stdout) == (2, "")
    assert said in result.stderr


def test_what_cannot_be_written_is_told_before_anything_is_learned(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def measure(*_: object) -> None:
        raise AssertionError("it is told first")

    monkeypatch.setattr("rl_tui.studies.book_figures.catalogue.measure", measure)
    for option, name in (("--out", "a.svg"), ("--out", "a.png"), ("--csv", "a.csv")):
        result = run("8.2", option, str(tmp_path / "no" / name))
        assert (result.exit_code, result.stderr.count("\n")) == (1, 1)
    monkeypatch.setitem(sys.modules, "resvg_py", None)
    result = run("8.2", "--out", str(tmp_path / "a.png"))
    assert (result.exit_code, result.stderr.count("\n")) == (1, 1)
    assert "rl-tui[plot]" in result.stderr


def test_the_help_names_all_figures() -> None:
    help_text = run("--help").stdout
    assert all(name in help_text for name in FIGURES)
