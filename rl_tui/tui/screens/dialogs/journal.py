"""The branches of a run and what was changed in each; enter goes to a branch, or to a change in one."""

from __future__ import annotations

from typing import NamedTuple

from rich.text import Text
from textual import events
from textual.app import ComposeResult
from textual.containers import Vertical
from textual.content import Content
from textual.widgets import OptionList, Static
from textual.widgets.option_list import Option

from rl_tui.common.words import counted
from rl_tui.lab.live.snapshot import Snapshot
from rl_tui.tui.draw.to_ascii import to_ascii
from rl_tui.tui.screens.dialogs.dialog import Dialog
from rl_tui.tui.screens.dialogs.journal_text import JournalLine, journal_lines
from rl_tui.tui.theme.look import Look
from rl_tui.worlds.drawing import Arms

HOW_TO_BRANCH = "To make another branch, go back with b or B and change something."
NO_CHANGE = "Nothing was changed in this branch."


class Moment(NamedTuple):
    """Where to go: to a branch, counted from 0, and there to a step; None where it was left."""

    branch: int
    step: int | None = None


class JournalScreen(Dialog[Moment]):
    """Branches above, and the journal of the one under the cursor below. Answers where to go."""

    def __init__(self, look: Look, snapshot: Snapshot) -> None:
        super().__init__()
        self._look = look
        self._timeline = snapshot.timeline
        self._unit = "pull" if isinstance(snapshot.world.drawing, Arms) else "step"
        self._lines = [
            journal_lines(branch.journal, snapshot.recipe, snapshot.world, look.glyphs)
            for branch in snapshot.timeline.branches
        ]
        self._shown = snapshot.timeline.branch

    def compose(self) -> ComposeResult:
        """Yield the two lists, and how to make a branch."""
        with Vertical(id="box") as box:
            yield OptionList(*map(self._described, range(len(self._lines))), id="branches")
            yield Static(classes="hint", id="whose", markup=False)
            yield OptionList(id="entries")
            yield Static(HOW_TO_BRANCH, classes="hint", id="how", markup=False)
        box.border_title = "Journal"
        box.border_subtitle = "enter: go there   tab: changes   esc: close"

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
