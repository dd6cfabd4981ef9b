"""The tools of the world editor in general, and the rules that hold for a whole world.

A rule is a setting such as noise, wind or the time limit; it is typed or chosen from a list. A tool is
one row of the toolbox for a kind of world.
"""

from __future__ import annotations

import json
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Final

from rl_tui.common.errors import UserError
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
        "slippery": "as on Gymnasium's ice: each of three moves as likely (true or false)",
        "step_reward": "living reward: added to every step",
        "bump_reward": "added to steps that a wall or the edge stops",
        "time_limit": "steps until the time limit, 0 for none",
        "rewards": "entering or leaving: when a cell pays",
        "moves": "four, clockwise, king or king+stay",
        "wind": "a number for each column: cells that it blows up",
        "wind_rows": "a number for each row: cells that it blows to the right",
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
"""What can be set for a whole world, and what that is."""
WORDS: Final[dict[str, tuple[str, ...]]] = {
    "slippery": ("false", "true"),
    "gusts": ("false", "true"),
    "rewards": REWARDS,
    "moves": tuple(MOVES),
}
"""What a rule may be that is no number."""


def ask_rules(_: object, desk: Desk) -> None:
    """Choose one of the rules, and type or choose what it is to be."""
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
    """Let a rule be the next of its words, where it can be that."""
    words, now = WORDS[name], rule_value(desk.draft, name)
    edit = rule_edit(name, words[(words.index(now) + 1) % len(words)] if now in words else words[0])
    fault = fault_of(desk.draft, (edit,), name)
    if fault:
        desk.tell(f"{name} stays {now}: {fault}")
    else:
        desk.draw((edit,))


def fault_of(draft: Draft, edits: Sequence[Edit], name: str) -> str:
    """Return why the rule ``name`` of ``draft`` cannot be what ``edits`` say; empty where it can.

    What was unfinished before is no reason.
    """
    before = draft.findings
    try:
        for edit in edits:
            draft = draft.edited(edit)
        findings = draft.findings
    except UserError as fault:
        return str(fault)
    new = (each for each in findings if each not in before or each.location[:1] == (name,))
    here = next(new, None)
    return "" if here is None else f"found {here.found}; expected {here.expected}"


def rule_edit(name: str, text: str) -> Edit:
    """Return the edit that sets the rule ``name`` to what was typed, as a session reads it again."""
    value = text.strip()
    if BETWEEN in value or value.startswith(JSON_BEGINS):
        try:
            value = json_in(value)
        except ValueError:
            value = as_json(value)  # a name that looks like more than that
    return Edit(name, (), value)


def rule_value(draft: Draft, name: str) -> str:
    """Return what the rule ``name`` is in ``draft``, as it is typed."""
    value = rule_of(draft, name)
    return value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)


def rule_of(draft: Draft, name: str) -> Any:
    """Return what the rule ``name`` is in ``draft``: as drawn, else the usual."""
    value = draft.rules.get(name)
    if value is None:
        value = draft.section_class.model_fields[name].get_default(call_default_factory=True)
    return value


def number_of(draft: Draft, name: str) -> float:
    """Return the number that the rule ``name`` is; 0 where what stands there is none."""
    value = rule_of(draft, name)
    return float(value) if isinstance(value, int | float) else 0.0


# Tools and toolboxes


@dataclass(frozen=True, slots=True)
class Desk:
    """What a tool works with: the picture, the newest snapshot, what is drawn, and the ways to speak."""

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
    """One thing to draw with: panel, key line, menu, help, palette and docs derive from this row.

    ``key`` is Textual's name of the key, or that of a menu and a letter there; ``symbol`` is how people see
    it where that is otherwise. ``label`` has at most two words, ``help`` is a sentence of at most ten.
    ``use`` gets the toolbox, or whatever the tool belongs to, and the desk; ``click`` is what a click on it
    does instead. ``why_not`` tells why it can do nothing now, ``value`` what is current, for the menu.
    ``rank`` orders the key line (None: it is not there), and ``hint`` replaces key and label there, for tools
    that share an entry. A brush has a ``sign`` as on the map. In the panel what ``is_of_number`` stands
    above the first slider, and what ``is_told`` is said otherwise.
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
        """How people see its key."""
        return self.symbol or self.key

    @property
    def in_panel(self) -> bool:
        """Whether the panel lists it."""
        return not (self.is_told or self.is_of_number or self.is_in_menu)

    @property
    def is_in_menu(self) -> bool:
        """Whether a menu has it, and no single key."""
        return " " in self.key


class Toolbox(ABC):
    """The tools of one kind of world, and what is remembered between two of them."""

    tools: ClassVar[tuple[Tool, ...]]
    rest: ClassVar[str]
    """What the menu of the world has while it is drawn, in a few words."""

    @property
    def in_hand(self) -> ToolCell | None:
        """What there is to paint with, as the panel shows it; None where nothing is painted."""
        return None

    @abstractmethod
    def about(self, desk: Desk) -> tuple[str, ...]:
        """Return what stands under the cursor, the longest form first."""

    def advice(self, desk: Desk) -> tuple[str, ...]:
        """Return what a click does now, the longest form first."""
        return ()

    def lines(self, desk: Desk) -> tuple[SheetLine, ...]:
        """Return lines to choose from, what tools are about besides the place under the cursor."""
        return ()

    def choose_line(self, desk: Desk, line: int) -> None:
        """Choose one of them."""
        raise NotImplementedError

    def numbers(self, desk: Desk) -> tuple[WorldNumber, ...]:
        """Return the numbers that have a slider."""
        return ()

    def number_edits(self, desk: Desk, name: str, value: float) -> Sequence[Edit]:
        """Return the edits that set one of them. Raises ValueError, in words, where it cannot be that."""
        raise NotImplementedError

    def picked(self, desk: Desk) -> frozenset[int]:
        """Return the places that the next tool is about, besides the one under the cursor."""
        return frozenset()

    @abstractmethod
    def paint(self, desk: Desk, places: Sequence[int]) -> None:
        """Draw at the ``places`` over which the pointer was drawn, or that was clicked."""

    @abstractmethod
    def turn(self, desk: Desk, place: int, amount: float) -> None:
        """Change what a place pays, by the wheel."""

    def go_along(self, desk: Desk, step: tuple[int, int]) -> None:
        """Do what shift and an arrow mean, a step (rows down, columns right): move, if nothing more."""
        place = desk.view.cursor_place
        if place is not None:
            desk.view.put_cursor(desk.view.moved(place, *step))

    def cancel(self) -> bool:
        """Forget what was begun and not ended; return whether there was something."""
        return False

    def place_added(self, world: World) -> int | None:
        """Return the place of what a tool has added, the first time that it is in ``world``; else None."""
        return None
