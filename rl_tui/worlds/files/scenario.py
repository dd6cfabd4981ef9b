"""A scenario: a TOML file with a world, texts, and default settings of a run.

``gym:ENV_ID`` is a scenario without a file, for any environment registered with Gymnasium.
"""

from __future__ import annotations

import pkgutil
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final

from pydantic import Field

from rl_tui.common.errors import Fault, ScenarioError, UserError, complaint
from rl_tui.common.findings import Finding, Location, in_file_order, is_plain, near, one_line, place, shown
from rl_tui.common.limits import MOST_FINDINGS
from rl_tui.common.streams import streams
from rl_tui.common.text_file import UnreadableError, read_text
from rl_tui.worlds.files.toml_file import tables_in
from rl_tui.worlds.sections.schema import (
    Expect,
    FileSection,
    WorldRefusedError,
    WorldSection,
    is_table,
    markdown,
    one_of,
    parsed,
    text,
    unknown_key,
    whole_number,
)
from rl_tui.worlds.world import World

if TYPE_CHECKING:
    from numpy.random import Generator


# Scenarios in files


WORLD_KINDS: Final[Mapping[str, str]] = {
    "gymnasium": "rl_tui.worlds.gym.section:GymnasiumSection",
    "mdp": "rl_tui.worlds.sections.mdp_section:MDPSection",
    "grid": "rl_tui.worlds.grid.section:GridSection",
    "bandit": "rl_tui.worlds.sections.bandit_section:BanditSection",
}
"""Class of each kind of world table, as ``module:Class``, imported on use."""

LONGEST_TITLE: Final = 80
MOST_PREVIEW_STEPS: Final = 100_000
PANEL_IDS: Final = ("world", "table", "curve", "timeline", "budget", "controls", "last_step")
"""Ids of the panels without a key, with which a scenario or a lesson page may start."""
HIDDEN: Final = "hidden"
ANSWERS: Final = (HIDDEN, "shown")
_USUAL_ANSWERS: Final = {"bandit": HIDDEN}  # all other kinds show them


def _are_texts(value: object) -> bool:
    return isinstance(value, list) and len(value) > 0 and all(isinstance(each, str) for each in value)


class ScenarioHead(FileSection):
    """The part of a scenario file outside its world table."""

    title: Annotated[str, text(LONGEST_TITLE)] = ""
    summary: Annotated[str, text(200)] = ""
    guess: Annotated[str, text(200)] = ""
    see: Annotated[str, text(200)] = ""
    try_this: Annotated[str, text(200), Field(alias="try")] = ""
    preview_steps: Annotated[int | None, whole_number(1, MOST_PREVIEW_STEPS)] = None
    panels: Annotated[list[str] | None, Expect("a list of ids of panels", _are_texts)] = None
    notes: Annotated[str, markdown(20_000)] = ""
    order: Annotated[int, whole_number(0, 1_000_000)] = 1_000_000
    answer: Annotated[str | None, one_of(ANSWERS)] = None
    defaults: Annotated[dict[str, Any], Expect("a table", is_table)] = Field(default_factory=dict)


@dataclass(frozen=True, slots=True, eq=False)
class Scenario:
    """A scenario file without formal errors.

    `id` is the stem of the file name. `kind` names the table of the world. The values of `defaults` are raw.
    `order` sorts the start screen. `text` is the content of the file, or empty. `hides_answer`: exact values
    start hidden. The start screen shows `guess`, `see` and `try_this`, and runs `preview_steps` steps (None:
    the default). `panels` are those at the start (None: all).
    """

    id: str
    title: str
    summary: str
    notes: str
    order: int
    kind: str
    defaults: Mapping[str, Any]
    source: Path
    section: WorldSection
    text: str = ""
    hides_answer: bool = False
    guess: str = ""
    see: str = ""
    try_this: str = ""
    preview_steps: int | None = None
    panels: frozenset[str] | None = None

    @property
    def is_bandit(self) -> bool:
        """True if its world is a bandit."""
        return self.kind == "bandit"

    def build(self, generator: Generator) -> World:
        """Build the world.

        Its random parts (arms of a bandit, a random map) are the first draws from `generator`.

        Raises:
            ScenarioError: The environment behind the scenario cannot be used.
        """
        try:
            return self.section.build(generator)
        except WorldRefusedError as refusal:
            finding = refusal.finding.inside(self.kind)
            raise ScenarioError([_fault(self.source, finding)]) from refusal


def read_scenario(path: str | Path, *, ask_environment: bool = True) -> Scenario:
    """Read a scenario file.

    Without `ask_environment`, errors of a Gymnasium environment appear only when the world is built.

    Raises:
        ScenarioError: The file has errors, listed in file order.
    """
    path = Path(path)
    if not is_plain(str(path)):
        raise ScenarioError([Fault(shown(str(path)), "", "the path has control characters; rename the file")])
    try:
        text = read_text(path)
    except UnreadableError as reason:
        raise _unreadable(path, reason) from reason
    return scenario_of(text, path, ask_environment=ask_environment)


