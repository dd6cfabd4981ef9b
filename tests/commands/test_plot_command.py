"""``plot``."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest
from called import assert_refused
from called import called as run

CELLS = [
    {"alpha": alpha, "epsilon": epsilon, "runs": 3, "failed": 0, "area": {"mean": alpha + epsilon}}
    for alpha in (0.1, 0.2)
    for epsilon in (0.0, 0.5)
]
SWEEP = {"scenario": "cliff", "measures": ["area"], "cells": CELLS, "best": CELLS[3]}


@pytest.fixture
def curve(tmp_path: Path) -> str:
    path = tmp_path / "student.csv"
    assert run("train", "student", "--runs", "3", "--episodes", "40", "--curve", str(path)).exit_code == 0
    return str(path)


def curve_in(svg: str) -> list[tuple[float, float]]:
    (line,) = re.findall(r'<polyline points="([^"]+)"[^>]*clip-path', svg)
    return [(float(x), float(y)) for x, y in (point.split(",") for point in line.split())]


def test_what_train_prints_is_drawn_whether_json_or_csv(curve: str, tmp_path: Path) -> None:
    document = tmp_path / "student.json"
    document.write_text(run("train", "student", "--runs", "3", "--episodes", "40", "--json").stdout)
    pictures = []
    for name in (curve, str(document)):
        out = tmp_path / "picture.svg"
        result = run("plot", name, "--out", str(out))
        assert (result.exit_code, result.output) == (0, "")
        pictures.append(out.read_text(encoding="utf-8"))
    by_normal, by_t = (curve_in(each) for each in pictures)
    assert [x for x, _ in by_normal] == [x for x, _ in by_t]
    assert len(by_t) == 40
    # the bands differ, and so may the axes: otherwise the line is the same
    heights = [[y for _, y in each] for each in (by_normal, by_t)]
    assert np.corrcoef(heights)[0, 1] == pytest.approx(1.0, abs=1e-3)


def test_without_a_file_it_is_drawn_in_the_terminal(curve: str) -> None:
    result = run("plot", curve)
    assert (result.exit_code, result.stderr) == (0, "")
    assert "Return per episode" in result.stdout
    assert any("⠀" < character <= "⣿" for character in result.stdout)


def test_a_sweep_is_an_atlas_or_lines(tmp_path: Path) -> None:
    path = tmp_path / "sweep.json"
    path.write_text(json.dumps(SWEEP))
    atlas = run("plot", str(path)).stdout
    assert "0.7*" in atlas
    assert "α (alpha)" in atlas
    lines = run("plot", str(path), "--x", "epsilon").stdout
    assert "α = 0.1" in lines
    assert "α = 0.2" in lines
    assert run("plot", str(path), "--out", str(tmp_path / "a.svg")).exit_code == 0
    assert (tmp_path / "a.svg").stat().st_size > 1_000


@pytest.mark.parametrize(
    ("more", "status", "said"),
    [
        (("--out", "x.pdf"), 2, "does not end in .svg or .png"),
        (("--x", "alpha"), 1, "for sweeps"),
        (("--measure", "regret"), 1, "choose --measure"),
        (("no.json",), 1, "no such file"),
    ],
)
def test_faults_are_one_line(curve: str, more: tuple[str, ...], status: int, said: str) -> None:
    assert_refused(run("plot", curve, *more), status, said)


def test_it_wants_results() -> None:
    assert run("plot").exit_code == 2
