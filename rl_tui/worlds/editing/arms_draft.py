"""The draft of a bandit: the means of its arms, written out, and how they pay."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Final

from rl_tui.common.errors import UserError
from rl_tui.common.findings import near, shown
from rl_tui.common.limits import MOST_ARMS
from rl_tui.common.streams import streams
from rl_tui.worlds.editing.draft import Draft
from rl_tui.worlds.editing.edit import Edit
from rl_tui.worlds.editing.values import lines_added, number_in, place_in, rule_number
from rl_tui.worlds.files.toml_file import tables_in
from rl_tui.worlds.sections.bandit_section import BERNOULLI, BanditSection

if TYPE_CHECKING:
    from rl_tui.worlds.files.scenario import Scenario
    from rl_tui.worlds.world import World

RULES: Final = ("std", "drift")
"""What can be set for all arms, by the names of the file's keys."""


@dataclass(frozen=True, eq=False)
class ArmsDraft(Draft):
    """The mean of each arm, its identity, and the rest of the table."""

    kind = "bandit"
    section_class = BanditSection
    means: tuple[float, ...]
    arm_ids: tuple[int, ...]
    next_id: int
    rules: Mapping[str, Any]

    @property
    def table(self) -> dict[str, Any]:
        """The table as a file would have it."""
        return {"means": list(self.means), **self.rules}

    @property
    def is_bernoulli(self) -> bool:
        """Whether arms pay 1 with their mean as the probability, else 0."""
        return self.rules.get("rewards") == BERNOULLI

    def edited(self, edit: Edit) -> ArmsDraft:
        """Return what comes of ``edit``; raises UserError where nothing can."""
        make = _EDITS.get(edit.name)
        if make is None:
            what = f"a bandit has nothing called {shown(edit.name)}{near(edit.name, _EDITS)}"
            raise UserError(f"{what}; it has {', '.join(_EDITS)}")
        return make(self, edit)

    def state_keys(self, world: World) -> tuple[str, ...]:
        """Return the name of its only state."""
        return tuple(world.space.state_names)

    def action_keys(self, world: World) -> tuple[int, ...]:
        """Return the identity of each arm, [A]."""
        return self.arm_ids


def arms_draft(scenario: Scenario, seed: int) -> ArmsDraft:
    """Return the draft of a ``[bandit]`` scenario, with the means that ``seed`` draws where it does."""
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
    """Add arms before one, or take some away from it on."""
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
