"""The world of a cell: its parameters, a digest of its content, and its exact values.

`world.noise` is a key of the world's table in the scenario file (a dot leads into an inner table). With
brackets, as in `world.cell[1,2]`, it is an edit, as in the option `--change`; so is a rule of an
environment's map.
"""

from __future__ import annotations

import hashlib
import json
import threading
from collections import OrderedDict
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Final

from rl_tui.agents.compatibility import is_bandit
from rl_tui.agents.exact.policy_evaluation import Solution
from rl_tui.agents.exact.policy_figures import expected_return, uniform_policy
from rl_tui.agents.exact.solve import best_expected_return
from rl_tui.common.errors import UserError, complaint
from rl_tui.common.findings import near, place, shown
from rl_tui.common.streams import streams
from rl_tui.runs.edited_world import edited_draft
from rl_tui.runs.figures import MOST_STATES, optimum_of
from rl_tui.runs.library import find
from rl_tui.studies.sweeps.cells.variation import Value, written
from rl_tui.worlds.editing.drafts import first_draft
from rl_tui.worlds.editing.edit import PREFIX, Edit, read_edits
from rl_tui.worlds.editing.saving import section_text, value_text
from rl_tui.worlds.files.scenario import Scenario
from rl_tui.worlds.mdp.digest import table_digest
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP
from rl_tui.worlds.sections.schema import WorldSection, parsed
from rl_tui.worlds.world import World

# Exact values of a world


_MOST_GAMMAS: Final = 64


class ExactFacts:
    """Exact results of `mdp`, each computed once. Safe from several threads."""

    def __init__(self, mdp: TabularMDP | None) -> None:
        self.mdp = None if mdp is None or mdp.states > MOST_STATES else mdp
        """The table, or None if it is missing or too large for exact results."""
        self._optima: dict[float, Solution | None] = {}
        self._lock = threading.RLock()

    def optimum(self, gamma: float) -> Solution | None:
        """Return the solution for `gamma`."""
        with self._lock:
            if gamma not in self._optima:
                if len(self._optima) == _MOST_GAMMAS:
                    self._optima.clear()
                self._optima[gamma] = optimum_of(self.mdp, gamma)
            return self._optima[gamma]

    @property
    def best(self) -> float | None:
        """Expected return of the best policy, which may depend on the time."""
        with self._lock:
            return self._best

    @property
    def random(self) -> float | None:
        """Expected return of the random policy."""
        with self._lock:
            return self._random

    @cached_property
    def _best(self) -> float | None:
        return None if self.mdp is None else best_expected_return(self.mdp)

    @cached_property
    def _random(self) -> float | None:
        return None if self.mdp is None else expected_return(self.mdp, uniform_policy(self.mdp))


# Parameters of a world


def scenario_with(scenario: Scenario, settings: Mapping[str, Value]) -> Scenario:
    """Return `scenario` with parameters of its world. Raises UserError."""
    keys = {name: value for name, value in settings.items() if _is_key(name, scenario.section)}
    edits = {name: value for name, value in settings.items() if name not in keys}
    if edits:
        scenario = _edited(scenario, edits)
    if keys:
        scenario = _with_keys(scenario, keys)
    return scenario


def raw_table(section: WorldSection) -> dict[str, Any]:
    """Return the table of `section`, with TOML types."""
    return section.model_dump(mode="json", by_alias=True, exclude_unset=True)


def plain_text(scenario: Scenario) -> str:
    """Return a scenario file with world and defaults."""
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
            raise UserError(f"{scenario.id}: {name}: [{scenario.kind}] has no table {'.'.join(outer)}")
        inside[last] = _raw(value)
    section_class = type(scenario.section)
    section, findings = parsed(section_class, table)
    findings = [*findings, *section_class.connection_findings(table)]
    if section is None or findings:
        said = ", ".join(f"{name}={written(value)}" for name, value in settings.items())
        where = place(findings[0].inside(scenario.kind).location)
        why = complaint(findings[0].found, findings[0].expected)
        raise UserError(f"{scenario.id}: {said}: {where}: {why}")
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
            f"{scenario.id}: {first} works only in a fixed world, but here each seed draws its own; "
            f"vary how worlds are drawn, such as {_some_key(scenario.section)}"
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


# The world and its digest


