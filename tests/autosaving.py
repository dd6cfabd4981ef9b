"""Autosaves of a student's evening."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from recipes import recipe
from session_samples import after, fresh

from rl_tui.live.record import Record
from rl_tui.live.sessions.autosave import Autosave
from rl_tui.live.sessions.session import StoredSession, sessions_in

OPENED = fresh(recipe("student"))


def at(step: int) -> Record:
    return after(OPENED, step)


def only(folder: Path) -> StoredSession:
    assert len(os.listdir(folder)) == 1
    (session,), _ = sessions_in(folder)
    return session


def kept(folder: Path, *offered: Record, **how: Any) -> Autosave:
    autosave = Autosave(OPENED, folder, **how)
    for record in offered:
        autosave.offer(record)
    autosave.close()
    return autosave


def notices_of(autosave: Autosave) -> list[str]:
    notices: list[str] = []
    autosave.listen(notices.append)
    return notices
