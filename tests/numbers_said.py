"""The numbers in texts: those checked by a file in ``tests/said/``, and those that need no check.

Each file belongs to one text, to the help, or to all guides. Its keys are:

* ``said``: pieces of the text with names of figures in braces (``{name:words}``: written as a word).
* ``[figures]``: how each figure is computed, as in a lesson (docs/how-to/write-a-lesson.md).
* ``[copies.NAME]``: a copy of the scenario file with other values of some keys, as the setup NAME.
* ``[constants]``: numbers that the program holds under a name.
* ``quoted``: numbers with another source, named beside them.
* ``chosen``: numbers that the text chooses and that match no rule below.
"""

from __future__ import annotations

import ast
import functools
import importlib
import itertools
import re
import tomllib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from rl_tui.lessons.figures.figures import LessonFigures
from rl_tui.lessons.figures.written import written_number
from rl_tui.lessons.file.schema import Figure, Setup
from rl_tui.lessons.lesson import Lesson
from rl_tui.worlds.files.catalogue import find
from rl_tui.worlds.files.scenario import Scenario

FOLDER: Final = Path(__file__).parent / "said"
HOW_TO_HOLD: Final = (
    "tests/said/{}.toml has to say what these numbers are worked out by, or that they are quoted or chosen; "
    "tests/numbers_said.py describes such a file"
)
HERE: Final = "here"
_PLACEHOLDER: Final = re.compile(r"\{([a-z][a-z0-9_]*)(?::(words|Words|th))?\}")
_WORDS: Final = (
    *("zero", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten"),
    *("eleven", "twelve", "thirteen", "fourteen", "fifteen", "sixteen", "seventeen", "eighteen"),
    *("nineteen", "twenty"),
)
_NUMBER: Final = re.compile(r"(?<![\w.])\.?\d+(?:,\d{3})*(?:\.\d+)?(?:e[-+]?\d+)?")
_SENTENCE: Final = re.compile(r"(?<=[.?!])\*{0,2} (?:\* )?(?=[^a-z])")


@dataclass(frozen=True, slots=True)
class Said:
    id: str
    pieces: tuple[str, ...]
    names_in: tuple[tuple[str, ...], ...]
    """The names of figures in each of the pieces."""
    quoted: tuple[str, ...]
    chosen: tuple[str, ...]
    lesson: Lesson
    figures: LessonFigures
    constants: Mapping[str, tuple[str, float]]
    """By name: the number as written, and its value in the program."""

    @property
    def expressions(self) -> str:
        return " ".join(figure.by for figure in self.figures_by_name.values())

    @property
    def figures_by_name(self) -> Mapping[str, Figure]:
        return self.lesson.figures


@functools.cache
def said_of(text_id: str) -> Said:
    path = FOLDER / f"{text_id}.toml"
    table = tomllib.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
    copies = {name: copied(find(text_id), changes) for name, changes in table.get("copies", {}).items()}
    figures = {name: Figure(**row) for name, row in table.get("figures", {}).items()}
    setups = {HERE: Setup(scenario=table.get("scenario", text_id))}
    setups |= {name: Setup(world=world) for name, world in copies.items()}
    lesson = Lesson(text_id, text_id, "", 0, 1, (), figures, setups, (), path, "")
    constants = {
        name: (row["value"], _held(row["is"]) + row.get("and", 0))
        for name, row in table.get("constants", {}).items()
    }
    values = {name: figure.value for name, figure in figures.items()}
    values |= {name: value for name, (value, _) in constants.items()}
    every = table.get("said", ())
    pieces = tuple(
        _PLACEHOLDER.sub(lambda match: _put_in(values[match[1]], match[2]), piece) for piece in every
    )
    names_in = tuple(tuple(match[1] for match in _PLACEHOLDER.finditer(piece)) for piece in every)
    quoted, chosen = (tuple(table.get(name, ())) for name in ("quoted", "chosen"))
    return Said(text_id, pieces, names_in, quoted, chosen, lesson, LessonFigures(lesson), constants)


def _put_in(value: str, form: str | None) -> str:
    if form is None:
        return value
    word = _WORDS[int(number(value))]
    return {"words": word, "Words": word.capitalize(), "th": f"{word}th"}[form]


def copied(scenario: Scenario, changes: Mapping[str, str]) -> str:
    """Return the file of ``scenario`` with other values of some keys. New keys follow ``moves``."""
    text = re.sub(r'^notes = """.*?^"""$', "", scenario.text, flags=re.MULTILINE | re.DOTALL)
    for key, value in changes.items():
        line = f"{key} = {value}"
        text, found = re.subn(rf"^{re.escape(key)} = .*$", line, text, flags=re.MULTILINE)
        if not found:
            text = re.sub(r"^moves = .*$", rf"\g<0>\n{line}", text, flags=re.MULTILINE)
        assert line in text
    return text


def _held(name: str) -> float:
    """Return the number ``module:NAME``, its item ``module:NAME[2]``, or the length."""
    found = re.fullmatch(r"([\w.]+):(\w+)(?:\[(\d+)\])?", name)
    assert found, name
    module, constant, place = found.groups()
    value = getattr(importlib.import_module(module), constant)
    if place is not None:
        value = value[int(place)]
    return float(len(value) if isinstance(value, tuple) else value)


def plain(text: str) -> str:
    return " ".join(text.split())


@functools.cache
def held_by_tests(path: Path) -> tuple[str, ...]:
    tree = ast.parse(path.read_text(encoding="utf-8"))
    strings = {each.value for each in ast.walk(tree) if isinstance(each, ast.Constant)}
    return tuple(
        each for each in strings if isinstance(each, str) and re.search(r"\d", each) and len(each) > 5
    )


# Numbers that need no check

_N: Final = r"(?:[−-]?\.?\d+(?:,\d{3})*(?:\.\d+)?)"
_LIST: Final = rf"{_N}(?:(?:,| and| or| to|, then|;)+ {_N})*"
_SETTING: Final = r"(?:[αγεδλτκ]|\bn|\bc|\bp|[Ii]nitial Q|noise|seed|planning\*?|step_reward|`\w+`)"
RULES: Final[Mapping[str, str]] = {
    "a key, a command, a setting as it is typed": r"`[^`]*`",
    "a place in a book": (
        r"(?i:\b(?:chapter|section|example|exercise|figure|equation|lecture|page|biometrika|algorithm)s?) "
        r"\d+(?:\.\d+)*(?:(?:,| and| or| to|–)+ ?\d+\.\d+)*|\b\d(?:st|nd|rd|th) ed"
    ),
    "a year": r"(?<=[( ])(?:1[89]|20)\d\d(?=[),;:\]]| \()|\bin (?:1[89]|20)\d\d\b",
    "a speed to try": r"\d+ steps/s",
    "what the program calls the mean of the last hundred": r"\b[Ll]ast 100\b",
    "a number by which a thing is called": r"TD\(\d\)|N\(\d, \d\)|FrozenLake \d×\d",
    "a number of a list": r"(?:^| )\d\. (?=\*\*)",
    "a range that comes from the table of settings": r"a (?:whole )?number in [\[(][^\])]*[\])]",
}
"""By reason: the pattern of numbers that need no check."""
_SETTINGS: Final = (
    rf"{_SETTING} (?:(?:=|to|of|at|is|above|below|from|starts? at) )?(?:about )?{_LIST}",
    rf"(?:\b[Tt]ry|at) {_LIST}(?= (?:and|:|planning)|[:?;,])",
)
"""Patterns of numbers that are settings."""


@dataclass(frozen=True, slots=True)
class Mention:
    """A number outside all pieces and rules. With ``has_piece`` it may be a condition of that claim."""

    number: str
    before: str
    behind: str
    sentence: str
    is_setting: bool
    has_piece: bool

    @property
    def is_setting_to_try(self) -> bool:
        return self.is_setting and not self.has_piece


def mentions(text: str, pieces: Sequence[str], others: Sequence[str] = ()) -> Iterator[Mention]:
    held = [span for piece in pieces for span in _places(text, piece)]
    free = [span for piece in others for span in _places(text, piece)]
    free += [match.span() for pattern in RULES.values() for match in re.finditer(pattern, text)]
    settings = [match.span() for pattern in _SETTINGS for match in re.finditer(pattern, text)]
    breaks = [0, *(match.end() for match in _SENTENCE.finditer(text)), len(text)]
    for match in _NUMBER.finditer(text):
        place, end = match.span()
        if _is_within(place, held) or _is_within(place, free):
            continue
        first, last = next((a, b) for a, b in itertools.pairwise(breaks) if a <= place < b)
        yield Mention(
            match[0],
            text[first:place],
            text[end:last],
            text[first:last].strip(),
            _is_within(place, settings),
            any(begin < last and end > first for begin, end in held),
        )


def _is_within(place: int, spans: Iterable[tuple[int, int]]) -> bool:
    return any(first <= place < last for first, last in spans)


def _places(text: str, piece: str) -> Iterator[tuple[int, int]]:
    place = text.find(piece)
    while place >= 0:
        yield place, place + len(piece)
        place = text.find(piece, place + 1)


def number(text: str) -> float:
    found = written_number(text)
    assert found is not None, text
    return found.value


def numbers_in(value: Any) -> Iterator[float]:
    if isinstance(value, dict):
        for inner in value.values():
            yield from numbers_in(inner)
    elif isinstance(value, list):
        for inner in value:
            yield from numbers_in(inner)
    elif isinstance(value, int | float) and not isinstance(value, bool):
        yield abs(float(value))
