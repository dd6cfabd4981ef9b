"""The branches of a run and what was changed in each: to go to one, to a change, or to compare with one."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import ClassVar, Final, NamedTuple

from rich.text import Text
from textual import events
from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.content import Content
from textual.widgets import OptionList, Static
from textual.widgets.option_list import Option

from rl_tui.agents.catalogue import algorithm_row
from rl_tui.agents.hyperparameters import PARAMETERS
from rl_tui.common.words import counted
from rl_tui.live.commands import AddBranch
from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.recipe import (
    EditWorld,
    JournalEntry,
    OrderSweep,
    Recipe,
    RedoEdit,
    SetParameter,
    Setting,
    SwitchAlgorithm,
    TakeAction,
    UndoEdit,
    WorldChange,
    changed_recipe,
)
from rl_tui.screen.dialogs.dialog import Dialog
from rl_tui.screen.dialogs.lane_changes import branches_beside
from rl_tui.screen.draw.names import action_name
from rl_tui.screen.draw.to_ascii import to_ascii
from rl_tui.screen.panels.controls.settings import called
from rl_tui.screen.theme.glyphs import Glyphs
from rl_tui.screen.theme.look import Look
from rl_tui.worlds.drawing import Arms
from rl_tui.worlds.editing.edit import BETWEEN, PREFIX, written_edits
from rl_tui.worlds.world import World

HOW_TO_BRANCH = "To make another branch, go back with b or B and change something."
NO_CHANGE = "Nothing was changed in this branch."
_MOST_EDITS: Final = 2  # of a stroke that are told


class Moment(NamedTuple):
    """Where to go: to a branch, counted from 0, and there to a step; None: to the moment shown."""

    branch: int
    step: int | None = None


class JournalScreen(Dialog[Moment | AddBranch]):
    """Branches above, and the journal of the one under the cursor below.

    Answers where to go, or the branch to compare with.
    """

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding(
            "c", "compare", "compare", id="journal.compare", tooltip="Open the branch chosen as another lane."
        ),
    ]

    def __init__(self, look: Look, snapshot: Snapshot) -> None:
        super().__init__()
        self._look = look
        self._timeline = snapshot.timeline
        self._unit = "pull" if isinstance(snapshot.world.drawing, Arms) else "step"
        self._lines = [
            journal_lines(branch.journal, snapshot.recipe, snapshot.world, look.glyphs)
            for branch in snapshot.timeline.branches
        ]
        self._beside = branches_beside(snapshot)
        self._shown = snapshot.timeline.branch

    def compose(self) -> ComposeResult:
        """Yield the two lists, and how to make a branch."""
        with self.box("Journal", "enter: go   c: compare   tab: list   esc: close"):
            yield OptionList(*map(self._described, range(len(self._lines))), id="branches")
            yield Static(classes="hint", id="whose", markup=False)
            yield OptionList(id="entries")
            yield Static(HOW_TO_BRANCH, classes="hint", id="how", markup=False)

    def on_mount(self) -> None:
        """Start on the branch in force."""
        self._branches.highlighted = self._timeline.branch
        self._branches.focus()
        self._show_entries()

    def on_descendant_focus(self, event: events.DescendantFocus) -> None:
        """Put the cursor on the first change; it is there only while the changes are in focus."""
        if event.widget is self._entries:
            self._entries.highlighted = 0

    def on_descendant_blur(self, event: events.DescendantBlur) -> None:
        """Take the cursor off the changes."""
        if event.widget is self._entries:
            self._entries.highlighted = None

    def on_option_list_option_highlighted(self, event: OptionList.OptionHighlighted) -> None:
        """Show the journal of the branch under the cursor."""
        if event.option_list is self._branches and event.option_index != self._shown:
            self._shown = event.option_index
            self._show_entries()

    def on_option_list_option_selected(self, event: OptionList.OptionSelected) -> None:
        """Answer the branch, or the moment of the change in it."""
        if event.option_list is self._branches:
            self.dismiss(Moment(event.option_index))
        else:
            self.dismiss(Moment(self._shown, self._lines[self._shown][event.option_index].step))

    def action_compare(self) -> None:
        """Answer the branch to stand beside the one in force."""
        name = self._timeline.branches[self._shown].name
        if self._shown in self._beside:
            self.dismiss(AddBranch(self._shown))
        elif self._shown != self._timeline.branch:
            self.notify(f"{name} is a lane already: l shows it")
        elif len(self._lines) > 1:
            self.notify(f"{name} is the one shown: choose another one")
        else:
            self.notify("there is no other branch to compare with")

    @property
    def _branches(self) -> OptionList:
        return self.query_one("#branches", OptionList)

    @property
    def _entries(self) -> OptionList:
        return self.query_one("#entries", OptionList)

    def _show_entries(self) -> None:
        glyphs = self._look.glyphs
        lines = self._lines[self._shown]
        name = self._timeline.branches[self._shown].name
        self.query_one("#whose", Static).update(f"Changes in {name}:" if lines else NO_CHANGE)
        self._entries.set_options(Option(Content(to_ascii(line.text, glyphs))) for line in lines)
        self._entries.display = bool(lines)

    def _described(self, number: int) -> Text:
        """Return the name of a branch, how far it came, where it was forked and how much was changed."""
        branches, glyphs = self._timeline.branches, self._look.glyphs
        branch = branches[number]
        in_force = "  (in force)" if number == self._timeline.branch else ""
        parts = [f"to {self._unit} {branch.end:,}"]
        if branch.parent is not None:
            parts.append(f"from {branches[branch.parent].name} at {self._unit} {branch.fork:,}")
        parts += _how_much(self._lines[number])
        text = Text(f"{branch.name}{in_force}", "bold")
        return text.append(f"\n{to_ascii(', '.join(parts), glyphs)}", "not bold")


def _how_much(lines: list[JournalLine]) -> list[str]:
    """Return how many changes there are, and how many steps by hand: ``2 changes``, ``61 by hand``."""
    changes, by_hand = sum(not line.by_hand for line in lines), sum(line.by_hand for line in lines)
    settings = [counted(changes, "change")] if changes else []
    steps = [f"{by_hand:,} by hand"] if by_hand else []
    return settings + steps or ["no change"]


@dataclass(frozen=True, slots=True)
class JournalLine:
    """What was done after ``step`` steps; ``by_hand`` counts steps of a person, up to step ``last``."""

    step: int
    last: int
    what: str
    by_hand: int = 0

    @property
    def text(self) -> str:
        """The line: ``step 1,200: α 0.1 → 0.5``, ``steps 3,400–3,460: 61 by hand``."""
        first = self.step + bool(self.by_hand)  # a setting applies after its step, a person takes the next
        when = f"step {first:,}" if self.last <= first else f"steps {first:,}–{self.last:,}"
        return f"{when}: {self.what}"


def journal_lines(
    journal: Sequence[JournalEntry], recipe: Recipe, world: World, glyphs: Glyphs
) -> list[JournalLine]:
    """Return ``journal`` in lines: one a setting and step, one for steps by hand in a row."""
    lines: list[JournalLine] = []
    for (kind, _), group in groupby(_keyed(journal), key=lambda each: each[0]):
        entries = [entry for _, entry in group]
        first, last = entries[0].step, entries[-1]
        if isinstance(last.change, TakeAction):
            what = f"{len(entries)} by hand"
            if len(entries) == 1:
                what = f"by hand {_taken(world, last.change.action, glyphs)}"
            lines.append(JournalLine(first, last.step + 1, what, len(entries)))
        elif isinstance(last.change, OrderSweep):
            lines.append(JournalLine(first, first, f"next sweep: {last.change.phase}"))
        elif isinstance(last.change, WorldChange):
            lines.append(JournalLine(first, first, _edited(last.change)))
        else:
            before, recipe = recipe, changed_recipe(recipe, last.change)
            was, is_now = _in_force(before, last.change), _in_force(recipe, last.change)
            lines.append(JournalLine(first, first, f"{kind} {was} → {is_now}".strip()))
    return lines


def _edited(change: WorldChange) -> str:
    """Return what was drawn: the first edits of a stroke, as text, and how many more there are."""
    match change:
        case EditWorld(edits):
            more = len(edits) - _MOST_EDITS
            shown = written_edits(edits[:_MOST_EDITS]).replace(PREFIX, "").replace(BETWEEN, f"{BETWEEN} ")
            return f"world: {shown}{f' and {more:,} more' if more > 0 else ''}"
        case UndoEdit():
            return "world: an edit undone"
        case RedoEdit():
            return "world: an edit made again"


def _taken(world: World, action: int | str, glyphs: Glyphs) -> str:
    """Return how an action that a person took is called; its name alone where this world has none such."""
    names = world.space.action_names
    if isinstance(action, str) and action not in names:
        return action
    return action_name(world, names.index(action) if isinstance(action, str) else action, glyphs)


def _keyed(journal: Sequence[JournalEntry]) -> Iterator[tuple[tuple[str, int], JournalEntry]]:
    """Yield each entry with what makes it one line with its neighbours: kind, and where the line began."""
    began, previous = 0, None
    for number, entry in enumerate(journal):
        change = entry.change
        if isinstance(change, TakeAction):
            follows = previous is not None and isinstance(previous.change, TakeAction)
            if not follows or previous is None or entry.step != previous.step + 1:
                began = entry.step
            yield ("by hand", began), entry
        elif isinstance(change, SetParameter):
            yield (PARAMETERS[change.name].symbol, entry.step), entry
        elif isinstance(change, OrderSweep):
            yield ("sweep", entry.step), entry
        elif isinstance(change, WorldChange):
            yield ("world", number), entry  # each stroke by itself
        else:
            yield ("", entry.step), entry
        previous = entry


def _in_force(recipe: Recipe, change: Setting) -> str:
    """Return how that which ``change`` sets is called as it is in ``recipe``."""
    if isinstance(change, SwitchAlgorithm):
        return algorithm_row(recipe.algorithm).name
    return called(change.name, recipe.hyperparameters.value(change.name))
