"""Why nothing is learned, and what would change that."""

from __future__ import annotations

from dataclasses import dataclass

from rl_tui.agents.exact.first_update_cause import Remedy
from rl_tui.lab.live.commands import AskWhy
from rl_tui.lab.live.snapshot import Snapshot
from rl_tui.tui.screens.dialogs.why import Why
from rl_tui.tui.screens.playground.actions.agent import AgentActions
from rl_tui.tui.screens.playground.actions.subject import Subject


@dataclass(eq=False)
class WhyActions(Subject):
    """The wait for the first update; a remedy is set by the ``agent``."""

    agent: AgentActions
    _dialog: Why | None = None

    def explain(self) -> None:
        """Show how long nothing is learned, why, and what would help, until it is closed."""
        if self.snapshot is None:
            return
        self.link.send(AskWhy(is_asked=True))
        self._dialog = Why(self.screen.look, self.snapshot)
        self.screen.app.push_screen(self._dialog, self._closed)

    def show(self, snapshot: Snapshot) -> None:
        """Tell it of ``snapshot``, if that is open."""
        if self._dialog is not None:
            self._dialog.show(snapshot)

    def _closed(self, remedy: Remedy | None) -> None:
        self._dialog = None
        self.link.send(AskWhy(is_asked=False))
        if remedy is not None:
            self.agent.set_parameter(remedy.setting, remedy.value)
