"""The scenarios in their groups; before them the row of the lessons, and one that needs no further key."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

from textual.content import Content
from textual.widgets import OptionList
from textual.widgets.option_list import Option

from rl_tui.common.errors import ScenarioError
from rl_tui.common.findings import one_line
from rl_tui.screen.draw.to_ascii import to_ascii
from rl_tui.screen.theme.look import Look
from rl_tui.worlds.files.catalogue import YOURS, Catalogue, group_of
from rl_tui.worlds.files.scenario import Scenario

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
