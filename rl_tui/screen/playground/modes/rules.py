"""The base of tools of the world editor, and the rules of a world."""

from __future__ import annotations

import json
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Final

from rl_tui.common.errors import UserError, complaint
from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.dialogs.dialog import Dialog
from rl_tui.screen.dialogs.form import Candidate, Choice, Prompt
from rl_tui.screen.panels.draw_panel import SheetLine, Sign, ToolCell, WorldNumber
from rl_tui.screen.panels.world.view import WorldView
from rl_tui.screen.theme.glyphs import Glyphs
from rl_tui.worlds.editing.arms_draft import Draft
from rl_tui.worlds.editing.edit import BETWEEN, JSON_BEGINS, Edit, as_json, json_in
from rl_tui.worlds.grid.moves import MOVES
from rl_tui.worlds.grid.section import REWARDS
from rl_tui.worlds.world import World

# Rules of a world


RULES: Final[dict[str, dict[str, str]]] = {
    "grid": {
        "noise": "share of moves that slip, half of it to each side (0 to 1)",
        "slippery": "as on Gymnasium's ice: straight on and both sides equally likely (true or false)",
        "step_reward": "living reward: added to every step",
        "bump_reward": "added to steps that a wall or the edge stops",
        "time_limit": "steps until the time limit, 0 for none",
        "rewards": "entering or leaving: when a cell pays",
        "moves": "four, clockwise, king or king+stay",
        "wind": "a number for each column: cells that the wind pushes you up",
        "wind_rows": "a number for each row: cells that the wind pushes you to the right",
        "gusts": "wind one stronger or weaker now and then (true or false)",
    },
    "mdp": {
        "time_limit": "steps until the time limit, 0 for none",
        "start": "a state, or a table of states and chances",
    },
    "bandit": {
        "std": "standard deviation of the rewards",
        "drift": "standard deviation of the step that every mean takes after every pull",
    },
}
"""The rules of each kind of world, and their meanings."""
WORDS: Final[dict[str, tuple[str, ...]]] = {
    "slippery": ("false", "true"),
    "gusts": ("false", "true"),
    "rewards": REWARDS,
    "moves": tuple(MOVES),
}
"""The values of rules that are words."""


def ask_rules(_: object, desk: Desk) -> None:
    """Ask for a rule, then for its value."""
    draft = desk.draft
    candidates = [
        Candidate(name, name, (text,), value=rule_value(draft, name))
        for name, text in RULES[draft.kind].items()
    ]
    desk.ask(Choice("Rules of the world", candidates, "", desk.glyphs), lambda name: _ask_rule(desk, name))


def _ask_rule(desk: Desk, name: str) -> None:
    draft, now = desk.draft, rule_value(desk.draft, name)
    if name in WORDS:
        candidates = [
            Candidate(word, word, refused=fault_of(draft, (rule_edit(name, word),), name))
            for word in WORDS[name]
        ]
        title = f"{name}: {RULES[draft.kind][name]}"
        desk.ask(
            Choice(title, candidates, now, desk.glyphs), lambda word: desk.draw((rule_edit(name, word),))
        )
        return

    def read(text: str) -> str:
        fault = fault_of(draft, (rule_edit(name, text),), name)
        if fault:
            raise ValueError(fault)
        return text

    desk.ask(
        Prompt(name, RULES[draft.kind][name], now, read),
        lambda text: desk.draw((rule_edit(name, str(text)),)),
    )


def next_word(desk: Desk, name: str) -> None:
    """Set a rule to the next of its words, if possible."""
    words, now = WORDS[name], rule_value(desk.draft, name)
    edit = rule_edit(name, words[(words.index(now) + 1) % len(words)] if now in words else words[0])
    fault = fault_of(desk.draft, (edit,), name)
    if fault:
        desk.tell(f"{name} stays {now}: {fault}")
    else:
        desk.draw((edit,))


def fault_of(draft: Draft, edits: Sequence[Edit], name: str) -> str:
    """Return why ``edits`` to the rule ``name`` are impossible, or an empty string."""
    before = draft.findings
    try:
        for edit in edits:
            draft = draft.edited(edit)
        findings = draft.findings
    except UserError as fault:
        return str(fault)
    new = (each for each in findings if each not in before or each.location[:1] == (name,))
    here = next(new, None)
    return "" if here is None else complaint(here.found, here.expected)


def rule_edit(name: str, text: str) -> Edit:
    """Return the edit that sets the rule ``name`` to typed text."""
    value = text.strip()
    if BETWEEN in value or value.startswith(JSON_BEGINS):
        try:
            value = json_in(value)
        except ValueError:
            value = as_json(value)  # a name that only looks like JSON
    return Edit(name, (), value)


