"""Every number in the notes of a scenario: it is worked out again, or it needs nothing behind it."""

from __future__ import annotations

import functools
import math
import re
import tomllib
from pathlib import Path
from typing import Final

import pytest
from numbers_said import FOLDER, Said, held_by_tests, number, numbers_in, plain, said_of, unheld_numbers
from recipes import recipe
from test_figures_of_notes import CLAIMS

from rl_tui.lab.lessons.figures.expression import Estimate
from rl_tui.lab.lessons.figures.written import written_number
from rl_tui.lab.run.recipe import begin
from rl_tui.worlds.drawing import Grid
from rl_tui.worlds.files.catalogue import find, scenarios

IDS: Final = tuple(scenario.id for scenario in scenarios())
NEIGHBOURS: Final = [
    Path(__file__).with_name(name) for name in ("test_figures_of_notes.py", "test_exact_claims_of_notes.py")
]
FIGURES: Final = [(text_id, name) for text_id in IDS for name in said_of(text_id).names]
EXACT, OVER_SEEDS = (
    [each for each in FIGURES if said_of(each[0]).figures.needs_seeds(each[1]) is needs_seeds]
    for needs_seeds in (False, True)
)
_RUNS: Final = re.compile(r" (?:\w+ )?(?:runs?|seeds?|lakes?)\b")
_EPISODES: Final = re.compile(r" (?:\w+ )?(?:episodes?|pulls?|walks?|hands?)\b")


def held(said: Said) -> list[str]:
    """The pieces of a text that tests hold: those of its file, and those of the tests beside this one."""
    neighbours = [piece for path in NEIGHBOURS for piece in held_by_tests(path)]
    return [*said.pieces, *said.quoted, *said.chosen, *neighbours]


@functools.cache
def own_numbers(scenario: str) -> frozenset[float]:
    """0, 1, what the file says, and of its world the limits, the size of the map, rewards and chances."""
    file = find(scenario)
    raw = {name: value for name, value in tomllib.loads(file.text).items() if name != "notes"}
    made = recipe(scenario)
    world = begin(made).world
    numbers = {0.0, 1.0, *numbers_in(raw), *numbers_in(made.hyperparameters.as_dict())}
    numbers |= {float(world.space.time_limit), float(world.budget or 0)}
    if isinstance(world.drawing, Grid):
        numbers |= {float(world.drawing.rows), float(world.drawing.columns)}
    if world.mdp is not None and not file.section.drawn_from_seed:
        numbers |= {
            abs(each) for array in (world.mdp.reward, world.mdp.probability) for each in array.tolist()
        }
    return frozenset(numbers)


@pytest.mark.parametrize("scenario", IDS)
def test_each_piece_stands_in_the_notes(scenario: str) -> None:
    said, notes = said_of(scenario), plain(find(scenario).notes)
    assert [piece for piece in (*said.pieces, *said.quoted, *said.chosen) if piece not in notes] == []


def test_each_file_is_of_a_text() -> None:
    assert {path.stem for path in FOLDER.glob("*.toml")} <= {*IDS, "README", "help", "agents"}


@pytest.mark.parametrize(("scenario", "name"), EXACT, ids=str)
def test_a_figure_is_so(scenario: str, name: str) -> None:
    assert said_of(scenario).figures.finding(name) is None


@pytest.mark.slow
@pytest.mark.parametrize(("scenario", "name"), OVER_SEEDS, ids=str)
def test_a_figure_over_seeds_is_so(scenario: str, name: str) -> None:
    """A mean of fewer runs lies within four standard errors of both, as in test_figures_of_notes."""
    said = said_of(scenario)
    found, written = said.figures.value(name), written_number(said.figures_by_name[name].value)
    assert written is not None
    if isinstance(found, Estimate) and written.error is not None:
        assert abs(found - written.value) <= 4 * math.hypot(written.error.value, found.error), (
            found,
            written,
        )
    else:
        assert said.figures.finding(name) is None


@pytest.mark.parametrize("scenario", IDS)
def test_what_is_said_of_so_many_runs_is_counted_in_as_many(scenario: str) -> None:
    said = said_of(scenario)
    for piece, names in zip(said.pieces, said.names_in, strict=True):
        works = [said.figures_by_name[name].by for name in names if name in said.figures_by_name]
        seeds = {number(each) for by in works for each in re.findall(r"\bseeds=(\d+)", by)}
        for runs in re.findall(r"([\d,]+) (?:runs|seeds|lakes)\b|of (?:the )?(\d+) it\b", piece):
            assert not seeds or number(runs[0] or runs[1]) in seeds, piece


def counts_of(said: Said) -> frozenset[float]:
    """The numbers of runs, episodes and steps by which the figures and claims of a text are worked out."""
    counts = re.findall(r"(?:episodes|seeds|steps)=([\d_]+)", said.expressions)
    return frozenset(
        {float(each) for each in counts}
        | {float(claim.episodes) for claim in CLAIMS if claim.scenario == said.id}
    )


@pytest.mark.parametrize("scenario", IDS)
def test_every_number_is_held(scenario: str) -> None:
    own, said = own_numbers(scenario), said_of(scenario)
    counts = counts_of(said)

    def is_own(text: str, behind: str, has_piece: bool) -> bool:
        """A number of runs says how well a figure is known; fewer are run here than for the notes."""
        value = number(text)
        if _RUNS.match(behind):
            return has_piece
        return value in own or (_EPISODES.match(behind) is not None and has_piece and value in counts)

    assert list(unheld_numbers(plain(find(scenario).notes), held(said), is_own)) == []
