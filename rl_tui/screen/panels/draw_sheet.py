"""What the panel of tools shows, as data, and what is pressed in it."""

from __future__ import annotations

from dataclasses import dataclass

from rl_tui.agents.hyperparameters import Parameter
from rl_tui.screen.kit.pointing import Touched


@dataclass(frozen=True, slots=True)
class ToolCell:
    """One tool: its ``id``, its key as people see it, what it does in a word.

    ``is_on`` says that it is in force, such as a brush; ``refused`` why it can do nothing now.
    """

    id: str
    shown: str
    word: str
    is_on: bool = False
    refused: str = ""


@dataclass(frozen=True, slots=True)
class SheetLine:
    """A line that can be chosen, what tools are about: an outcome of a state."""

    text: str
    is_on: bool = False


@dataclass(frozen=True, slots=True)
class WorldNumber:
    """A number of the world that has a slider, and its value; one ``is_short`` makes do with half a row."""

    parameter: Parameter
    value: float
    is_short: bool = False


@dataclass(frozen=True, slots=True)
class ToolSheet:
    """All of it. ``about`` are sentences, each in its forms, the longest first, for where there is room."""

    about: tuple[tuple[str, ...], ...] = ()
    lines: tuple[SheetLine, ...] = ()
    cells: tuple[ToolCell, ...] = ()
    numbers: tuple[WorldNumber, ...] = ()


@dataclass
class ToolPressed(Touched):
    """The tool with this id was clicked in the panel."""

    tool: str


@dataclass
class LinePressed(Touched):
    """The line of that number was clicked in the panel."""

    line: int
