"""The world editor's tools, and a world's rules."""

from __future__ import annotations

import json
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Final, Generic, TypeVar

from rl_tui.agents.hyperparameters import Parameter, Range, Slide
from rl_tui.common.errors import UserError, complaint
from rl_tui.common.limits import LARGEST_NUMBER, LARGEST_STD, LONGEST_TIME_LIMIT, STRONGEST_WIND
from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.dialogs.dialog import Dialog
from rl_tui.screen.dialogs.form import Candidate, Choice, Prompt
from rl_tui.screen.kit.bindings import as_sentence
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
        "noise": "share of moves that slip, half to each side (0 to 1)",
        "slippery": "as on Gymnasium's ice: ahead, left and right equally likely (true or false)",
        "step_reward": "living reward: added to every step",
        "bump_reward": "added to steps stopped by a wall or the edge",
        "time_limit": "steps until the time limit, 0 for none",
        "rewards": "entering or leaving: when a cell pays",
        "moves": "four, clockwise, king or king+stay",
        "wind": "for each column: cells up per step",
        "wind_rows": "for each row: cells to the right per step",
        "gusts": "wind sometimes one cell stronger or weaker (true or false)",
    },
    "mdp": {
        "time_limit": "steps until the time limit, 0 for none",
        "start": "a state, or a table of states and chances",
    },
    "bandit": {
        "std": "standard deviation of the rewards",
        "drift": "after every pull, each mean takes a random step with this standard deviation",
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


def ask_rules(_: object, desk: Desk[Any]) -> None:
    """Ask for a rule, then its value."""
    draft = desk.draft
    candidates = [
        Candidate(name, name, (as_sentence(text),), value=rule_value(draft, name))
        for name, text in RULES[draft.kind].items()
    ]
    desk.ask(Choice("Rules of the world", candidates, "", desk.glyphs), lambda name: _ask_rule(desk, name))


def _ask_rule(desk: Desk[Any], name: str) -> None:
    draft, now = desk.draft, rule_value(desk.draft, name)
    if name in WORDS:
        candidates = [
            Candidate(word, word, refused=_fault_of(draft, (_rule_edit(name, word),), name))
            for word in WORDS[name]
        ]
        title = f"{name}: {RULES[draft.kind][name]}"
        desk.ask(
            Choice(title, candidates, now, desk.glyphs), lambda word: desk.draw((_rule_edit(name, word),))
        )
        return

    def read(text: str) -> str:
        checked(draft, _rule_edit(name, text))
        return text

    desk.ask(
        Prompt(name, RULES[draft.kind][name], now, read),
        lambda text: desk.draw((_rule_edit(name, str(text)),)),
    )


def next_word(_: object, desk: Desk[Any], name: str) -> None:
    """Set a rule to its next word."""
    words, now = WORDS[name], rule_value(desk.draft, name)
    edit = _rule_edit(name, words[(words.index(now) + 1) % len(words)] if now in words else words[0])
    fault = _fault_of(desk.draft, (edit,), name)
    if fault:
        desk.tell(f"{name} stays {now}: {fault}")
    else:
        desk.draw((edit,))


def _fault_of(draft: Draft, edits: Sequence[Edit], name: str) -> str:
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


def checked(draft: Draft, edit: Edit) -> tuple[Edit]:
    """Return ``edit`` of the rule that it names. Raises ValueError if it is impossible."""
    if fault := _fault_of(draft, (edit,), edit.name):
        raise ValueError(fault)
    return (edit,)


def _rule_edit(name: str, text: str) -> Edit:
    value = text.strip()
    if BETWEEN in value or value.startswith(JSON_BEGINS):
        try:
            value = json_in(value)
        except ValueError:
            value = as_json(value)  # a name that only looks like JSON
    return Edit(name, (), value)


def rule_value(draft: Draft, name: str) -> str:
    """Return a rule's value in typed form."""
    value = rule_of(draft, name)
    return value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)


def rule_of(draft: Draft, name: str) -> Any:
    """Return a rule's value, or its default."""
    value = draft.rules.get(name)
    if value is None:
        value = draft.section_class.model_fields[name].get_default(call_default_factory=True)
    return value


def number_of(draft: Draft, name: str) -> float:
    """Return a rule's number, else 0."""
    value = rule_of(draft, name)
    return float(value) if isinstance(value, int | float) else 0.0


# Tools and toolboxes


OwnDraft = TypeVar("OwnDraft", bound=Draft)


@dataclass(frozen=True, slots=True)
class Desk(Generic[OwnDraft]):
    """The inputs of a tool."""

    view: WorldView
    snapshot: Snapshot
    draft: OwnDraft
    glyphs: Glyphs
    draw: Callable[[Sequence[Edit]], None]
    tell: Callable[[str], None]
    ask: Callable[[Dialog[Any], Callable[[Any], None]], None]


Use = Callable[[Any, Any], None]
Tell = Callable[[Any, Any], str]


def _nothing(_: object, __: object) -> str:
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

    def also(self, **more: Any) -> Tool:
        """Set ``more`` fields of a row."""
        return replace(self, **more)

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
        """True if only a menu has it."""
        return " " in self.key


