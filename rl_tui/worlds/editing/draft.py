"""A world that is being drawn: the table of its file, whether it can be built yet or not."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Hashable, Mapping, Sequence
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, Any, ClassVar

from rl_tui.common.errors import UserError
from rl_tui.common.findings import Finding, place
from rl_tui.worlds.editing.edit import Edit
from rl_tui.worlds.sections.schema import parsed
from rl_tui.worlds.sections.world_section import WorldSection

if TYPE_CHECKING:
    from rl_tui.worlds.mdp.space import IntArray
    from rl_tui.worlds.world import World


class UnfinishedError(UserError):
    """A draft is no valid MDP yet; ``findings`` say why, located inside its table."""

    def __init__(self, kind: str, findings: Sequence[Finding]) -> None:
        first, more = findings[0], len(findings) - 1
        where = place((kind, *first.location))
        others = f" (and {more} more)" if more else ""
        super().__init__(f"{where} is {first.found}; expected {first.expected}{others}")
        self.findings = tuple(findings)


class Draft(ABC):
    """The table of one kind of world, all that was drawn from a seed written out. It never changes.

    What edits move keeps its identity: rows, columns and arms have numbers of their own, states their names.
    """

    kind: ClassVar[str]
    """The name of the table in a scenario file."""
    section_class: ClassVar[type[WorldSection]]
    """What reads it."""
    rules: Mapping[str, Any]
    """Its table but for what is drawn: the rules that hold for the whole world."""

    @property
    @abstractmethod
    def table(self) -> dict[str, Any]:
        """The table as a file would have it, in the types of TOML; its own, to be written to."""

    @property
    def size(self) -> int:
        """About how many states it comes to; 0 where they are written one by one, so that they are few."""
        return 0

    @abstractmethod
    def edited(self, edit: Edit) -> Draft:
        """Return what comes of ``edit``; raises UserError where nothing can: no such place, no such value."""

    @abstractmethod
    def state_keys(self, world: World) -> IntArray | Sequence[Hashable]:
        """Return the identity of each state of ``world``, which was built from it, [S]."""

    def action_keys(self, world: World) -> Sequence[Hashable]:
        """Return the identity of each action of ``world``, which was built from it, [A]."""
        return world.space.action_names

    @cached_property
    def findings(self) -> tuple[Finding, ...]:
        """Why it is no valid MDP, located inside the table; none where it is one."""
        return _read(self)[1]

    @property
    def section(self) -> WorldSection:
        """The section of a scenario that it comes to. Raises UnfinishedError where it is no valid MDP."""
        section, findings = _read(self)
        if section is None or findings:
            raise UnfinishedError(self.kind, findings)
        return section

    def build(self) -> World:
        """Return the world; no draws are made. Raises UnfinishedError where it is no valid MDP."""
        import numpy as np

        return self.section.build(np.random.default_rng(0))


@lru_cache(maxsize=2)  # that of a large map is a megabyte, and all drafts there were can be undone
def _read(draft: Draft) -> tuple[WorldSection | None, tuple[Finding, ...]]:
    """Return the section that ``draft`` comes to, if it does, and why it is no valid MDP."""
    raw = draft.table
    section, findings = parsed(draft.section_class, raw)
    return section, tuple(findings) or tuple(draft.section_class.connection_findings(raw))