MOST_BYTES: Final = 256 * 2**20
"""Memory limit of cached worlds in bytes."""
MOST_WORLDS: Final = 2_000
_USUAL_SIZE: Final = 50_000


@dataclass(frozen=True, eq=False)
class WorldContent:
    """The world of a cell with shared results."""

    scenario: Scenario
    """The scenario with the settings of its world."""
    example: World
    """The world, or one of them if each seed draws its own. States and actions are equal in all."""
    digest: str
    """SHA-256 of the content of the world, without ids, titles, notes and file names."""
    is_bandit: bool
    """True if every step ends its episode, and there is one state."""
    facts: ExactFacts = field(init=False)
    """Exact results of `example`."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "facts", ExactFacts(self.example.mdp))

    @property
    def shared(self) -> World | None:
        """The world of every seed, or None if they differ."""
        return None if self.scenario.section.drawn_from_seed else self.example


class Worlds:
    """A bounded cache of the worlds of one plan."""

    def __init__(self) -> None:
        self._scenarios: dict[str, Scenario] = {}
        self._contents: OrderedDict[tuple[object, ...], WorldContent | UserError] = OrderedDict()
        self._bytes = 0
        self._lock = threading.RLock()

    def of(self, scenario: Scenario | str, settings: Mapping[str, Value], seed: int) -> WorldContent:
        """Return the world of a cell, drawn for `seed` if needed. Raises UserError."""
        with self._lock:
            place = (scenario, *((name, type(value), value) for name, value in settings.items()))
            known = self._contents.get(place)
            if known is None:
                try:
                    known = self._content(scenario, settings, seed)
                except UserError as reason:
                    known = reason
                self._keep(place, known)
            else:
                self._contents.move_to_end(place)
        if isinstance(known, UserError):
            raise known
        return known

    def _content(self, scenario: Scenario | str, settings: Mapping[str, Value], seed: int) -> WorldContent:
        if isinstance(scenario, str):
            if scenario not in self._scenarios:
                self._scenarios[scenario] = find(scenario)
            scenario = self._scenarios[scenario]
        return content_of(scenario_with(scenario, settings), seed)

    def _keep(self, place: tuple[object, ...], known: WorldContent | UserError) -> None:
        self._contents[place] = known
        self._bytes += _size(known)
        while len(self._contents) > 1 and (self._bytes > MOST_BYTES or len(self._contents) > MOST_WORLDS):
            _, dropped = self._contents.popitem(last=False)
            self._bytes -= _size(dropped)


def content_of(scenario: Scenario, seed: int) -> WorldContent:
    """Return the content of `scenario`, drawn for `seed` if needed. Raises UserError."""
    world = scenario.build(streams(seed).world)
    return WorldContent(scenario, world, _digest(scenario, world), is_bandit(world.space))


def _size(known: WorldContent | UserError) -> int:
    return _USUAL_SIZE + (known.example.nbytes if isinstance(known, WorldContent) else 0)


def _digest(scenario: Scenario, world: World) -> str:
    section = scenario.section
    said: dict[str, Any] = {"arms": world.is_bandit}
    if section.drawn_from_seed:
        said |= {"drawn": scenario.kind, "section": section.model_dump(mode="json", by_alias=True)}
        said["section"].pop("budget", None)  # it only ends a run on screen
    elif world.mdp is not None:
        said["table"] = table_digest(world.mdp)
    else:
        said |= {"stepped": section.model_dump(mode="json", by_alias=True), **_environment(section)}
        said["time_limit"] = world.space.time_limit
    text = json.dumps(said, sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()


def _environment(section: WorldSection) -> dict[str, str]:
    """Return the version of Gymnasium, and a digest of other code."""
    from rl_tui.worlds.gym.section import GymnasiumSection

    if not isinstance(section, GymnasiumSection):
        return {}
    import gymnasium

    from rl_tui.worlds.gym.registered import looked_at

    said = {"gymnasium": gymnasium.__version__}
    with looked_at(section.id, section.kwargs) as environment:
        module = type(environment.unwrapped).__module__
    if module.split(".")[0] != "gymnasium":
        said["code"] = _source_digest(module)
    return said


def _source_digest(module: str) -> str:
    import sys
    from pathlib import Path

    file = getattr(sys.modules.get(module), "__file__", None)
    try:
        return hashlib.sha256(Path(file or "").read_bytes()).hexdigest()
    except OSError:
        return module
