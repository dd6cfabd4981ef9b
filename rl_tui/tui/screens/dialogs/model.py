"""The model of the scenario: the outcomes of every pair."""

from __future__ import annotations

from collections.abc import Callable
from typing import ClassVar

from textual.app import ComposeResult
from textual.binding import Binding, BindingType

from rl_tui.lab.live.snapshot import Snapshot
from rl_tui.tui.panels.model.model import ModelPanel
from rl_tui.tui.screens.dialogs.dialog import Dialog
from rl_tui.tui.theme.look import Look


class ModelScreen(Dialog[None]):
    """⟨S, A, P, R, γ⟩, with the outcomes of the pair under the table's cursor, live while it is open."""

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("m,q", "cancel", "back", id="close_model", tooltip="Close the model."),
        Binding("h", "hide", "answer", id="model.hide", tooltip="Hide or show the exact answer."),
    ]

    def __init__(
        self,
        look: Look,
        snapshot: Snapshot,
        pair: int | None,
        *,
        on_scrolled: Callable[[], None],
        hide_answer: Callable[[], None],
    ) -> None:
        super().__init__()
        self._hide_answer = hide_answer
        self._on_scrolled = on_scrolled
        self._panel = ModelPanel(look, id="box", classes="tall")
        self._snapshot = snapshot
        self._pair = pair

    def compose(self) -> ComposeResult:
        """Yield the panel."""
        yield self._panel

    def on_mount(self) -> None:
        """Show what is known already."""
        self.show(self._snapshot)
        if self._pair is not None:
            self._panel.show_pair(self._pair)
        self._panel.focus()

    @property
    def pair(self) -> int | None:
        """The pair whose outcomes are shown."""
        return self._panel.pair

    def on_scrolled(self) -> None:
        """Tell the playground that another pair of a large world is shown."""
        self._on_scrolled()

    def action_hide(self) -> None:
        """Hide or show the exact answer, as on the playground."""
        self._hide_answer()

    def show(self, snapshot: Snapshot) -> None:
        """Draw the newest snapshot."""
        self._panel.show(snapshot)
