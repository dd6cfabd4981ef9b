"""A scenario with other parameters of its world: ``world.noise``, ``world.cell[1,2]``.

A name without brackets is a key of the world's table in the scenario file, tables within it by a dot. One
with brackets, and a rule of the map that the world of an environment can be drawn as, is an edit, as the
option ``--change`` and the editor make it.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from rl_tui.common.errors import UserError
from rl_tui.common.findings import near, place, shown
from rl_tui.lab.run.edited_world import edited_draft
from rl_tui.lab.sweeps.variation import Value, written
from rl_tui.worlds.editing.drafts import first_draft
from rl_tui.worlds.editing.edit import PREFIX, Edit, read_edits
from rl_tui.worlds.editing.toml_text import section_text, value_text
from rl_tui.worlds.files.scenario import Scenario
from rl_tui.worlds.sections.schema import parsed
from rl_tui.worlds.sections.world_section import WorldSection


def scenario_with(scenario: Scenario, settings: Mapping[str, Value]) -> Scenario:
    """Return ``scenario`` with the parameters of its world that ``settings`` name.

    Raises UserError, naming the setting, where the world has no such parameter or it cannot have that value.
    """
    keys = {name: value for name, value in settings.items() if _is_key(name, scenario.section)}
    edits = {name: value for name, value in settings.items() if name not in keys}
    if edits:
        scenario = _edited(scenario, edits)
    if keys:
        scenario = _with_keys(scenario, keys)
    return scenario


def raw_table(section: WorldSection) -> dict[str, Any]:
    """Return the table that ``section`` was read from, in the types of TOML."""
    return section.model_dump(mode="json", by_alias=True, exclude_unset=True)


def plain_text(scenario: Scenario) -> str:
    """Return a scenario file with the world and the defaults of ``scenario``, whatever its own file says."""
    parts = [
        f"title = {value_text(scenario.title)}\n",
        section_text(scenario.kind, raw_table(scenario.section)),
    ]
    return "\n".join([*parts, section_text("defaults", scenario.defaults)])


def _with_section(scenario: Scenario, kind: str, section: WorldSection) -> Scenario:
    changed = replace(scenario, kind=kind, section=section)
    return replace(changed, text=plain_text(changed))


def _is_key(name: str, section: WorldSection) -> bool:
    key = name.removeprefix(PREFIX)
    return "[" not in key and key.split(".")[0] in type(section).model_fields


def _with_keys(scenario: Scenario, settings: Mapping[str, Value]) -> Scenario:
    table = raw_table(scenario.section)
    for name, value in settings.items():
        *outer, last = name.removeprefix(PREFIX).split(".")
        inside: Any = table
        for key in outer:
            inside = inside.setdefault(key, {}) if isinstance(inside, dict) else None
        if not isinstance(inside, dict):
            raise UserError(f"{scenario.id}: {name}: {'.'.join(outer)} is no table of [{scenario.kind}]")
        inside[last] = _raw(value)
    section_class = type(scenario.section)
    section, findings = parsed(section_class, table)
    findings = [*findings, *section_class.connection_findings(table)]
    if section is None or findings:
        said = ", ".join(f"{name}={written(value)}" for name, value in settings.items())
        where = place(findings[0].inside(scenario.kind).location)
        raise UserError(
            f"{scenario.id}: {said}: {where} is {findings[0].found}; expected {findings[0].expected}"
        )
    return _with_section(scenario, scenario.kind, section)


def _raw(value: Value) -> Any:
    if isinstance(value, str) and value.startswith(("[", "{")):
        try:
            return json.loads(value)
        except ValueError:
            return value
    return value


def _edited(scenario: Scenario, settings: Mapping[str, Value]) -> Scenario:
    first = next(iter(settings))
    if scenario.section.drawn_from_seed:
        raise UserError(
            f"{scenario.id}: {first} is of one world, and here each seed draws another; vary what "
            f"it is drawn from, such as {_some_key(scenario.section)}"
        )
    edits = tuple(edit for name, value in settings.items() for edit in _read_edit(scenario, name, value))
    try:
        draft = edited_draft(first_draft(replace(scenario, text=plain_text(scenario)), 0), edits)
        section = draft.section
    except UserError as reason:
        keys = type(scenario.section).model_fields
        hint = near(first.removeprefix(PREFIX), keys) if "[" not in first else ""
        raise UserError(f"{scenario.id}: {first}={written(settings[first])}: {reason}{hint}") from reason
    return _with_section(scenario, draft.kind, section)


def _read_edit(scenario: Scenario, name: str, value: Value) -> tuple[Edit, ...]:
    try:
        return read_edits(f"{name}={written(value)}")
    except ValueError as fault:
        raise UserError(f"{scenario.id}: {shown(name)}: {fault}") from fault


def _some_key(section: WorldSection) -> str:
    return ", ".join(f"{PREFIX}{key}" for key in list(raw_table(section))[:3])