class Toolbox(ABC, Generic[OwnDraft]):
    """The tools of one kind of world."""

    tools: ClassVar[tuple[Tool, ...]]
    rest: ClassVar[str]
    """A few words about the menu of the world during editing."""

    @property
    def in_hand(self) -> ToolCell | None:
        """The brush in the panel, if any."""
        return None

    @abstractmethod
    def about(self, desk: Desk[OwnDraft]) -> tuple[str, ...]:
        """Describe what is under the cursor."""

    def advice(self, desk: Desk[OwnDraft]) -> tuple[str, ...]:
        """Describe what a click does."""
        return ()

    def lines(self, desk: Desk[OwnDraft]) -> tuple[SheetLine, ...]:
        """Return lines to choose from."""
        return ()

    def choose_line(self, desk: Desk[OwnDraft], line: int) -> None:
        """Choose one of the lines."""
        raise NotImplementedError

    def numbers(self, desk: Desk[OwnDraft]) -> tuple[WorldNumber, ...]:
        """Return the numbers with a slider."""
        return ()

    def number_edits(self, desk: Desk[OwnDraft], name: str, value: float) -> Sequence[Edit]:
        """Return the edits that set a number. Raises ValueError if the value is not possible."""
        raise NotImplementedError

    def picked(self, desk: Desk[OwnDraft]) -> frozenset[int]:
        """Return the places selected for the next tool."""
        return frozenset()

    @abstractmethod
    def paint(self, desk: Desk[OwnDraft], places: Sequence[int]) -> None:
        """Draw at ``places``."""

    @abstractmethod
    def turn(self, desk: Desk[OwnDraft], place: int, amount: float) -> None:
        """Change a place's reward by the wheel."""

    def go_along(self, desk: Desk[OwnDraft], step: tuple[int, int]) -> None:
        """Handle shift and an arrow, by default a move."""
        place = desk.view.cursor_place
        if place is not None:
            desk.view.put_cursor(desk.view.moved(place, *step))

    def cancel(self) -> bool:
        """Cancel an unfinished action, and return whether there was one."""
        return False

    def place_added(self, world: World) -> int | None:
        """Return the place that a tool has added, once."""
        return None


# Numbers with a slider, and numbers as text


_ANY: Final = Range(-LARGEST_NUMBER, LARGEST_NUMBER)
_WIND: Final = Range(-STRONGEST_WIND, STRONGEST_WIND)

PAYS: Final = Parameter("pays", "pays", "reward: of the cell under the cursor", _ANY, slide=Slide(-10, 10))
NOISE: Final = Parameter(
    "noise", "noise", "noise: share of moves that slip, half to each side", Range(0, 1), slide=Slide()
)
LIVING: Final = Parameter(
    "step_reward", "living", "living reward: added to the reward of every step", _ANY, slide=Slide(-1, 1)
)
LIMIT: Final = Parameter(
    "time_limit",
    "limit",
    "time limit: steps after which an episode is truncated, 0 for none",
    Range(0, LONGEST_TIME_LIMIT),
    whole=True,
    slide=Slide(0, 500),
)
WIND: Final = Parameter(
    "wind",
    "wind ↑",
    "wind: cells up per step, in the column of the cursor",
    _WIND,
    whole=True,
    slide=Slide(-3, 3),
)
WIND_ROWS: Final = Parameter(
    "wind_rows",
    "wind →",
    "wind: cells to the right per step, in the row of the cursor",
    _WIND,
    whole=True,
    slide=Slide(-3, 3),
)
CHANCE: Final = Parameter(
    "chance",
    "chance",
    "chance: probability of the chosen outcome. The others share the rest",
    Range(0, 1),
    slide=Slide(),
)
MEAN: Final = Parameter(
    "mean", "mean", "mean: what the arm under the cursor pays on average", _ANY, slide=Slide(-3, 3)
)
SUCCESS: Final = Parameter(
    "mean", "mean", "mean: how often the arm under the cursor pays", Range(0, 1), slide=Slide()
)
SPREAD: Final = Parameter(
    "std", "std", "spread: standard deviation of the rewards", Range(0, LARGEST_STD), slide=Slide(0, 5)
)
DRIFT: Final = Parameter(
    "drift",
    "drift",
    "drift: after every pull, each mean takes a random step with this standard deviation",
    Range(0, LARGEST_STD),
    slide=Slide(),
)


def number_text(value: float, digits: int = 6) -> str:
    """Write a number with the screen's minus."""
    return f"{value:.{digits}g}".replace("-", "−")


def number_in(text: str) -> float:
    """Return the typed number. Raises ValueError if it is not a number, or too large."""
    try:
        number = float(text.replace("−", "-"))
    except ValueError:
        raise ValueError("type a number, such as -1 or 0.5") from None
    if not abs(number) <= LARGEST_NUMBER:
        raise ValueError(f"type a number from {-LARGEST_NUMBER:g} to {LARGEST_NUMBER:g}")
    return number
