"""The folder of sessions."""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path
from typing import Final

import platformdirs

VARIABLE: Final = "RL_TUI_SESSIONS_DIR"


def session_folder() -> Path:
    """Return the folder of sessions, which may not exist."""
    chosen = os.environ.get(VARIABLE)
    if chosen:
        return Path(chosen)
    try:
        return platformdirs.user_state_path("rl-tui", appauthor=False) / "sessions"
    except RuntimeError:  # without a home folder, this path appears in the message that nothing can be saved
        return Path("~/.local/state/rl-tui/sessions")


def settled(folder: Path) -> Path:
    """Return an absolute path, independent of the current folder."""
    with suppress(OSError):  # the current folder may have been deleted
        return folder if is_homeless(folder) else folder.resolve()
    return folder


def is_homeless(folder: Path) -> bool:
    """Return True if `folder` needs a missing home folder."""
    return folder.parts[:1] == ("~",)
