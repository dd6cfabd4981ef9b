"""The menus and their rows."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

from rl_tui.screen.board.subject import Subject
from rl_tui.screen.frame.menu_strip import MenuStrip
from rl_tui.screen.keys.action import Action, menu_title

_AGENT: Final = "a"


@dataclass(eq=False)
class MenuActions(Subject):
    """The opening of menus."""

    def open(self, key: str) -> None:
        """Open the menu of ``key``."""
        title = "Your program" if self._is_of_program(key) else menu_title(key, self._listed(key))
        strip = MenuStrip(self.screen.look, title, lambda: list(map(self._valued, self._listed(key))))
        self.ask(strip, self._do)

    def _is_of_program(self, key: str) -> bool:
        return key == _AGENT and self.snapshot is not None and self.snapshot.program is not None

    def _listed(self, key: str) -> list[Action]:
        is_of_program = self._is_of_program(key)
        return [each for each in self.screen.listed(key) if each.of_program or not is_of_program]

    def _valued(self, action: Action) -> Action:
        target, _, deed = (action.command or action.id).partition(".")
        subject = getattr(self.screen, target, None)
        value = action.value or (subject.value(deed) if isinstance(subject, Subject) else "")
        return replace(action, value=value)

    def _do(self, id_: str) -> None:
        action = next(each for each in self.screen.actions if each.id == id_)
        self.screen.call_later(self.screen.run_action, action.textual_action)
