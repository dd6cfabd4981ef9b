"""The scenarios of the catalogue: what is said of each, and their list in groups."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Final

from rich.console import Console, ConsoleOptions, Group, RenderableType, RenderResult
from rich.measure import Measurement
from rich.table import Table
from rich.text import Text

from rl_tui.agents.catalogue import BY_ID
from rl_tui.agents.hyperparameters import PARAMETERS
from rl_tui.common.errors import UserError
from rl_tui.common.words import counted
from rl_tui.screen.draw.canvas import KEPT_BLANK, kept, wrapped
from rl_tui.screen.draw.to_ascii import separated, to_ascii
from rl_tui.screen.theme.look import Look
from rl_tui.worlds.files.scenario import Scenario
from rl_tui.worlds.world import World

if TYPE_CHECKING:
    from rl_tui.live.sessions.progress import LessonEntries


from collections.abc import Iterator
from dataclasses import dataclass

from textual.content import Content
from textual.widgets import OptionList
from textual.widgets.option_list import Option

from rl_tui.common.errors import ScenarioError
from rl_tui.common.findings import one_line
from rl_tui.worlds.files.catalogue import YOURS, Catalogue, group_of

_DOT: Final = " · "
_SHORT: Final = 30
_WATCHING: Final = (
    "An agent learns to cross a frozen lake. Once it has met the goal, values spread from there, and arrows "
    "point the way."
)
_LEARNING: Final = (
    "A program can learn from rewards alone, by trying. Short lessons show how: say what will happen, do it "
    "yourself in a small world, compare, and read why."
)
_ABLE: Final = (
    "name agent, state, action and reward",
    "work out what a choice is worth",
    "tell when a state says all that counts",
    "read the Bellman equation in plain words",
    "do Q-learning by hand, and write it",
    "try new things just often enough",
)
"""What one will be able to do after the lessons."""
_KEYS: Final = {
    "enter": "begin; nothing else has to be pressed",
    "space": "pause, and go on",
    "+ −": "another speed",
    "?": "what is on the screen",
}


def about(scenario: Scenario, look: Look) -> RenderableType:
    """Return what a person has to know first: the summary, and what the scenario teaches."""
    lines = [Text(to_ascii(scenario.summary, look.glyphs), look.palette.text)]
    if lesson := lesson_of(scenario.notes):
        lines.append(
            Text.assemble(("teaches ", look.palette.dim), (to_ascii(lesson, look.glyphs), look.palette.text))
        )
    return Group(*lines)


def lesson_of(notes: str) -> str:
    """Return the lesson that the first heading of ``notes`` names; empty where there is no such heading."""
    found = re.match(r"\s*\*\*What it teaches: (.+?)\*\*", notes, re.DOTALL)
    return " ".join(found[1].split()).removesuffix(".") if found else ""


def facts(scenario: Scenario, world: World | UserError | None, look: Look) -> RenderableType:
    """Return the lines below the drawing; ``world`` is None while it is being built."""
    lines = {"sizes": sizes(world), "defaults": defaults(scenario.defaults)}
    return labelled({label: _Parts(line, look) for label, line in lines.items()}, look)


def about_learning(found: LessonEntries | None, look: Look) -> RenderableType:
    """Return what the lessons are for; ``found`` is None while they are being read."""
    rows = {"lessons": "loading …", "enter": "all lessons, and how far you are"}
    if found is not None:
        minutes = sum(entry.lesson.minutes for entry in found.entries)
        finished = f"{found.finished or 'none'} finished"
        rows["lessons"] = f"{len(found.entries)} · about {minutes} min · {finished}"
    return Group(
        Text(to_ascii(_LEARNING, look.glyphs), look.palette.text),
        Text("\nAfterwards you can", look.palette.dim),
        bullets(_ABLE, look),
        Text(""),
        labelled({label: Text(separated(line, look.glyphs)) for label, line in rows.items()}, look),
    )


def about_watching(look: Look) -> Text:
    """Return what there is to see where it is watched."""
    return Text(_WATCHING, look.palette.text)


def keys_while_watching(look: Look) -> Table:
    """Return what can be pressed once it is watched."""
    rows = ((to_ascii(key, look.glyphs), Text(to_ascii(what, look.glyphs))) for key, what in _KEYS.items())
    return _in_two_columns(rows, look)


def bullets(lines: Iterable[str], look: Look) -> Table:
    """Return ``lines``, each after a dash; where one is broken it goes on behind that."""
    dash = to_ascii("–", look.glyphs)
    return _in_two_columns(((dash, Text(to_ascii(line, look.glyphs))) for line in lines), look)


def labelled(rows: Mapping[str, RenderableType], look: Look) -> Table:
    """Return a table of ``rows``, each after its label."""
    return _in_two_columns(rows.items(), look)


def _in_two_columns(rows: Iterable[tuple[str, RenderableType]], look: Look) -> Table:
    table = Table.grid(padding=(0, 1, 0, 0))
    table.add_column(no_wrap=True, style=look.palette.dim)
    table.add_column(style=look.palette.text)
    for row in rows:
        table.add_row(*row)
    return table


def sizes(world: World | UserError | None) -> str:
    """Return states, actions, pairs and limits in words."""
    if world is None:
        return "loading …"
    if isinstance(world, UserError):
        return f"unknown: {world}"
    mdp = world.space
    states, acting = counted(mdp.states, "state"), int((mdp.first_pair[1:] > mdp.first_pair[:-1]).sum())
    parts = [
        states if acting == mdp.states else f"{states}, {acting:,} with actions",
        counted(len(mdp.action_names), "action"),
        counted(mdp.pairs, "pair"),
    ]
    if world.budget is not None:
        parts.append(f"budget {world.budget:,}")
    if mdp.time_limit > 1:
        parts.append(f"time limit {mdp.time_limit:,}")
    return _DOT.join(parts)


def defaults(values: Mapping[str, object]) -> str:
    """Return the defaults of a scenario file in words, with the symbols of the playground."""
    parts = []
    for name, value in values.items():
        if name == "algorithm":
            parts.append(BY_ID[str(value)].name if str(value) in BY_ID else str(value))
        elif name in PARAMETERS:
            shown = f"{value:g}" if isinstance(value, float) else value
            parts.append(f"{PARAMETERS[name].symbol} {shown}")
        else:
            singular = name.removesuffix("s")  # what is counted has a plural as its name: episodes
            parts.append(counted(value, singular) if isinstance(value, int) else f"{name} {value}")
    return _DOT.join(parts) or "those of the program"


class FullWidth:
    """What takes all the width that there is."""

    def __rich_measure__(self, console: Console, options: ConsoleOptions) -> Measurement:
        return Measurement(1, options.max_width)


class _Parts(FullWidth):
    """Parts between dots, of which none that is short is broken across lines."""

    def __init__(self, line: str, look: Look) -> None:
        dot = separated(_DOT, look.glyphs)
        parts = separated(line, look.glyphs).split(dot)
        whole = [kept(part) if len(part) <= _SHORT else part for part in parts]
        self._text = f"{KEPT_BLANK}{dot.lstrip()}".join(whole)
        self._look = look

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        for line in wrapped(self._text, options.max_width, self._look.palette.text, self._look):
            yield from (Text(piece.text, piece.style) for piece in line)


def faults_text(head: str, faults: Iterable[object], look: Look) -> Text:
    """Return ``head`` and every fault of a file, a paragraph each."""
    text = Text(f"{head}\n", look.palette.text)
    for fault in faults:
        text.append(to_ascii(f"\n{fault}\n", look.glyphs), look.palette.bad)
    return text


# The list of scenarios


_LONGEST_NAME: Final = 255
_LEARN_ID: Final = "/learn"  # no file can have that name
_WATCH_ID: Final = "/watch"
LEARN: Final = "Learn step by step"
"""What the first row is called, which leads to the lessons."""
WATCH: Final = "Watch it learn"
"""What the second row is called."""


@dataclass(frozen=True, slots=True)
class Course:
    """The lessons, all of them."""


@dataclass(frozen=True, slots=True)
class Demonstration:
    """``scenario`` with its defaults, watched while it learns."""

    scenario: Scenario


Entry = Course | Demonstration | Scenario | ScenarioError


class ScenarioList(OptionList):
    """A list of ``catalogue``, of which ``current`` is under the cursor; faulty files stand at the end."""

    def __init__(self, look: Look, catalogue: Catalogue) -> None:
        self._look = look
        rows = list(self._rows(catalogue))
        super().__init__(*(option for option, _ in rows), id="scenarios", classes="panel")
        self.border_title = "Scenarios"
        self._entries = [entry for _, entry in rows]

    @property
    def current(self) -> Entry | None:
        """The entry under the cursor, None where there is no cursor."""
        return None if self.highlighted is None else self._entries[self.highlighted]

    def start_at(self, scenario: str) -> None:
        """Put the cursor on ``scenario``, an id, or on the first row where there is none of that name."""
        ids = [option.id for option in self.options]
        self.highlighted = ids.index(scenario) if scenario in ids else 0

    def show_finished(self, finished: int, lessons: int) -> None:
        """Say in the first row how many of the ``lessons`` are ``finished``, if one is."""
        if finished:
            done = f"{LEARN}: {finished} of {lessons} ✓"
            self.replace_option_prompt(_LEARN_ID, self._content(done))

    def _rows(self, catalogue: Catalogue) -> Iterator[tuple[Option, Entry | None]]:
        """Yield each row with what it stands for, None for a heading, which the cursor passes over."""
        yield Option(self._content(f"{LEARN}: lessons"), id=_LEARN_ID), Course()
        if catalogue.scenarios:
            yield Option(self._content(WATCH), id=_WATCH_ID), Demonstration(catalogue.scenarios[0])
        group = ""
        for scenario in catalogue.scenarios:
            if group_of(scenario) != group:
                group = group_of(scenario)
                yield self._heading(group), None
            yield Option(self._content(scenario.title), id=scenario.id), scenario
        if catalogue.broken and group != YOURS:
            yield self._heading(YOURS), None
        for error in catalogue.broken:
            name = one_line(error.faults[0].file.rsplit("/", 1)[-1], _LONGEST_NAME)
            yield Option(self._content(f"{name} (faulty)")), error

    def _heading(self, group: str) -> Option:
        return Option(self._content(f"{self._look.glyphs.axis_horizontal} {group}"), disabled=True)

    def _content(self, text: str) -> Content:
        return Content(to_ascii(text, self._look.glyphs))
