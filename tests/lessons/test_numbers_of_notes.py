"""Every number in notes of scenarios is computed again."""

from __future__ import annotations

import functools
import math
import re
import tomllib
from pathlib import Path
from typing import Final

import pytest
from numbers_said import (
    FOLDER,
    HOW_TO_HOLD,
    Mention,
    Said,
    held_by_tests,
    mentions,
    number,
    numbers_in,
    plain,
    said_of,
)
from recipes import recipe
from test_figures_of_notes import CLAIMS

from rl_tui.lessons.figures.expression import SeedMean
from rl_tui.lessons.figures.written import written_number
from rl_tui.runs.recipe import begin
from rl_tui.worlds.drawing import Grid
from rl_tui.worlds.files.catalogue import find, scenarios

IDS: Final = tuple(scenario.id for scenario in scenarios())
NEIGHBOURS: Final = [
    Path(__file__).with_name(name) for name in ("test_figures_of_notes.py", "test_exact_claims_of_notes.py")
]
FIGURES: Final = [(text_id, name) for text_id in IDS for name in said_of(text_id).figures_by_name]
EXACT, OVER_SEEDS = (
    [each for each in FIGURES if said_of(each[0]).figures.needs_seeds(each[1]) is needs_seeds]
    for needs_seeds in (False, True)
)
FIRST_OVER_SEEDS: Final = {each[0]: each for each in reversed(OVER_SEEDS) if each[0] != "cartpole"}.values()
_RUNS: Final = re.compile(r" (?:\w+ )?(?:runs?|seeds?|lakes)\b")
_PAYS: Final = re.compile(r"\b(?:costs?|pays?|brings|reward (?:of|is)) −?$|\+$")
_EPISODES: Final = re.compile(r" (?:\w+ )?(?:episodes?|pulls?|walks?|hands?)\b")


def text_of(scenario: str) -> str:
    file = find(scenario)
    return plain(f"{file.summary} {file.notes}")


@functools.cache
def rewards_of(scenario: str) -> frozenset[float]:
    """The absolute rewards of its table and of its file. In a table a goal includes the cost of its step."""
    mdp = begin(recipe(scenario)).world.mdp
    if mdp is None:
        return frozenset()
    of_file = re.findall(r"reward = -?([\d.]+)", find(scenario).text)
    return frozenset({*map(float, of_file), *map(abs, mdp.reward.tolist())})


@functools.cache
def own_numbers(scenario: str) -> frozenset[float]:
    file = find(scenario)
    raw = {name: value for name, value in tomllib.loads(file.text).items() if name != "notes"}
    world = begin(recipe(scenario)).world
    numbers = {0.0, 1.0, *numbers_in(raw)}
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
    said, notes = said_of(scenario), text_of(scenario)
    assert [piece for piece in (*said.pieces, *said.quoted, *said.chosen) if piece not in notes] == []


def test_each_file_is_of_a_text() -> None:
    assert {path.stem for path in FOLDER.glob("*.toml")} <= {
        *IDS,
        "README",
        "help",
        "agents",
        "guides",
    }


@pytest.mark.parametrize(("scenario", "name"), EXACT, ids=str)
def test_a_figure_is_so(scenario: str, name: str) -> None:
    assert said_of(scenario).figures.finding(name) is None


@pytest.mark.slow
@pytest.mark.parametrize(
    ("scenario", "name"),
    [
        pytest.param(
            *each, marks=() if each in FIRST_OVER_SEEDS else pytest.mark.exhaustive("trains many seeds")
        )
        for each in OVER_SEEDS
    ],
    ids=str,
)
def test_a_figure_over_seeds_is_so(scenario: str, name: str) -> None:
    """A mean of fewer runs lies within four standard errors of both."""
    said = said_of(scenario)
    found, written = said.figures.value(name), written_number(said.figures_by_name[name].value)
    assert written is not None
    if isinstance(found, SeedMean) and written.error is not None:
        assert abs(found - written.value) <= 4 * math.hypot(written.error.value, found.error)
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


def settings_of(said: Said) -> frozenset[float]:
    claims = [claim for claim in CLAIMS if claim.scenario == said.id]
    numbers = {float(each) for each in re.findall(r"(?<![\w.])\d+(?:\.\d+)?", said.expressions)}
    numbers |= {float(claim.episodes) for claim in claims}
    return frozenset(numbers.union(*(numbers_in(claim.values) for claim in claims)))


@pytest.mark.parametrize("scenario", IDS)
def test_every_number_is_held(scenario: str) -> None:
    said, own = said_of(scenario), own_numbers(scenario)
    settings, rewards = settings_of(said), rewards_of(scenario)
    neighbours = [piece for path in NEIGHBOURS for piece in held_by_tests(path)]

    def needs_nothing(mention: Mention) -> bool:
        value = number(mention.number)
        if rewards and _PAYS.search(mention.before):
            return value in rewards
        if _RUNS.match(mention.behind):  # the precision of a figure: the notes use more runs than this test
            return mention.has_piece
        is_condition = mention.has_piece and (
            mention.is_setting or _EPISODES.match(mention.behind) is not None
        )
        return value in own or mention.is_setting_to_try or (is_condition and value in settings)

    names = [name for name in begin(recipe(scenario)).world.space.state_names if not name.isdecimal()]
    found = mentions(text_of(scenario), [*said.pieces, *neighbours], [*said.quoted, *said.chosen, *names])
    unheld = [mention for mention in found if not needs_nothing(mention)]
    assert not unheld, HOW_TO_HOLD.format(scenario)
