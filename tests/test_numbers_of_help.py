"""The numbers in README, docs and help."""

from __future__ import annotations

import ast
import inspect
import re
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Final

import click
import pytest
from numbers_said import HOW_TO_HOLD, held_by_tests, mentions, number, plain, said_of

from rl_tui.commands.main import program
from rl_tui.lessons.figures.written import written_number
from rl_tui.screen.frame import help as help_screen
from rl_tui.screen.glossary.glossary import glossary
from rl_tui.screen.keys.registry import ACTIONS
from rl_tui.screen.panels.catalogue import PANELS

TESTS: Final = Path(__file__).parent
AGENTS: Final = (TESTS.parent / "docs/reference/agents.md").read_text(encoding="utf-8")
README: Final = (TESTS.parent / "README.md").read_text(encoding="utf-8")
GUIDES: Final = [
    path
    for folder in ("tutorial", "how-to", "explanation")
    for path in sorted((TESTS.parent / "docs" / folder).glob("*.md"))
    if path.stem not in ("statistics", "charts-and-book-figures")
]
"""All pages except the tables of tests/measure.py and tests/studies/book_figures."""
NEIGHBOURS: Final = (TESTS / "commands/test_docs.py", TESTS / "lessons/test_figures_of_notes.py")
ELSEWHERE: Final = (
    "Python 3.11 or newer",  # below
    "exact to 1e-9.",  # test_exact.py
    "2.2: the ten-armed testbed.",  # tests/studies/book_figures, as the next
    "6.3: three methods on the cliff, by step size.",
    "8.2: planning in the Dyna maze.",
    "the 95 % interval of the mean.",  # tests/studies/statistics
    "An example: rl-tui train cliff --runs 50 --json > cliff.json",  # a choice
    "rl-tui sweep cliff --vary alpha=0.05:1:8 --vary algorithm=q-learning,sarsa --runs 30",  # a choice
    "with the same 30 seeds",  # that one
    "After about 1,320 steps",  # test_watched_lake.py, as the next two
    "it takes about 1,320 steps",
    "Step 376 is the first step onto the goal.",
    "calls one of them better in 1.3 % of all cases",  # test_many_seeds_panel.py
    "at most 19 % late",  # test_run_rows.py, as the next
    "Up to episode 6 it is exact.",
    "is within 5 % of the best",  # test_run_rows.py
    "some 300 MB for each person",  # tests/measure.py, as the next
    "with some 200 MB",
    "It needs 30 minutes.",  # the lesson's own
    "memory for going back in a run | 64 MiB |",  # rl_tui.runs.timeline.checkpoints, as the next
    "branches | 50 | | changes per run | 5,000 |",
    "time without a key | 10 minutes",  # rl_tui.screen.app
    "up to 15 steps a second",  # rl_tui.screen.panels.grid.motion
)
"""Claims that other tests check."""


def texts_of_panels() -> Iterator[str]:
    for row in PANELS:
        yield from (row.help, row.not_for_program, row.opened_by.help if row.opened_by else "")


def texts_of_glossary() -> Iterator[str]:
    for term in glossary().values():
        yield from (term.text, term.equation, term.book)


def texts_of_commands(command: click.Command = program) -> Iterator[str]:
    yield inspect.cleandoc(command.help or "")
    for parameter in command.params:
        yield getattr(parameter, "help", None) or ""
    if isinstance(command, click.Group):
        context = click.Context(command)
        for name in command.list_commands(context):
            inner = command.get_command(context, name)
            assert inner is not None
            yield from texts_of_commands(inner)


def texts_of_help() -> Iterator[str]:
    for node in ast.walk(ast.parse(inspect.getsource(help_screen))):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and " " in node.value:
            yield node.value


def prose_of(page: Path) -> str:
    """Return a page without code, targets of links and the numbers of its lists."""
    text = re.sub(r"^```.*?^```$", "", page.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)
    return re.sub(r"^ {4,}.*$|^\d\. |(?<=\])\([^)]*\)", "", text, flags=re.MULTILINE)


TEXTS: Final = {
    "panels": "\n".join(dict.fromkeys(texts_of_panels())),
    "glossary": "\n".join(texts_of_glossary()),
    "actions": "\n".join(f"{action.help}" for action in ACTIONS),
    "commands": "\n".join(dict.fromkeys(texts_of_commands())),
    "help": "\n".join(texts_of_help()),
    "README": README,
    "agents": re.sub(r"<!-- made by .*?<!-- end -->", "", AGENTS, flags=re.DOTALL),
    **{path.stem: prose_of(path) for path in GUIDES},
}
"""The texts by name, without the generated parts of the page of agents."""
OF_GUIDES: Final = {path.stem: "guides" for path in GUIDES}
FILES: Final = {name: OF_GUIDES.get(name, name if name in ("README", "agents") else "help") for name in TEXTS}
PAGES: Final = ("README", "agents", "guides")


@pytest.mark.parametrize("file", ["help", *PAGES])
def test_each_piece_stands_in_a_text(file: str) -> None:
    said = said_of(file)
    whole = " ".join(plain(text) for name, text in TEXTS.items() if FILES[name] == file)
    assert [piece for piece in (*said.pieces, *said.quoted, *said.chosen) if piece not in whole] == []


def figures(*, over_seeds: bool) -> list[tuple[str, str]]:
    every = [(file, name) for file in ("help", *PAGES) for name in said_of(file).figures_by_name]
    return [each for each in every if said_of(each[0]).figures.needs_seeds(each[1]) is over_seeds]


@pytest.mark.parametrize(("file", "name"), figures(over_seeds=False), ids=str)
def test_a_figure_of_help_is_so(file: str, name: str) -> None:
    assert said_of(file).figures.finding(name) is None


@pytest.mark.slow
@pytest.mark.parametrize(("file", "name"), figures(over_seeds=True), ids=str)
def test_a_figure_of_help_over_seeds_is_so(file: str, name: str) -> None:
    assert said_of(file).figures.finding(name) is None


def test_the_python_that_is_needed_is_the_one_that_installs() -> None:
    project = tomllib.loads((TESTS.parent / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert f"Python {project['requires-python'].removeprefix('>=')} or newer" in README


@pytest.mark.parametrize(
    ("file", "name"), [(file, name) for file in ("help", *PAGES) for name in said_of(file).constants], ids=str
)
def test_a_number_of_the_program_is_so(file: str, name: str) -> None:
    written, held = said_of(file).constants[name]
    found = written_number(written)
    assert found.agrees_with(held)


@pytest.mark.parametrize("name", TEXTS)
def test_every_number_of_help_is_held(name: str) -> None:
    said = said_of(FILES[name])
    neighbours = [piece for path in NEIGHBOURS for piece in held_by_tests(path)]
    found = mentions(
        plain(TEXTS[name]), [*said.pieces, *neighbours, *ELSEWHERE], [*said.quoted, *said.chosen]
    )
    unheld = [each for each in found if not each.is_setting and number(each.number) not in (0.0, 1.0)]
    assert not unheld, HOW_TO_HOLD.format(FILES[name])
