"""Kiosk mode, for a room of strangers: nothing is written, and nothing read but what is shipped."""

from __future__ import annotations

import os
from typing import Final

VARIABLE: Final = "RL_TUI_KIOSK"


def in_kiosk() -> bool:
    """Return whether this process is a kiosk, by the environment variable or by ``--kiosk``, which sets it.

    It holds for the whole process and all that it starts, as the system's limits do: nothing in the program
    turns it off.
    """
    return os.environ.get(VARIABLE, "") not in ("", "0")
