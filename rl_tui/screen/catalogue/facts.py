"""Texts about a scenario."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Final

from rich.cells import cell_len
from rich.console import Console, ConsoleOptions, RenderableType, RenderResult
from rich.measure import Measurement
from rich.table import Table
from rich.text import Text
from textual.geometry import Size
from textual.strip import Strip
from textual.widget import Widget

from rl_tui.agents.catalogue import BY_ID
from rl_tui.agents.hyperparameters import PARAMETERS
from rl_tui.common.errors import UserError
from rl_tui.common.words import counted
from rl_tui.screen.draw.canvas import Piece, strips_of, wrapped
from rl_tui.screen.theme.look import Look
from rl_tui.worlds.files.scenario import Scenario
from rl_tui.worlds.world import World

if TYPE_CHECKING:
    from rl_tui.lessons.lesson import Lesson

_DOT: Final = " · "

# Lessons


def minutes_of_page(lesson: Lesson) -> int:
    """Return a page's average minutes, at least 1."""
    return max(1, round(lesson.minutes / len(lesson.pages)))


# Texts about a scenario


LONGEST_LINE: Final = 60  # columns of prose
_IN_WORDS: Final = {("ties", "random"): "broken at random", ("ties", "first"): "broken by order"}


Block = tuple[str, str]  # a heading, which may be empty, and a paragraph


def blocks_of(scenario: Scenario, lessons: Sequence[str] = ()) -> list[Block]:
    """Return a scenario's texts, by importance."""
    blocks = [
        ("", scenario.summary),
        ("Guess first", scenario.guess),
        ("You will see", scenario.see or lesson_of(scenario.notes)),
        ("Try", scenario.try_this),
        ("The agent", defaults(scenario.defaults)),
        ("Used in lessons", _DOT.join(lessons)),
    ]
    return [(heading, text) for heading, text in blocks if text]


class Prose(Widget):
    """Paragraphs under headings, as many as fit."""

    def __init__(self, look: Look) -> None:
        super().__init__(id="prose")
        self._look = look
        self._blocks: Sequence[Block] = ()

    def show(self, blocks: Sequence[Block]) -> None:
        """Show ``blocks``."""
        self._blocks = blocks
        self.refresh(layout=True)

    def get_content_height(self, container: Size, viewport: Size, width: int) -> int:
        """Return the rows for the screen's height."""
        return len(self._lines(width, max(3, viewport.height // 2 - 6), inline=True))

    def render_line(self, y: int) -> Strip:
        """Draw one row."""
        size, look = self.size, self._look
        lines = self._lines(size.width, size.height, inline=not self.has_class("-beside"))
        strip = strips_of(lines[y : y + 1], size.width, 1, look)[0]
        return strip.apply_style(self.rich_style)

    def _lines(self, width: int, most: int, *, inline: bool) -> list[list[Piece]]:
        width, palette = max(1, min(width, LONGEST_LINE)), self._look.palette
        lines: list[list[Piece]] = []
        for heading, text in self._blocks:
            before = f"{heading}: " if heading and inline else ""
            block = wrapped(f"{before}{text}", width, palette.text, self._look)
            if heading and not inline:
                title = [Piece(self._look.glyphs.spelled(heading), palette.strong)]
                block = [*([[]] if lines else []), title, *block]
            if lines and len(lines) + len(block) > most:
                break
            lines += block
        return lines[:most]


def lesson_of(notes: str) -> str:
    """Return the first heading's lesson, or ""."""
    found = re.match(r"\s*\*\*What it teaches: (.+?)\*\*", notes, re.DOTALL)
    return " ".join(found[1].split()).removesuffix(".") if found else ""


def labelled(rows: Iterable[tuple[RenderableType, RenderableType]], look: Look) -> Table:
    """Return labels beside their texts."""
    table = Table.grid(padding=(0, 1, 0, 0))
    table.add_column(no_wrap=True, style=look.palette.dim)
    table.add_column(style=look.palette.text)
    for row in rows:
        table.add_row(*row)
    return table


def sizes(world: World | UserError | None) -> str:
    """Describe sizes and limits."""
    if world is None:
        return "loading …"
    if isinstance(world, UserError):
        return f"unknown: {world}"
    mdp = world.space
    states, acting = counted(mdp.states, "state"), int((mdp.first_pair[1:] > mdp.first_pair[:-1]).sum())
    parts = [
        states if acting == mdp.states else f"{states}, {acting:,} with actions",
        counted(len(mdp.action_names), "action"),
    ]
    if world.budget is not None:
        parts.append(f"budget {world.budget:,}")
    if mdp.time_limit > 1:
        parts.append(f"{mdp.time_limit:,} steps max")
    return _DOT.join([*parts, counted(mdp.pairs, "state–action pair")])


def defaults(values: Mapping[str, object]) -> str:
    """Describe a scenario file's defaults."""
    parts = []
    for name, value in values.items():
        if name == "algorithm":
            parts.append(BY_ID[str(value)].name if str(value) in BY_ID else str(value))
        elif name in PARAMETERS:
            shown = f"{value:g}" if isinstance(value, float) else str(value)
            setting = "initial Q" if name == "initial_q" else PARAMETERS[name].symbol
            parts.append(f"{setting} {_IN_WORDS.get((name, shown), shown)}")
        else:
            singular = name.removesuffix("s")  # a count has a plural name, such as episodes
            parts.append(counted(value, singular) if isinstance(value, int) else f"{name} {value}")
    return _DOT.join(parts) or "the defaults of the program"


def size_line(world: World | UserError | None, look: Look) -> RenderableType:
    """Return sizes in a row, or an error."""
    if isinstance(world, UserError):
        return Text(look.glyphs.spelled(sizes(world)), look.palette.text)
    return PartsLine(sizes(world), look)


class FullWidth:
    """A renderable as wide as possible."""

    def __rich_measure__(self, console: Console, options: ConsoleOptions) -> Measurement:
        return Measurement(1, options.max_width)


class PartsLine(FullWidth):
    """As many parts as fit in a row."""

    def __init__(self, line: str, look: Look) -> None:
        self._parts, self._look = line.split(_DOT), look

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        parts = self._parts
        while len(parts) > 1 and cell_len(_DOT.join(parts)) > options.max_width:
            parts = parts[:-1]
        yield Text(self._look.glyphs.separated(_DOT.join(parts)), self._look.palette.dim, no_wrap=True)


def faults_text(what: str, faults: Iterable[object], look: Look) -> Text:
    """Return ``what``, and a paragraph per error."""
    text = Text(f"{what}\n", look.palette.text)
    for fault in faults:
        text.append(look.glyphs.spelled(f"\n{fault}\n"), look.palette.bad)
    return text
