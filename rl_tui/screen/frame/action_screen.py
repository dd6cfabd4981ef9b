"""What catalogue and playground share: a place in the registry of actions, a key line, a least size."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
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

from rl_tui.screen.draw.to_ascii import to_ascii
from rl_tui.screen.frame.key_line import KeyLine
from rl_tui.screen.frame.message_line import tell
from rl_tui.screen.frame.shape import MESSAGE_HEIGHT, ROOMY_HEIGHT, ROOMY_WIDTH
from rl_tui.screen.keys.action import Action, Place
from rl_tui.screen.keys.registry import actions_of
from rl_tui.screen.kit.bindings import as_sentence
from rl_tui.screen.kit.row import PanelRow
from rl_tui.screen.panels.catalogue import PANELS
from rl_tui.screen.theme.look import Look

if TYPE_CHECKING:
    from rl_tui.screen.dialogs.dialog import Dialog
    from rl_tui.screen.frame.glossary import HelpPages

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
    (MESSAGE_HEIGHT, "-medium"),
    (ROOMY_HEIGHT, "-tall"),
]


Ask: TypeAlias = Callable[[], object]
Put: TypeAlias = Callable[[float | str], object]


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
        self.mouse_at_key = Offset(0, 0)  # at the last key that asked nothing: since then it may have moved

    @property
    def known_actions(self) -> tuple[Action, ...]:
        """What a person can do in this place at some time."""
        return actions_of(self.place, self.panel_rows)

    @property
    def actions(self) -> tuple[Action, ...]:
        """What a person can do here now: what palette and help list."""
        return self.listed()

    def listed(self, menu: str = "") -> tuple[Action, ...]:
        """Return what a person can do here now by ``menu``, or by any key."""
        return tuple(each for each in self.known_actions if not menu or each.menu == menu)

    @property
    def settings(self) -> Mapping[str, tuple[Ask, Put]]:
        """The settings of the agent, by name: what asks for a value, and what sets one."""
        return {}

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

    def refuse(self, why: str) -> None:
        """Tell ``why`` something cannot be done now, a clause, as a sentence."""
        self.tell(as_sentence(why))

    def on_key(self, event: Key) -> None:
        """Note where the mouse is: what asks is not what moved a cursor."""
        if event.key != "question_mark":
            self.mouse_at_key = self.app.mouse_position

    def action_quit(self) -> None:
        """Quit."""
        self.app.exit()

    @cached_property
    def pages(self) -> HelpPages:
        """The pages of ``?``; they bring widgets that the first paint has no need of."""
        from rl_tui.screen.frame.glossary import HelpPages

        return HelpPages(self)

    def action_help(self) -> None:
        """Show the keys of this place, or explain what the mouse points at."""
        self.pages.open()

    def help_screen(self) -> Dialog[str]:
        """Return the pages about panels, planners and the like."""
        raise NotImplementedError

    def content(self) -> Iterable[Widget]:
        """Yield the widgets above the key line."""
        raise NotImplementedError
