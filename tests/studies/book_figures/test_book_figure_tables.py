"""Figures of the book, recomputed with few runs."""

from __future__ import annotations

import functools
import io
import json
import math
import re
from pathlib import Path

import pytest

from rl_tui.agents.hyperparameters import PARAMETERS
from rl_tui.studies.book_figures import dyna_maze, step_sizes
from rl_tui.studies.book_figures.catalogue import FIGURES, measure
from rl_tui.studies.book_figures.figure import BookComparison, MeasuredCurve, MeasuredFigure, read_off
from rl_tui.studies.book_figures.files import HEADER, document_of, write_csv
from rl_tui.studies.book_figures.measuring import Measuring, mean_and_error, recipe_of
from rl_tui.studies.pictures.files import svg_of
from rl_tui.studies.pictures.picture import Chart

pytestmark = pytest.mark.slow

RUNS = 60
FEW_STEP_SIZES, FEW_EPISODES = (0.1, 0.9), 20_000
LONG = pytest.mark.exhaustive("figure 6.3 takes many episodes, and the loops of three algorithms")
LOOPS = pytest.mark.exhaustive("compiles the loop of another algorithm")
EVERY_FIGURE = pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks={"2.2": (), "6.3": LONG}.get(name, LOOPS)) for name in FIGURES],
)


@functools.cache
def measured(name: str) -> MeasuredFigure:
    if name == "6.3":
        return step_sizes.measure(Measuring(), RUNS, FEW_STEP_SIZES, FEW_EPISODES)
    return measure(FIGURES[name], Measuring(), RUNS)


def curve(name: str, called: str, panel: str = "") -> MeasuredCurve:
    return next(each for each in measured(name).curves if each.name == called and panel in each.panel)


def row(name: str, start: str) -> BookComparison:
    (found,) = [each for each in measured(name).table if each.what.startswith(start)]
    return found


def is_above(comparison: BookComparison) -> bool:
    """A mean of paired differences is above 0 by more than four standard errors."""
    assert comparison.ours is not None
    assert comparison.stderr is not None
    return comparison.ours > 4 * comparison.stderr


@EVERY_FIGURE
def test_all_agrees_with_the_book_but_what_is_said_to_differ(name: str) -> None:
    differing = [each.what for each in measured(name).table if not each.agrees]
    assert differing == (["steps of the first episode, 0 planning steps"] if name == "8.2" else [])
    assert all(each.place for each in measured(name).table)


@EVERY_FIGURE
def test_the_picture_has_the_curves(name: str) -> None:
    found = measured(name)
    charts = [panel for panel in found.picture.panels if isinstance(panel, Chart)]
    drawn = [curve for chart in charts for curve in chart.curves]
    assert sorted(each.name for each in drawn) == sorted(each.name for each in found.curves)
    assert all(any(value is not None for value in each.low) for each in drawn)
    assert svg_of(found.picture).startswith("<svg")


@EVERY_FIGURE
def test_json_and_csv_have_the_same_curves(name: str) -> None:
    found = measured(name)
    document = json.loads(json.dumps(document_of(FIGURES[name], found, RUNS, 0, 1.0), allow_nan=False))
    assert (document["figure"], document["runs"]) == (name, RUNS)
    assert len(document["table"]) == len(found.table)
    stream = io.StringIO()
    write_csv(stream, found)
    head, *rows = stream.getvalue().splitlines()
    assert head == ",".join(HEADER)
    assert len(rows) == sum(len(each["x"]) for each in document["curves"])
    first = document["curves"][0]
    values = [rows[0].rsplit(",", 3)[place + 1] for place in range(3)]
    assert [float(each) for each in values] == [first["x"][0], first["mean"][0], first["stderr"][0]]


# Figure 2.2


def test_the_best_arm_pays_the_expected_maximum_of_ten_normal_means() -> None:
    best = row("2.2", "reward of the best arm")
    assert best.ours is not None
    assert best.stderr is not None
    # the mean of the largest of ten draws from N(0, 1): H. L. Harter, Biometrika 48 (1961)
    assert abs(best.ours - 1.53875) < 4 * best.stderr


# Example 6.6 and figure 6.3


@LONG
def test_expected_sarsa_is_best_soon_and_in_the_long_run() -> None:
    for other in ("SARSA", "Q-learning"):
        assert is_above(row("6.3", f"interim, Expected SARSA minus {other}"))
    ends = {name: curve("6.3", f"{name}, asymptotic").mean[-1] for name in step_sizes.NAMES.values()}
    assert ends["Expected SARSA"] > max(ends["SARSA"], ends["Q-learning"]) + 10


