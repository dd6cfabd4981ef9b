"""The choice of the driver."""

from __future__ import annotations

import os
import sys
from importlib import import_module
from typing import TYPE_CHECKING, Final

from rl_tui.common.errors import UserError
from rl_tui.common.findings import one_line

if TYPE_CHECKING:
    from textual.driver import Driver

# TEXTUAL_DRIVER of processes that the server starts
IN_BROWSER: Final = "rl_tui.screen.terminal.browser_driver:BrowserDriver"
_LONGEST_SHOWN: Final = 60


def in_browser() -> bool:
    """Return whether a browser shows this process, maybe to others."""
    return os.environ.get("TEXTUAL_DRIVER") == IN_BROWSER


def driver_class() -> type[Driver] | None:
    """Return our driver for a Unix terminal or browser, or None for Textual's choice.

    Raises:
        UserError: ``TEXTUAL_DRIVER`` does not name a driver.
    """
    wanted = os.environ.get("TEXTUAL_DRIVER")
    if wanted and wanted != IN_BROWSER:
        _check_driver(wanted)
    try:
        if wanted == IN_BROWSER:
            from rl_tui.screen.terminal.browser_driver import BrowserDriver

            return BrowserDriver
        if not wanted and sys.platform != "win32":
            from rl_tui.screen.terminal.driver import TerminalDriver

            return TerminalDriver
    except ImportError:
        if wanted:
            from textual.drivers.web_driver import WebDriver

            return WebDriver
    return None


def _check_driver(named: str) -> None:
    from textual.driver import Driver

    module, _, name = named.partition(":")
    try:
        found = getattr(import_module(module), name, None)
    except Exception:  # a foreign module may raise anything
        found = None
    if not (isinstance(found, type) and issubclass(found, Driver)):
        raise UserError(
            f"TEXTUAL_DRIVER={one_line(named, _LONGEST_SHOWN)} is not a driver of Textual; unset it"
        )
