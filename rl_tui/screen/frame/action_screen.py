"""What catalogue and playground share: a place in the registry of actions, a key line, a least size."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Final

from textual.actions import parse
from textual.app import ComposeResult
from textual.events import Key
from textual.geometry import Offset
from textual.notifications import SeverityLevel
from textual.screen import Screen
from textual.widget import Widget
from textual.widgets import Static

from rl_tui.screen.draw.to_ascii import to_ascii
from rl_tui.screen.frame.key_line import KeyLine
from rl_tui.screen.frame.moment import tell
from rl_tui.screen.frame.shape import ROOMY_HEIGHT, ROOMY_WIDTH
from rl_tui.screen.keys.action import Action, Place
from rl_tui.screen.keys.registry import actions_of
from rl_tui.screen.kit.row import PanelRow, beside
from rl_tui.screen.panels.catalogue import PANELS
from rl_tui.screen.theme.look import Look

if TYPE_CHECKING:
    from rl_tui.screen.frame.number_here import NumberHere

LEAST_WIDTH: Final = 60
LEAST_HEIGHT: Final = 18

# From which width, or height, on the screen has which class: the style sheets use them
_WIDTHS: Final = [
    (0, "-too-narrow"),
    (LEAST_WIDTH, "-narrow"),
    (ROOMY_WIDTH, "-broad"),
]
_HEIGHTS: Final = [
    (0, "-too-short"),
    (LEAST_HEIGHT, "-short"),
    (ROOMY_HEIGHT, "-tall"),
]


class TooSmall(Static):
    """Says that the terminal is too small, in place of everything else."""

    def __init__(self, look: Look, *, id: str | None = None) -> None:  # noqa: A002
        super().__init__(id=id, markup=False)
        self.look = look

    def on_resize(self) -> None:
        """Name the size there is and the one that is needed."""
        width, height = self.app.size
        text = f"terminal too small: is {width}×{height}, needs {LEAST_WIDTH}×{LEAST_HEIGHT}"
        self.update(to_ascii(text, self.look.glyphs))


class ActionScreen(Screen[None]):
    """A screen that fills the terminal. Subclasses name their ``place`` and yield their ``content``.

    Its keys are those of its ``actions``: of the registry, and of the ``panels`` that keys open.
    """

    HORIZONTAL_BREAKPOINTS = _WIDTHS
    VERTICAL_BREAKPOINTS = _HEIGHTS

    place: Place

    def __init__(self, look: Look, panels: Sequence[PanelRow] = PANELS) -> None:
        super().__init__()
        self.look = look
        self.panel_rows = panels
        self._mouse_at_key = Offset(0, 0)  # at the last key that asked nothing

    @property
    def known_actions(self) -> tuple[Action, ...]:
        """What a person can do in this place at some time."""
        return actions_of(self.place, self.panel_rows)

    @property
    def actions(self) -> tuple[Action, ...]:
        """What a person can do here now: what palette and help list."""
        return self.known_actions

    @property
    def in_kiosk(self) -> bool:
        """Whether it has no files here; the app says so in its ``place``."""
        return Place.KIOSK in self.place

    def action_do(self, command: str) -> None:
        """Do what ``command`` says, ``object.method`` or ``object.method(argument)``."""
        target, method, arguments = parse(command)
        getattr(getattr(self, target), method)(*arguments)

    def compose(self) -> ComposeResult:
        """Yield the content, the key line and what replaces them in a terminal too small."""
        yield from self.content()
        yield KeyLine(self.look, self.known_actions, id="keys")
        yield TooSmall(self.look, id="too-small")

    def tell(
        self, message: str, severity: SeverityLevel = "information", timeout: float | None = None
    ) -> None:
        """Show ``message`` about this moment: it goes with the next key, or after ``timeout`` seconds."""
        tell(self.app, message, severity, timeout)

    def on_key(self, event: Key) -> None:
        """Note where the mouse is: what asks is not what moved a cursor."""
        if event.key != "question_mark":
            self._mouse_at_key = self.app.mouse_position

    def action_help(self) -> None:
        """Explain what the mouse or the focus is on; where that is no word, show the help."""
        # these bring widgets that the first paint has no need of
        from rl_tui.screen.frame.glossary import number_under_mouse, words_here
        from rl_tui.screen.frame.number_here import number_here

        rows = {name: row for row in self.panel_rows for name in (row.id, beside(row.id))}
        number = None
        if self.app.mouse_position != self._mouse_at_key or self.focused is None:
            number = number_under_mouse(self, self.look)
        is_pointed_at = number is not None
        number = number or number_here(self.focused, self.look)
        here = words_here(
            self, rows, self.look.glyphs, has_number=number is not None, is_number_first=is_pointed_at
        )
        if here:
            self.show_words(here, number)
        else:
            self.app.push_screen(self.help_screen())

    def action_glossary(self) -> None:
        """Show all words."""
        self.show_words(())

    def show_words(self, here: Sequence[str], number: NumberHere | None = None) -> None:
        """Show the terms with the ids ``here``, or all; from there the help is a key away.

        ``number`` is what is under the cursor, for ``NUMBER`` among the ids.
        """
        from rl_tui.screen.frame.glossary import GlossaryScreen, setting_here

        def closed(asks_for_help: bool | None) -> None:
            if asks_for_help:
                self.app.push_screen(self.help_screen())

        self.app.push_screen(
            GlossaryScreen(self.look, here, number, setting_here(self, self.look.glyphs)), closed
        )

    def help_screen(self, *, at_keys: bool = False) -> Screen[None]:
        """Return the help, from its first line on or from the keys on."""
        raise NotImplementedError

    def content(self) -> Iterable[Widget]:
        """Yield the widgets above the key line."""
        raise NotImplementedError
