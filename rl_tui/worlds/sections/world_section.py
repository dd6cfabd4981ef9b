"""What the table of any kind of world offers. A new kind is one such class and one row in scenario.py."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

from rl_tui.common.findings import Finding, Location
from rl_tui.worlds.drawing import Drawing
from rl_tui.worlds.sections.schema import FileSection
from rl_tui.worlds.world import World

if TYPE_CHECKING:
    from numpy.random import Generator


class WorldSection(FileSection):
    """The table of one kind of world. Findings are located inside it."""

    @classmethod
    def connection_findings(cls, raw: Mapping[str, Any]) -> Iterator[Finding]:
        """Yield faults between the entries of the raw table, whether or not the form of each is sound."""
        return iter(())

    def environment_findings(self) -> Iterator[Finding]:
        """Yield faults that only show once the world outside the file is looked at; may be slow."""
        return iter(())

    @property
    def drawn_from_seed(self) -> bool:
        """Whether another seed makes another world."""
        return False

    def sketch(self) -> Drawing | None:
        """Return how the world will be drawn, without building it; None if the table does not tell.

        A map has its size and wind only, a graph no states.
        """
        return None

    @abstractmethod
    def build(self, generator: Generator) -> World:
        """Return the world; what is random about the world itself is drawn from ``generator``."""


class WorldRefusedError(Exception):
    """The world cannot be built; ``finding`` says why, located inside its table."""

    def __init__(self, location: Location, found: str, expected: str) -> None:
        super().__init__(found)
        self.finding = Finding(location, found, expected)
