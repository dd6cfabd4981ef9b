"""The pages of ``?``: keys, then words, then what there is to know about panels."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from textual.geometry import Offset

from rl_tui.screen.kit.row import beside

if TYPE_CHECKING:
    from rl_tui.screen.frame.action_screen import ActionScreen
    from rl_tui.screen.frame.number_here import NumberHere


class HelpPages:
    """Shows the pages about ``screen``, one after the other as ``?`` is pressed."""

    def __init__(self, screen: ActionScreen) -> None:
        self._screen = screen
        self._mouse_at_key = Offset(0, 0)

    def note_key(self) -> None:
        """Note where the mouse is at a key that asks nothing: it points at something once it has moved."""
        self._mouse_at_key = self._screen.app.mouse_position

    @property
    def _is_pointing(self) -> bool:
        return self._screen.app.mouse_position != self._mouse_at_key

    def open(self) -> None:
        """Show the keys; where the mouse was moved onto a word or a number, explain that."""
        words, number = self._words_here() if self._is_pointing else ((), None)
        if words:
            self.show_words(words, number)
        else:
            self._show_keys()

    def _show_keys(self) -> None:
        from rl_tui.screen.frame.key_sheet import KeySheet

        screen, focused = self._screen, self._screen.focused
        titles = {row.id: row.title for row in screen.panel_rows}
        nodes = () if focused is None else focused.ancestors_with_self
        name = next((titles[node.id] for node in nodes if node.id in titles), "")
        screen.app.push_screen(KeySheet(screen.look, screen.actions, focused, name), self._turn)

    def show_words(self, here: Sequence[str], number: NumberHere | None = None) -> None:
        """Show the terms with the ids ``here``, or all; the pages are a key away.

        ``number`` is what is under the cursor, for ``NUMBER`` among the ids.
        """
        from rl_tui.screen.frame.glossary import GlossaryScreen, setting_here

        screen = self._screen
        setting = setting_here(screen, screen.look.glyphs)
        screen.app.push_screen(GlossaryScreen(screen.look, here, number, setting), self._turn)

    def _turn(self, page: str | None) -> None:
        """Go on to another ``page``; None: the one in view was closed."""
        from rl_tui.screen.frame.key_sheet import FIND, KEYS, PAGES, WORDS

        if page == KEYS:
            self._show_keys()
        elif page == WORDS:
            self.show_words(*self._words_here())
        elif page == PAGES:
            self._screen.app.push_screen(self._screen.help_screen(), self._turn)
        elif page == FIND:
            self._screen.call_later(self._screen.app.run_action, "find")

    def _words_here(self) -> tuple[Sequence[str], NumberHere | None]:
        """Return the ids of the terms about what the mouse or the focus is on, and the number there.

        The number under the mouse counts only where that points at something, or nothing has the focus.
        """
        # these bring widgets that the first paint has no need of
        from rl_tui.screen.frame.glossary import number_under_mouse, words_here
        from rl_tui.screen.frame.number_here import number_here

        screen, look = self._screen, self._screen.look
        rows = {name: row for row in screen.panel_rows for name in (row.id, beside(row.id))}
        pointed = number_under_mouse(screen, look) if self._is_pointing or screen.focused is None else None
        number = pointed or number_here(screen.focused, look)
        words = words_here(
            screen,
            rows,
            look.glyphs,
            has_number=number is not None,
            is_number_first=pointed is not None,
        )
        return words, number
