"""The ``[gymnasium]`` table: an environment, with or without its transition table."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Annotated, Any, Final

from pydantic import Field

from rl_tui.common.findings import Finding, Location, is_plain, shown
from rl_tui.worlds.drawing import Grid
from rl_tui.worlds.environment import EnvironmentFailedError
from rl_tui.worlds.gym.bins import BinsSection
from rl_tui.worlds.gym.modules import refusal_of
from rl_tui.worlds.sections.schema import (
    Expect,
    WorldRefusedError,
    WorldSection,
    is_table,
    is_truth_value,
    text,
    with_control_character,
)
from rl_tui.worlds.world import World

if TYPE_CHECKING:
    from numpy.random import Generator

_TABLE: Final = Expect("true (its transition table) or false (simulated)", is_truth_value)
_IN_LINES: Final = "\n\t"
_DRAWN_HERE: Final = "no such argument, because rl-tui draws the world"
_NOT_ITS_OWN: Final = "arguments of the environment, not of gymnasium.make"
# Of the arguments of gymnasium.make and of a registration, only the time limit may be set
_OF_MAKE: Final = ("id", "spec", "env", "env_id", "wrappers", "disable_env_checker", "make_kwargs")
_OF_A_SPEC: Final = ("entry_point", "vector_entry_point", "additional_wrappers", "order_enforce", "kwargs")
_REFUSED: Final[Mapping[str, str]] = {
    "render_mode": _DRAWN_HERE,
    **dict.fromkeys((*_OF_MAKE, *_OF_A_SPEC), _NOT_ITS_OWN),
}


class GymnasiumSection(WorldSection):
    """Id and arguments of an environment.

    A sound transition table is read once; otherwise the environment is simulated. `table` demands one of the
    two.
    """

    id: Annotated[str, text(100)]
    kwargs: Annotated[dict[str, Any], Expect("a table of arguments", is_table)] = Field(default_factory=dict)
    table: Annotated[bool, _TABLE] | None = None
    bins: BinsSection | None = None

    @classmethod
    def connection_findings(cls, raw: Mapping[str, Any]) -> Iterator[Finding]:
        """Yield forbidden modules and arguments, and a table with bins."""
        name, kwargs, bins = raw.get("id"), raw.get("kwargs"), raw.get("bins")
        refusal = refusal_of(name) if isinstance(name, str) else None
        if refusal is not None:
            yield refusal
        if isinstance(kwargs, dict):
            yield from _kwargs_findings(kwargs)
        if isinstance(bins, dict):
            if raw.get("table") is True:
                yield Finding(("table",), "a world with bins has no transition table; leave out table")
            for finding in BinsSection.connection_findings(bins):
                yield finding.inside("bins")

    def environment_findings(self) -> Iterator[Finding]:
        """Yield why the environment cannot be used, after starting it once."""
        try:
            world = self._world()
            if world.new_environment is not None:
                world.new_environment().reset(seed=0)
        except WorldRefusedError as refusal:
            yield refusal.finding
        except EnvironmentFailedError as failure:
            found = f"{failure}; choose another environment"
            yield Finding(("kwargs" if self.kwargs else "id",), found)

    def sketch(self) -> Grid | None:
        """Return the known part of the grid without importing Gymnasium."""
        from rl_tui.worlds.gym.stepped_layout import known_grid

        return known_grid(self)

    def build(self, generator: Generator) -> World:
        """Build the world, or raise WorldRefusedError. `generator` is not used."""
        return self._world()

    def _world(self) -> World:
        if self.table is not False and self.bins is None:
            from rl_tui.worlds.gym.toy_text import NoTableError, world_of

            try:
                return world_of(self.id, self.kwargs, computed=self.table is True)
            except NoTableError:
                if self.table:
                    raise
        from rl_tui.worlds.gym.registered import stepped_world

        return stepped_world(self.id, self.kwargs, self.bins)


def _kwargs_findings(kwargs: Mapping[str, Any]) -> Iterator[Finding]:
    for name, value in kwargs.items():
        if name in _REFUSED:
            yield Finding(("kwargs", name), shown(value), _REFUSED[name])
    yield from _unprintable(kwargs)


def _unprintable(kwargs: Mapping[str, Any]) -> Iterator[Finding]:
    left: list[tuple[object, Location]] = [(kwargs, ("kwargs",))]  # tables may be nested deeply
    while left:
        value, location = left.pop()
        if isinstance(value, Mapping):
            for key, each in value.items():
                if not is_plain(key):
                    yield Finding(
                        (*location, key), with_control_character(key), "a key without control characters"
                    )
                left.append((each, (*location, key)))
        elif isinstance(value, list):
            left += [(each, (*location, index)) for index, each in enumerate(value)]
        elif isinstance(value, str) and not is_plain(value, _IN_LINES):
            found = with_control_character(value, _IN_LINES)
            yield Finding(location, found, "a text without control characters")
