"""Choose one of the algorithms, with what each of them does."""

from __future__ import annotations

from rich.text import Text
from textual.app import ComposeResult
from textual.containers import Vertical
from textual.widgets import OptionList
from textual.widgets.option_list import Option

from rl_tui.agents.catalogue import ALGORITHMS, Algorithm
from rl_tui.tui.screens.dialog import Dialog
from rl_tui.tui.theme.glyphs import Glyphs
from rl_tui.tui.written import written


class AlgorithmChoice(Dialog[str]):
    """A list of the algorithms. Answers the id of the one chosen; escape answers None."""

    def __init__(self, glyphs: Glyphs, current: str) -> None:
        super().__init__()
        self._glyphs = glyphs
        self._current = current

    def compose(self) -> ComposeResult:
        """Yield the list."""
        with Vertical(id="box") as box:
            yield OptionList(*(Option(self._describe(each), id=each.id) for each in ALGORITHMS))
        box.border_title = "Algorithm"
        box.border_subtitle = "enter: choose   esc: close"

    def on_mount(self) -> None:
        """Start on the algorithm in force."""
        choices = self.query_one(OptionList)
        choices.highlighted = choices.get_option_index(self._current)
        choices.focus()

    def on_option_list_option_selected(self, event: OptionList.OptionSelected) -> None:
        """Answer the chosen one."""
        self.dismiss(event.option_id)

    def _describe(self, algorithm: Algorithm) -> Text:
        in_force = "  (in force)" if algorithm.id == self._current else ""
        text = Text(written(f"{algorithm.name}{in_force}", self._glyphs), "bold")
        for line in (
            algorithm.summary,
            algorithm.equation,
            f"Sutton & Barto, 2nd ed., {algorithm.source}",
        ):
            text.append(written(f"\n{line}", self._glyphs), "not bold")
        return text
