"""A folder of sessions that is removed during a save."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

from autosaving import OPENED, at, notices_of, only

from rl_tui.common.files import FileLock
from rl_tui.live.sessions.autosave import Autosave
from rl_tui.live.sessions.session import encoded, read_session, sessions_in


def lost(folder: Path) -> tuple[Autosave, Path]:
    autosave = Autosave(OPENED, folder)
    autosave.offer(at(1))
    autosave.write_due()
    assert autosave.path is not None
    shutil.rmtree(folder)
    return autosave, autosave.path


def test_it_is_made_again_with_the_session_and_its_lock(tmp_path: Path) -> None:
    folder = tmp_path / "state" / "sessions"
    autosave, path = lost(folder)
    autosave.offer(at(2))
    autosave.write_due()
    assert read_session(path).step == 2
    assert not FileLock(path).acquire()
    autosave.close()
    assert only(folder).step == 2
    assert notices_of(autosave) == []


def test_what_somebody_else_began_there_meanwhile_is_left_alone(tmp_path: Path) -> None:
    folder = tmp_path / "sessions"
    autosave, path = lost(folder)
    folder.mkdir()
    theirs = FileLock(path)
    assert theirs.acquire()
    path.write_bytes(encoded(at(70)))
    autosave.offer(at(2))
    autosave.close()
    theirs.release()
    assert sorted(each.step for each in sessions_in(folder)[0]) == [2, 70]
    assert any("your work is saved in a copy" in notice for notice in notices_of(autosave))


def test_where_it_cannot_be_made_again_that_is_said_and_it_goes_on_later(tmp_path: Path) -> None:
    folder = tmp_path / "sessions"
    autosave, _ = lost(folder)
    folder.write_text("in the way")
    for step in (2, 3):
        autosave.offer(at(step))
        autosave.write_due()
    os.remove(folder)
    autosave.write_due()
    assert only_step(folder) == 3
    assert notices_of(autosave) == [
        f"this session is not being saved: {folder}: Not a directory",
        "this session is being saved again",
    ]
    autosave.close()


def only_step(folder: Path) -> int:
    (session,), _ = sessions_in(folder)
    return session.step
