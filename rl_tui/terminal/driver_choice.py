"""Which driver stands between the app and the terminal, and what only some of them can do."""

from __future__ import annotations

import os
import sys

from textual.driver import Driver


def driver_class() -> type[Driver] | None:
    """Return ours for a terminal of Unix, None for whatever Textual takes: on Windows, or in a browser."""
    if sys.platform == "win32" or os.environ.get("TEXTUAL_DRIVER"):
        return None
    from rl_tui.terminal.driver import TerminalDriver

    return TerminalDriver


async def go_to_shell(driver: Driver | None) -> bool:
    """Stop until the shell says go on; False where there is no shell to go to."""
    suspend = getattr(driver, "suspend", None)
    if driver is None or suspend is None or not driver.can_suspend:
        return False
    return bool(await suspend())
