"""Where sessions are kept."""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path
from typing import Final

import platformdirs

VARIABLE: Final = "RL_TUI_SESSIONS_DIR"


def session_folder() -> Path:
    """Return the folder of sessions; it need not exist, nor be one that can be made."""
    chosen = os.environ.get(VARIABLE)
    if chosen:
        return Path(chosen)
    try:
        return platformdirs.user_state_path("rl-tui", appauthor=False) / "sessions"
    except RuntimeError:  # nobody knows a home: where it would be is told when nothing can be kept there
        return Path("~/.local/state/rl-tui/sessions")


def settled(folder: Path) -> Path:
    """Return ``folder`` as a path that stays the same wherever the program goes, where there is one."""
    with suppress(OSError):  # the folder that the program was started in may be gone
        return folder if is_homeless(folder) else folder.resolve()
    return folder


def is_homeless(folder: Path) -> bool:
    """Tell whether ``folder`` would be in the home of somebody who has none."""
    return folder.parts[:1] == ("~",)
