"""The ``[gymnasium]`` table: a registered environment whose transition table is read once."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import Field

from rl_tui.worlds.findings import Finding, shown
from rl_tui.worlds.schema import Expect, is_table, text
from rl_tui.worlds.world import World
from rl_tui.worlds.world_section import WorldRefusedError, WorldSection

if TYPE_CHECKING:
    from numpy.random import Generator


class GymnasiumSection(WorldSection):
    """The whole table: the environment's id and what it is made with."""

    id: Annotated[str, text(100)]
    kwargs: Annotated[dict[str, Any], Expect("a table of arguments", is_table)] = Field(default_factory=dict)

    @classmethod
    def connection_findings(cls, raw: Mapping[str, Any]) -> Iterator[Finding]:
        """Yield what may not be asked for: importing a module, opening a window."""
        name, kwargs = raw.get("id"), raw.get("kwargs")
        if isinstance(name, str) and ":" in name:
            yield Finding(
                ("id",), shown(name), "the id of a registered environment, without a module to import"
            )
        if isinstance(kwargs, dict) and "render_mode" in kwargs:
            found = shown(kwargs["render_mode"])
            yield Finding(("kwargs", "render_mode"), found, "no such argument: the world is drawn here")

    def environment_findings(self) -> Iterator[Finding]:
        """Yield why the environment cannot be used, if so. Imports gymnasium."""
        from rl_tui.worlds.toy_text import world_of

        try:
            world_of(self.id, self.kwargs)
        except WorldRefusedError as refusal:
            yield refusal.finding

    def build(self, generator: Generator) -> World:
        """Return the world; ``generator`` is not touched. Imports gymnasium, raises WorldRefusedError."""
        from rl_tui.worlds.toy_text import world_of

        return world_of(self.id, self.kwargs)
