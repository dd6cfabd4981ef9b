"""Messages of the moment: what is told of what was just done, until something else is done."""

from __future__ import annotations

from typing import Any

from textual.app import App
from textual.notifications import Notification, Notify, SeverityLevel


class OfTheMoment(Notification):
    """A message that counts until the next key or click."""


class MomentaryMessages:
    """Takes the messages of the moment off the screen of ``app`` when that is over."""

    def __init__(self, app: App[Any]) -> None:
        self._app = app
        self._shown: list[OfTheMoment] = []

    def note(self, notification: Notification) -> None:
        """Remember ``notification``, which is being shown, if it is of the moment."""
        if isinstance(notification, OfTheMoment):
            self._shown.append(notification)

    def end(self) -> None:
        """Take away what was told until now."""
        shown, self._shown = self._shown, []
        forget = getattr(self._app, "_unnotify", None)
        for notification in shown:
            if forget is None:
                self._app.clear_notifications()
            else:
                forget(notification)


def tell(app: App[Any], message: str, severity: SeverityLevel, timeout: float | None) -> None:
    """Show ``message`` in place of all others until the next key or click, ``timeout`` seconds at most."""
    app.clear_notifications()
    seconds = app.NOTIFICATION_TIMEOUT if timeout is None else timeout
    app.post_message(Notify(OfTheMoment(message, severity=severity, timeout=seconds)))


def hide_messages_behind(app: App[Any]) -> None:
    """Leave no message on the screens behind the one in front, which shows all of them."""
    for screen in app.screen_stack[:-1]:
        for rack in screen.query("ToastRack"):
            rack.display = False