def rule_value(draft: Draft, name: str) -> str:
    """Return the value of the rule ``name`` in ``draft``, in typed form."""
    value = rule_of(draft, name)
    return value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)


def rule_of(draft: Draft, name: str) -> Any:
    """Return the value of the rule ``name`` in ``draft``, or its default."""
    value = draft.rules.get(name)
    if value is None:
        value = draft.section_class.model_fields[name].get_default(call_default_factory=True)
    return value


def number_of(draft: Draft, name: str) -> float:
    """Return the number of the rule ``name``, 0 if it is not a number."""
    value = rule_of(draft, name)
    return float(value) if isinstance(value, int | float) else 0.0


# Tools and toolboxes


@dataclass(frozen=True, slots=True)
class Desk:
    """The inputs of a tool."""

    view: WorldView
    snapshot: Snapshot
    draft: Draft
    glyphs: Glyphs
    draw: Callable[[Sequence[Edit]], None]
    tell: Callable[[str], None]
    ask: Callable[[Dialog[Any], Callable[[Any], None]], None]


Use = Callable[[Any, Desk], None]
Tell = Callable[[Any, Desk], str]


def _nothing(_: object, __: Desk) -> str:
    return ""


@dataclass(frozen=True, slots=True)
class Tool:
    """One drawing tool, from which panel, key line, menu, help, palette and docs derive.

    * ``key``: Textual's name, or a menu key and a letter. ``symbol``: how people see it.
    * ``use``: called with the tool's owner and the desk. ``click``: replaces it for a click.
    * ``rank``, ``hint``: order, and key and label, on the key line.
    * ``is_of_number``: shown above the first slider of the panel. ``is_told``: shown elsewhere.
    """

    key: str
    label: str
    help: str
    use: Use
    symbol: str = ""
    click: Use | None = None
    why_not: Tell = _nothing
    value: Tell = _nothing
    rank: int | None = None
    hint: tuple[str, str] | None = None
    sign: Sign | None = None
    is_told: bool = False
    is_of_number: bool = False

    @property
    def shown(self) -> str:
        """The key as people see it."""
        return self.symbol or self.key

    @property
    def in_panel(self) -> bool:
        """True if the panel lists it."""
        return not (self.is_told or self.is_of_number or self.is_in_menu)

    @property
    def is_in_menu(self) -> bool:
        """True if it is in a menu and has no single key."""
        return " " in self.key


class Toolbox(ABC):
    """The tools of one kind of world, with their memory."""

    tools: ClassVar[tuple[Tool, ...]]
    rest: ClassVar[str]
    """A few words about the menu of the world during editing."""

    @property
    def in_hand(self) -> ToolCell | None:
        """The current brush as the panel shows it, or None."""
        return None

    @abstractmethod
    def about(self, desk: Desk) -> tuple[str, ...]:
        """Return the contents under the cursor, longest form first."""

    def advice(self, desk: Desk) -> tuple[str, ...]:
        """Return what a click does now, longest form first."""
        return ()

    def lines(self, desk: Desk) -> tuple[SheetLine, ...]:
        """Return lines to choose from, for tools that need more than a place."""
        return ()

    def choose_line(self, desk: Desk, line: int) -> None:
        """Choose one of the lines."""
        raise NotImplementedError

    def numbers(self, desk: Desk) -> tuple[WorldNumber, ...]:
        """Return the numbers with a slider."""
        return ()

    def number_edits(self, desk: Desk, name: str, value: float) -> Sequence[Edit]:
        """Return the edits that set the number ``name``.

        Raises:
            ValueError: The value is not possible.
        """
        raise NotImplementedError

    def picked(self, desk: Desk) -> frozenset[int]:
        """Return the places selected for the next tool."""
        return frozenset()

    @abstractmethod
    def paint(self, desk: Desk, places: Sequence[int]) -> None:
        """Draw at ``places``, from a drag or a click."""

    @abstractmethod
    def turn(self, desk: Desk, place: int, amount: float) -> None:
        """Change the reward of a place by the wheel."""

    def go_along(self, desk: Desk, step: tuple[int, int]) -> None:
        """Handle shift and an arrow, by default a move of the cursor."""
        place = desk.view.cursor_place
        if place is not None:
            desk.view.put_cursor(desk.view.moved(place, *step))

    def cancel(self) -> bool:
        """Cancel an unfinished action. Return True if there was one."""
        return False

    def place_added(self, world: World) -> int | None:
        """Return the place that a tool has added, once, or None."""
        return None