def scenario_of(text: str, path: Path, *, ask_environment: bool = True) -> Scenario:
    """Parse the content of the scenario file at `path`.

    Raises:
        ScenarioError: The text has errors, listed in file order.
    """
    try:
        raw = tables_in(text)
    except UnreadableError as reason:
        raise _unreadable(path, reason) from reason
    head, findings = _read_head(raw)
    kinds = [kind for kind in raw if kind in WORLD_KINDS]
    sections = []
    for kind in kinds:
        section, more = _read_world(kind, raw[kind], ask_environment)
        sections.append(section)
        findings += [finding.inside(kind) for finding in more]
    if len(kinds) != 1:
        found = " and ".join(f"[{kind}]" for kind in kinds) or "no world"
        findings.append(
            Finding((), found, f"exactly one of {', '.join(f'[{kind}]' for kind in WORLD_KINDS)}")
        )
    if findings or head is None or sections[0] is None:
        raise ScenarioError((_fault(path, finding) for finding in in_file_order(findings, raw)), raw, text)
    return Scenario(
        id=path.stem,
        title=head.title or path.stem,
        summary=head.summary,
        notes=head.notes,
        order=head.order,
        kind=kinds[0],
        defaults=head.defaults,
        source=path,
        section=sections[0],
        text=text,
        hides_answer=(head.answer or _USUAL_ANSWERS.get(kinds[0])) == HIDDEN,
        guess=head.guess,
        see=head.see,
        try_this=head.try_this,
        preview_steps=head.preview_steps,
        panels=None if head.panels is None else frozenset(head.panels),
    )


def _unreadable(path: Path, reason: UnreadableError) -> ScenarioError:
    return ScenarioError([Fault(str(path), reason.place, reason.found, reason.expected)])


def _fault(path: Path, finding: Finding) -> Fault:
    return Fault(str(path), place(finding.location), finding.found, finding.expected)


def _read_head(raw: Mapping[str, Any]) -> tuple[ScenarioHead | None, list[Finding]]:
    keys = [field.alias or name for name, field in ScenarioHead.model_fields.items()]
    known = [*keys, *WORLD_KINDS]
    head, findings = parsed(ScenarioHead, {key: value for key, value in raw.items() if key in keys})
    unknown = (unknown_key((key,), known) for key in raw if key not in known)
    findings += islice(unknown, MOST_FINDINGS)
    if head is not None and head.panels is not None:
        findings += islice(unknown_panels(("panels",), head.panels), MOST_FINDINGS)
    return head, findings


def unknown_panels(
    location: Location, panels: Iterable[str], known: Sequence[str] = PANEL_IDS
) -> Iterator[Finding]:
    """Yield a finding for each panel that is not `known`."""
    for panel in panels:
        if panel not in known:
            yield Finding(
                location, shown(panel), f"the id of a panel: {', '.join(known)}{near(panel, known)}"
            )


def _read_world(kind: str, raw: object, ask_environment: bool) -> tuple[WorldSection | None, list[Finding]]:
    section_class: type[WorldSection] = pkgutil.resolve_name(WORLD_KINDS[kind])
    section, findings = parsed(section_class, raw)
    if isinstance(raw, dict):
        findings += islice(section_class.connection_findings(raw), MOST_FINDINGS)
    if section is not None and not findings and ask_environment:
        findings += section.environment_findings()
    return section, findings


# Scenarios without a file


PREFIX: Final = "gym:"
LAST: Final = 1_000_000

_NOTES: Final = """
**{id}** as Gymnasium registers it: {states:,} states, {actions} actions ({names}), {limit}.

{how}

**Try this**

* `space` runs, `+` and `−` change the speed, `s` takes one step.
* The settings are defaults, not chosen for this environment. Look for better ones.
* To keep what you find, write a scenario file with `[gymnasium]`, `id = "{id}"` and your `[defaults]`.
"""
_BY_TABLE: Final = (
    "It provides its transition table. So steps are drawn from the table, at full speed, and exact values "
    "are known."
)
_STEPPED: Final = (
    "It has no transition table and is simulated. So there are no exact values here: no Q*, no error and no "
    "exact return."
)


def environment_scenario(name: str) -> Scenario:
    """Return a scenario for ``gym:ENV_ID``, with default settings and generated notes.

    This creates the environment once.

    Raises:
        UserError: The environment is not registered, or its states or actions are not discrete.
    """
    from rl_tui.worlds.gym.section import GymnasiumSection

    section, findings = parsed(GymnasiumSection, {"id": name.removeprefix(PREFIX)})
    if section is not None and not findings:
        findings = [*section.connection_findings({"id": section.id}), *section.environment_findings()]
    if section is None or findings:
        raise UserError(f"{shown(name)[1:-1]}: {complaint(findings[0].found, findings[0].expected)}")
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
    return "simulated" if world.mdp is None else "by its transition table"


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
