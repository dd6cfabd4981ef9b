"""Choose what the run is to run until, and see which breakpoints there are."""

from __future__ import annotations

from collections.abc import Callable
from typing import ClassVar

from rich.text import Text
from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.widgets import OptionList, Static
from textual.widgets.option_list import Option

from rl_tui.tui.draw.to_ascii import to_ascii
from rl_tui.tui.screens.dialogs.dialog import Dialog
from rl_tui.tui.screens.dialogs.until_options import UntilOption
from rl_tui.tui.theme.glyphs import Glyphs

NO_BREAKPOINTS = "Breakpoints: none; k sets one where the cursor is."


class UntilChoice(Dialog[UntilOption]):
    """A list of ``options``, a sentence about the one under the cursor, and the ``breakpoints`` in words.

    The cursor starts on the option whose id is ``remembered``, if it is there. ``clear`` is asked to take the
    breakpoints away. Answers the chosen option.
    """

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("u,q", "cancel", "back", id="close_until", tooltip="Close without running."),
        Binding("K", "clear", "no breakpoints", id="until.clear", tooltip="Take all breakpoints away."),
    ]

    def __init__(
        self,
        options: tuple[UntilOption, ...],
        remembered: str,
        breakpoints: str,
        clear: Callable[[], None],
        glyphs: Glyphs,
    ) -> None:
        super().__init__()
        self._clear = clear
        self._options = {each.id: each for each in options}
        self._remembered = remembered
        self._breakpoints = breakpoints
        self._glyphs = glyphs

    def compose(self) -> ComposeResult:
        """Yield the list, the sentence and the breakpoints."""
        with self.box("Run until", "enter: run   esc: close"):
            yield OptionList(*(Option(self._row(each), id=each.id) for each in self._options.values()))
            yield Static(classes="hint", id="about", markup=False)
            yield Static(self._about_breakpoints(), classes="hint", id="breakpoints", markup=False)

    def on_mount(self) -> None:
        """Start on the one that was chosen last."""
        choices = self.query_one(OptionList)
        ids = list(self._options)
        choices.highlighted = ids.index(self._remembered) if self._remembered in ids else 0
        choices.focus()

    def on_option_list_option_highlighted(self, event: OptionList.OptionHighlighted) -> None:
        """Describe the option under the cursor, or say why it is not possible here."""
        option = self._options[str(event.option_id)]
        text = f"Not here. {option.refused}" if option.refused else option.hint
        self.query_one("#about", Static).update(to_ascii(text, self._glyphs))

    def on_option_list_option_selected(self, event: OptionList.OptionSelected) -> None:
        """Answer the chosen option, unless it is not possible here."""
        option = self._options[str(event.option_id)]
        if option.refused:
            self.app.bell()
        else:
            self.dismiss(option)

    def action_clear(self) -> None:
        """Take the breakpoints away; the list stays open."""
        self._clear()
        self._breakpoints = ""
        self.query_one("#breakpoints", Static).update(self._about_breakpoints())

    def _row(self, option: UntilOption) -> Text:
        return Text(to_ascii(option.name, self._glyphs), "dim" if option.refused else "bold")

    def _about_breakpoints(self) -> str:
        text = (
            f"Breakpoints: {self._breakpoints}. K takes them away." if self._breakpoints else NO_BREAKPOINTS
        )
        return to_ascii(text, self._glyphs)