@LONG
def test_a_large_step_size_spoils_sarsa_in_the_long_run_alone() -> None:
    spoiled = row("6.3", "asymptotic, SARSA: α = 0.9 minus")
    assert spoiled.ours is not None
    assert spoiled.ours < -20
    interim = curve("6.3", "SARSA, interim").mean
    assert interim[1] > interim[0] + 20


@LONG
def test_the_long_run_has_ten_runs_at_most_and_that_is_said() -> None:
    assert "of 10 runs" in measured("6.3").notes[0]
    assert f"{FEW_EPISODES:,} episodes" in measured("6.3").notes[0]


# Figure 8.2


def test_a_random_walk_takes_as_long_as_its_linear_equations_say() -> None:
    assert dyna_maze.steps_of_a_random_walk() == pytest.approx(868.7254275614714)


@LOOPS
def test_the_first_episode_is_a_random_walk() -> None:
    first = row("8.2", "steps of the first episode, 0 planning steps")
    assert first.ours is not None
    assert first.stderr is not None
    assert abs(first.ours - 868.7254) < 4 * first.stderr
    assert not first.agrees
    assert "868.7" in measured("8.2").notes[0]


def test_a_curve_that_never_gets_short_has_no_first_short_episode() -> None:
    assert dyna_maze.first_short({"episode": [1, 2], "length_mean": [90.0, 21.0]}) is None
    assert not BookComparison("", "", "", 0, 1, None).agrees


# The documentation


def shown(name: str) -> list[str]:
    page = (Path(__file__).parents[3] / "docs/how-to/charts-and-book-figures.md").read_text(encoding="utf-8")
    rows = [line.strip("| ").split(" | ") for line in page.splitlines() if line.startswith("|")]
    first = next(
        place for place, cells in enumerate(rows) if cells[0].strip("`").split("`")[0].startswith(name)
    )
    return [cells[-1] for cells in rows[first : first + len(measured(name).table)]]


@pytest.mark.exhaustive("as many runs as the page says")
@pytest.mark.parametrize("name", ["cliff", "8.2"])
def test_the_documentation_has_the_numbers_that_are_measured(name: str) -> None:
    found = measure(FIGURES[name], Measuring(), FIGURES[name].runs)
    for text, comparison in zip(shown(name), found.table, strict=True):
        ours, *stderr = re.findall(r"[−\d.,]*\d", text)
        assert rounded(comparison.ours, ours) == ours
        if stderr:
            assert rounded(comparison.stderr, stderr[0]) == stderr[0]


def rounded(value: float | None, like: str) -> str:
    assert value is not None
    return f"{value:,.{len(like.partition('.')[2])}f}".replace("-", "−")


# Rules for all figures


def test_seeds_determine_a_figure_and_other_seeds_another_one() -> None:
    first, again, other = (dyna_maze.measure(Measuring(seed), 3) for seed in (0, 0, 7))
    assert first.table == again.table
    assert first.curves == again.curves
    assert first.curves != other.curves


def test_one_run_has_no_standard_errors_and_is_drawn_all_the_same() -> None:
    for name in ("2.2", "cliff", "8.2"):
        found = measure(FIGURES[name], Measuring(), 1)
        assert all(each.stderr is None for each in found.table)
        assert all(set(each.stderr) == {None} for each in found.curves)
        assert svg_of(found.picture).startswith("<svg")
    assert mean_and_error([3.0]) == (3.0, None)


def test_progress_goes_to_its_end() -> None:
    reported: list[tuple[int, int]] = []
    dyna_maze.measure(Measuring(on_progress=lambda *each: reported.append(each)), 2)
    assert reported[-1] == (3 * 2 * dyna_maze.EPISODES, 3 * 2 * dyna_maze.EPISODES)
    assert [done for done, _ in reported] == sorted(done for done, _ in reported)
    assert {wanted for _, wanted in reported} == {3 * 2 * dyna_maze.EPISODES}


def test_settings_are_those_of_the_book_whatever_the_scenario_suggests() -> None:
    recipe = recipe_of("maze", seed=3, algorithm="sarsa", alpha=0.1)
    assert recipe.seed == 3
    settings = {name: recipe.hyperparameters.value(name) for name in PARAMETERS}
    assert (settings["initial_q"], settings["ties"], settings["epsilon_decay"]) == (0.0, "random", 0.0)
    assert recipe.scenario.source.name == "maze.toml"


def test_numbers_agree_within_what_can_be_read_and_three_standard_errors() -> None:
    assert read_off("", -25, 5, -31.0, 0.4).agrees
    assert not read_off("", -25, 5, -31.0, 0.3).agrees
    assert read_off("", -25, 5, -21.0, None).agrees
    assert read_off("", -25, 5, -21.0, None).book == "−25 ± 5"
    assert BookComparison("", "", "", 0.0, math.inf, 3.0, 0.0).agrees
