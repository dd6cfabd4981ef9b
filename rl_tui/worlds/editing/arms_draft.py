"""The base class of drafts (worlds being edited, valid or not), and the draft of a bandit.

Rows, columns, arms and states keep their identity when edits move them.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, Any, ClassVar, Final

from rl_tui.common.errors import UserError, complaint
from rl_tui.common.findings import Finding, near, place, shown
from rl_tui.common.limits import MOST_ARMS
from rl_tui.common.streams import streams
from rl_tui.worlds.editing.edit import Edit, lines_added, number_in, place_in, rule_number
from rl_tui.worlds.files.toml_file import tables_in
from rl_tui.worlds.sections.bandit_section import BERNOULLI, BanditSection
from rl_tui.worlds.sections.schema import WorldSection, parsed

if TYPE_CHECKING:
    from rl_tui.worlds.files.scenario import Scenario
    from rl_tui.worlds.mdp.space import IntArray
    from rl_tui.worlds.world import World


# A draft of any world


class UnfinishedError(UserError):
    """A draft that is not a valid MDP yet."""

    def __init__(self, kind: str, findings: Sequence[Finding]) -> None:
        first, more = findings[0], len(findings) - 1
        where = place((kind, *first.location))
        others = f" (and {more} more)" if more else ""
        super().__init__(f"{where}: {complaint(first.found, first.expected)}{others}")
        self.findings = tuple(findings)


class Draft(ABC):
    """The table of a world, with random parts written out. Immutable."""

    kind: ClassVar[str]
    """Name of the table in a scenario file."""
    section_class: ClassVar[type[WorldSection]]
    """Class that parses the table."""
    rules: Mapping[str, Any]
    """The part of the table that is not drawn: rules for the whole world."""

    @property
    @abstractmethod
    def table(self) -> dict[str, Any]:
        """The table for a file, as a new dictionary."""

    @property
    def size(self) -> int:
        """Approximate number of states; 0 if they are written one by one."""
        return 0

    @abstractmethod
    def edited(self, edit: Edit) -> Draft:
        """Return the draft after `edit`, or raise UserError for a missing place or value."""

    @abstractmethod
    def state_keys(self, world: World) -> IntArray | Sequence[Hashable]:
        """Return an identity for each state of the built `world`, [S]."""

    def action_keys(self, world: World) -> Sequence[Hashable]:
        """Return an identity for each action of the built `world`, [A]."""
        return world.space.action_names

    @cached_property
    def findings(self) -> tuple[Finding, ...]:
        """Why this is not a valid MDP. Empty if it is."""
        return _read(self)[1]

    @property
    def section(self) -> WorldSection:
        """The parsed table, or UnfinishedError."""
        section, findings = _read(self)
        if section is None or findings:
            raise UnfinishedError(self.kind, findings)
        return section

    def build(self) -> World:
        """Build the world, without random draws.

        Raises:
            UnfinishedError: It is not a valid MDP.
        """
        import numpy as np

        return self.section.build(np.random.default_rng(0))


@lru_cache(maxsize=2)  # a large map takes a megabyte, and undo holds many drafts
def _read(draft: Draft) -> tuple[WorldSection | None, tuple[Finding, ...]]:
    raw = draft.table
    section, findings = parsed(draft.section_class, raw)
    return section, tuple(findings) or tuple(draft.section_class.connection_findings(raw))


# The draft of a bandit


RULES: Final = ("std", "drift")
"""Settings for all arms, named like the keys of the file."""


@dataclass(frozen=True, eq=False)
class ArmsDraft(Draft):
    """A bandit draft: means and identities of arms, and other rules."""

    kind = "bandit"
    section_class = BanditSection
    means: tuple[float, ...]
    arm_ids: tuple[int, ...]
    next_id: int
    rules: Mapping[str, Any]

    @property
    def table(self) -> dict[str, Any]:
        """The table for a file."""
        return {"means": list(self.means), **self.rules}

    @property
    def is_bernoulli(self) -> bool:
        """True for rewards of 0 and 1."""
        return self.rules.get("rewards") == BERNOULLI

    def edited(self, edit: Edit) -> ArmsDraft:
        """Return the draft after `edit`."""
        make = _EDITS.get(edit.name)
        if make is None:
            what = f"a bandit has nothing called {shown(edit.name)}{near(edit.name, _EDITS)}"
            raise UserError(f"{what}; choose one of {', '.join(_EDITS)}")
        return make(self, edit)

    def state_keys(self, world: World) -> tuple[str, ...]:
        """Return the name of the only state, [1]."""
        return tuple(world.space.state_names)

    def action_keys(self, world: World) -> tuple[int, ...]:
        """Return the identity of each arm, [A]."""
        return self.arm_ids


def arms_draft(scenario: Scenario, seed: int) -> ArmsDraft:
    """Return the draft of a bandit, with means drawn from `seed`."""
    section = scenario.section
    assert isinstance(section, BanditSection)
    rules = dict(tables_in(scenario.text)["bandit"])
    for key in ("arms", "mean", "means"):
        rules.pop(key, None)
    means = section.drawn_means(streams(seed).world)
    return ArmsDraft(tuple(means), tuple(range(len(means))), len(means), rules)


def _set_mean(draft: ArmsDraft, edit: Edit) -> ArmsDraft:
    means, mean = list(draft.means), number_in(edit)
    for arm in place_in(edit, "arm", len(means)):
        means[arm] = mean
    return replace(draft, means=tuple(means))


def _add(draft: ArmsDraft, edit: Edit) -> ArmsDraft:
    count, at = lines_added(edit, len(draft.means))
    if not 1 <= len(draft.means) + count <= MOST_ARMS:
        raise UserError(f"a bandit has 1 to {MOST_ARMS:,} arms")
    new, cut = max(count, 0), at + max(-count, 0)
    mean = 0.5 if draft.is_bernoulli else 0.0
    ids = tuple(range(draft.next_id, draft.next_id + new))
    return replace(
        draft,
        means=draft.means[:at] + (mean,) * new + draft.means[cut:],
        arm_ids=draft.arm_ids[:at] + ids + draft.arm_ids[cut:],
        next_id=draft.next_id + new,
    )


def _set_rule(draft: ArmsDraft, edit: Edit) -> ArmsDraft:
    return replace(draft, rules={**draft.rules, edit.name: rule_number(edit)})


_EDITS: Final[Mapping[str, Callable[[ArmsDraft, Edit], ArmsDraft]]] = {
    "arm": _set_mean,
    "arms": _add,
    **dict.fromkeys(RULES, _set_rule),
}
