"""``gym:ENV_ID``: any registered environment of Gymnasium as a scenario, without a file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Final

from rl_tui.common.errors import UserError
from rl_tui.common.findings import one_line, shown
from rl_tui.common.streams import streams
from rl_tui.worlds.files.scenario import Scenario
from rl_tui.worlds.sections.schema import parsed

if TYPE_CHECKING:
    from rl_tui.worlds.world import World

PREFIX: Final = "gym:"
LAST: Final = 1_000_000

_NOTES: Final = """
**{id}** as Gymnasium registers it: {states:,} states, {actions} actions ({names}), {limit}.

{how}

**Try this**

* `space` runs, `+` and `−` change the speed, `s` takes one step.
* The hyper-parameters are the program's own, not chosen for this environment: find better ones.
* To keep what you find, write a scenario file with `[gymnasium]`, `id = "{id}"` and your `[defaults]`.
"""
_BY_TABLE: Final = (
    "It tells its transition table, so every step is drawn from that, at full speed, and the exact answer is "
    "known."
)
_STEPPED: Final = (
    "It has no transition table: it is stepped for real, and nobody knows the exact answer. So there is no "
    "Q*, no error and no exact return here."
)


def environment_scenario(name: str) -> Scenario:
    """Return the scenario ``name``, gym:ENV_ID, with the usual defaults and notes that tell what it is.

    Imports gymnasium and makes the environment once. Raises UserError, with near ids, where it is not
    registered or its states and actions are not discrete.
    """
    from rl_tui.worlds.gym.section import GymnasiumSection

    section, findings = parsed(GymnasiumSection, {"id": name.removeprefix(PREFIX)})
    if section is not None and not findings:
        findings = [*section.connection_findings({"id": section.id}), *section.environment_findings()]
    if section is None or findings:
        raise UserError(f"{shown(name)[1:-1]}: found {findings[0].found}; expected {findings[0].expected}")
    world = section.build(streams(0).world)
    return Scenario(
        id=name,
        title=section.id,
        summary=f"An environment of Gymnasium, {_kind(world)}.",
        notes=_notes(section.id, world),
        order=LAST,
        kind="gymnasium",
        defaults={},
        source=Path(name),
        section=section,
    )


def _kind(world: World) -> str:
    return "stepped for real" if world.mdp is None else "by its transition table"


def _notes(id_: str, world: World) -> str:
    space = world.space
    names = one_line(", ".join(space.action_names), 100)
    return _NOTES.format(
        id=id_,
        states=space.states,
        actions=len(space.action_names),
        names=names,
        limit=f"episodes of at most {space.time_limit:,} steps" if space.time_limit else "no time limit",
        how=_STEPPED if world.mdp is None else _BY_TABLE,
    )
