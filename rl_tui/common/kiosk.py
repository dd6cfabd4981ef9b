"""Kiosk mode, for strangers: writes nothing, and reads only shipped files."""

from __future__ import annotations

import os
from typing import Final

VARIABLE: Final = "RL_TUI_KIOSK"


def in_kiosk() -> bool:
    """Return True if this process runs in kiosk mode.

    The environment variable sets it, and so does ``--kiosk``. It also applies to child processes. The program
    never turns it off.
    """
    return os.environ.get(VARIABLE, "") not in ("", "0")
