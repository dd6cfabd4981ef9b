"""The message line, which hides no panel.

High screens keep a free row for it. On lower ones it replaces most of the key line.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from typing import Any, Final

from rich.cells import cell_len
from rich.style import Style
from textual.app import App, ScreenStackError
from textual.content import Content
from textual.css.query import NoMatches
from textual.notifications import Notification, Notify, SeverityLevel
from textual.screen import Screen
from textual.widget import MountError
from textual.widgets import Static

from rl_tui.common.errors import UserError
from rl_tui.screen.draw.canvas import shortened, wrapped
from rl_tui.screen.frame.shape import MESSAGE_HEIGHT
from rl_tui.screen.keys.action import Action
from rl_tui.screen.kit.bindings import as_sentence
from rl_tui.screen.terminal.linked_app import LinkedApp
from rl_tui.screen.theme.look import Look

MOST_ROWS: Final = 3
CLOSE: Final = "esc: close"
_FRAME: Final = 3  # cells: the bar at the left, and a blank on each side
_GAP: Final = 2


class OfTheMoment(Notification):
    """A message until a key or click."""


def tell(app: App[Any], message: str, severity: SeverityLevel, timeout: float | None) -> None:
    """Replace all messages until a key, or for ``timeout`` seconds."""
    app.clear_notifications()
    seconds = app.NOTIFICATION_TIMEOUT if timeout is None else timeout
    app.post_message(Notify(OfTheMoment(message, severity=severity, timeout=seconds)))


def complain(app: App[Any], fault: object) -> None:
    """Show an error until escape."""
    app.notify(str(fault), severity="error", markup=False)


@contextmanager
def complaining(app: App[Any]) -> Iterator[None]:
    """Show a UserError. The block ends there."""
    try:
        yield
    except UserError as fault:
        complain(app, fault)


class Messages:
    """The current messages, the newest on the front screen. Errors stay until escape or another screen."""

    def __init__(self, app: LinkedApp[Any], look: Callable[[], Look]) -> None:
        self._app = app
        self._look = look
        self._told: list[tuple[Notification, Screen[Any]]] = []
        self._line: MessageLine | None = None

    @property
    def texts(self) -> list[str]:
        """The current texts, the oldest first."""
        return [note.message for note, _ in self._told]

    def note(self, notification: Notification) -> None:
        """Show ``notification``, in place of one with the same text."""
        self._told = [told for told in self._told if told[0].message != notification.message]
        with suppress(ScreenStackError):
            self._told.append((notification, self._app.screen_stack[:2][-1]))
        if not _is_fault(notification):
            self._app.start_timer(
                notification.timeout, lambda: self._keep(lambda note: note is not notification), repeats=False
            )
        self.show()

    def end_moment(self) -> None:
        """Remove messages that last until a key."""
        if self._told:  # every key comes here, and mostly there are no messages
            self._keep(lambda note: not _is_of_moment(note))

    def end_fault(self) -> bool:
        """Remove the shown error, and return whether there was one."""
        shown = self._newest()
        is_fault = any(map(_is_fault, shown))
        if is_fault:
            self._keep(lambda note: note not in shown)
        return is_fault

    def clear(self) -> None:
        """Remove everything except errors."""
        self._keep(_is_fault)

    def follow(self, _: object) -> None:
        """Move the message to the front screen, and drop errors of left screens."""
        stack = self._app.screen_stack
        self._told = [(note, of) for note, of in self._told if of in stack or not _is_fault(note)]
        self.show()

    def show(self) -> None:
        """Show the newest message in front."""
        with suppress(ScreenStackError, NoMatches, MountError):
            screen = self._app.screen
            if self._line is not None and (self._line.parent is not screen or not self._line.is_attached):
                self._line.display = False
                self._line.remove()
                self._line = None
            if self._line is None and self._told:
                line = MessageLine(self._look)
                screen.mount(line)
                self._line = line
            if self._line is not None:
                self._line.show(self._newest())

    def _newest(self) -> tuple[Notification, ...]:
        notes = [note for note, _ in self._told]
        is_moment = bool(notes) and _is_of_moment(notes[-1])
        return tuple(filter(_is_of_moment, notes) if is_moment else notes[-1:])

    def _keep(self, stays: Callable[[Notification], bool]) -> None:
        kept = [(note, of) for note, of in self._told if stays(note)]
        if len(kept) != len(self._told):
            self._told = kept
            self.show()


def _sentence(notification: Notification) -> str:
    title = f"{notification.title}: " if notification.title else ""
    return as_sentence(f"{title}{notification.message}")


def _is_of_moment(notification: Notification) -> bool:
    return isinstance(notification, OfTheMoment) and not _is_fault(notification)


def _is_fault(notification: Notification) -> bool:
    return notification.severity == "error"


class MessageLine(Static):
    """The rows of one message."""

    DEFAULT_CLASSES = "-textual-system"

    def __init__(self, look: Callable[[], Look]) -> None:
        super().__init__(markup=False)
        self.display = False
        self._look = look
        self._messages: tuple[Notification, ...] = ()

    def show(self, messages: tuple[Notification, ...]) -> None:
        """Show ``messages`` in turn, or hide."""
        self._messages = messages
        self.display = bool(messages)
        self._fit()

    def on_mount(self) -> None:
        """Draw the messages from before the mount."""
        self._fit()

    def on_resize(self) -> None:
        """Wrap the text again."""
        self._fit()

    def on_click(self) -> None:
        """Close an error."""
        self.app.simulate_key("escape")

    def _fit(self) -> None:
        if not self._messages or not self.is_attached:
            return
        look, severities = self._look(), {each.severity for each in self._messages}
        is_fault, has_row = "error" in severities, self.app.size.height >= MESSAGE_HEIGHT
        self.set_class(is_fault, "-error")
        self.set_class("warning" in severities, "-warning")
        hint = CLOSE if is_fault else "" if has_row else look.glyphs.spelled(self._first_hint)
        text = " ".join(map(_sentence, self._messages))
        width = self.app.size.width - _FRAME
        lines = _lines(text, width - cell_len(hint) - _GAP if hint else width, look)
        if len(lines) > 1 and not is_fault:
            lines, hint = _lines(text, width, look), ""
        if hint:
            lines[-1] = f"{lines[-1]}{' ' * (width - cell_len(lines[-1]) - cell_len(hint))}{hint}"
        self.styles.height = len(lines)
        self.styles.margin = (0, 0, 1 if has_row and len(lines) == 1 else 0, 0)
        self.update(Content("\n".join(lines)))

    @property
    def _first_hint(self) -> str:
        actions: tuple[Action, ...] = getattr(self.screen, "known_actions", ())
        ranked = [action for action in actions if action.rank is not None]
        return " ".join(min(ranked, key=lambda action: action.rank or 0).key_hint) if ranked else ""


def _lines(text: str, width: int, look: Look) -> list[str]:
    lines = ["".join(piece.text for piece in line) for line in wrapped(text, width, Style.null(), look)]
    rows = lines[: MOST_ROWS - 1]
    if len(lines) > len(rows):
        rows.append(shortened(" ".join(lines[MOST_ROWS - 1 :]), width, look.glyphs.ellipsis))
    return [shortened(row, width, look.glyphs.ellipsis) for row in rows]
