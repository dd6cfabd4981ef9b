"""Kiosk mode, for strangers: it writes nothing, and reads only shipped files."""

from __future__ import annotations

import os
from typing import Final

VARIABLE: Final = "RL_TUI_KIOSK"


def in_kiosk() -> bool:
    """Return True in kiosk mode, set by the environment variable or ``--kiosk``.

    It also applies to child processes, and is never turned off.
    """
    return os.environ.get(VARIABLE, "") not in ("", "0")
