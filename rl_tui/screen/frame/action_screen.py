"""The base of start screen and playground."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Final, TypeAlias

from textual.actions import parse
from textual.app import ComposeResult
from textual.events import Key
from textual.geometry import Offset
from textual.notifications import SeverityLevel
from textual.screen import Screen
from textual.widget import Widget
from textual.widgets import Static

from rl_tui.screen.frame.key_line import KeyLine
from rl_tui.screen.frame.message_line import tell
from rl_tui.screen.frame.shape import MESSAGE_HEIGHT, ROOMY_HEIGHT, ROOMY_WIDTH
from rl_tui.screen.keys.action import Action, Place
from rl_tui.screen.keys.registry import actions_of
from rl_tui.screen.kit.bindings import as_sentence
from rl_tui.screen.theme.look import Look

if TYPE_CHECKING:
    from rl_tui.screen.dialogs.dialog import Dialog
    from rl_tui.screen.frame.glossary import HelpPages

LEAST_WIDTH: Final = 60
LEAST_HEIGHT: Final = 18

# Classes that the screen gets from this width or height on; the style sheets use them.
_WIDTHS: Final = [
    (0, "-too-narrow"),
    (LEAST_WIDTH, "-narrow"),
    (ROOMY_WIDTH, "-broad"),
]
_HEIGHTS: Final = [
    (0, "-too-short"),
    (LEAST_HEIGHT, "-short"),
    (MESSAGE_HEIGHT, "-medium"),
    (ROOMY_HEIGHT, "-tall"),
]


Ask: TypeAlias = Callable[[], object]
Put: TypeAlias = Callable[[float | str], object]


class TooSmall(Static):
    """A notice about a small terminal."""

    def __init__(self, look: Look) -> None:
        super().__init__(id="too-small", markup=False)
        self.look = look

    def on_resize(self) -> None:
        """Name the actual and the needed size."""
        width, height = self.app.size
        text = f"terminal too small: is {width}×{height}, needs {LEAST_WIDTH}×{LEAST_HEIGHT}"
        self.update(self.look.glyphs.spelled(text))


class ActionScreen(Screen[None]):
    """A full screen. Subclasses set ``place`` and yield their ``content``."""

    HORIZONTAL_BREAKPOINTS = _WIDTHS
    VERTICAL_BREAKPOINTS = _HEIGHTS

    place: Place

    def __init__(self, look: Look) -> None:
        super().__init__()
        self.look = look
        self.mouse_at_key = Offset(0, 0)  # place at the last key; has it moved since?

    @property
    def known_actions(self) -> tuple[Action, ...]:
        """Every action of this place at some time."""
        return actions_of(self.place)

    @property
    def actions(self) -> tuple[Action, ...]:
        """The actions available now."""
        return self.listed()

    def listed(self, menu: str = "") -> tuple[Action, ...]:
        """Return the available actions, maybe of one ``menu``."""
        return tuple(each for each in self.known_actions if not menu or each.menu == menu)

    @property
    def settings(self) -> Mapping[str, tuple[Ask, Put]]:
        """Functions that ask for and set values."""
        return {}

    @property
    def in_kiosk(self) -> bool:
        """True if this screen must not touch files."""
        return Place.KIOSK in self.place

    def action_do(self, command: str) -> None:
        """Run ``object.method`` or ``object.method(argument)``."""
        target, method, arguments = parse(command)
        getattr(getattr(self, target), method)(*arguments)

    def compose(self) -> ComposeResult:
        """Yield content, key line and notice."""
        yield from self.content()
        yield KeyLine(self.look, self.known_actions, id="keys")
        yield TooSmall(self.look)

    def tell(
        self, message: str, severity: SeverityLevel = "information", timeout: float | None = None
    ) -> None:
        """Show ``message`` until a key, or for ``timeout`` seconds."""
        tell(self.app, message, severity, timeout)

    def refuse(self, why: str) -> None:
        """Show the clause ``why`` as a sentence."""
        self.tell(as_sentence(why))

    def on_key(self, event: Key) -> None:
        """Remember the mouse's place, so that ``?`` knows if it has moved."""
        if event.key != "question_mark":
            self.mouse_at_key = self.app.mouse_position

    def action_quit(self) -> None:
        """Exit the app."""
        self.app.exit()

    @cached_property
    def pages(self) -> HelpPages:
        """The pages of ``?``, made late."""
        from rl_tui.screen.frame.glossary import HelpPages

        return HelpPages(self)

    def action_help(self) -> None:
        """Explain what the mouse points at, or list the keys."""
        self.pages.open()

    def help_screen(self) -> Dialog[str]:
        """Return the help pages."""
        raise NotImplementedError

    def content(self) -> Iterable[Widget]:
        """Yield the widgets above the key line."""
        raise NotImplementedError
