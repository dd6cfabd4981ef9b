"""Which driver stands between the app and the terminal."""

from __future__ import annotations

import os
import sys
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from textual.driver import Driver

IN_BROWSER: Final = "rl_tui.terminal.browser_driver:BrowserDriver"  # TEXTUAL_DRIVER of what the server starts


def in_browser() -> bool:
    """Return whether this process is served to a browser, where others than its owner may sit."""
    return os.environ.get("TEXTUAL_DRIVER") == IN_BROWSER


def driver_class() -> type[Driver] | None:
    """Return ours for a terminal of Unix and for a browser, None for whatever Textual takes.

    Ours are made with private names of Textual. Where one is missing, Textual's own driver serves.
    """
    wanted = os.environ.get("TEXTUAL_DRIVER")
    try:
        if wanted == IN_BROWSER:
            from rl_tui.terminal.browser_driver import BrowserDriver

            return BrowserDriver
        if not wanted and sys.platform != "win32":
            from rl_tui.terminal.driver import TerminalDriver

            return TerminalDriver
    except ImportError:
        if wanted:
            from textual.drivers.web_driver import WebDriver

            return WebDriver
    return None
