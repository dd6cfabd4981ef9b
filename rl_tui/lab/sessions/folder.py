"""The sessions in a folder: what is in it, how files are called, and what is thrown away."""

from __future__ import annotations

import re
import time
from contextlib import suppress
from datetime import UTC, datetime
from pathlib import Path
from typing import Final

from rl_tui.common.errors import UserError
from rl_tui.common.file_lock import FileLock
from rl_tui.lab.sessions.atomic_file import drafts_in, remove_with_draft, signature
from rl_tui.lab.sessions.session import SUFFIX, SessionError, StoredSession, read_session
from rl_tui.worlds.sections.schema import is_plain

MOST_UNNAMED: Final = 50
_LONGEST_WRITE: Final = 60.0  # seconds, by far
_LONGEST_STEM: Final = 200  # bytes: file systems take 255, of which a lock needs some


def files_in(folder: Path) -> list[Path]:
    """Return the files in ``folder`` that should be sessions."""
    try:
        # hidden ones are the locks and drafts of others
        return sorted(path for path in folder.glob(f"*{SUFFIX}") if not path.name.startswith("."))
    except OSError:  # a folder that may not be read holds nothing
        return []


def sessions_in(folder: Path) -> tuple[list[StoredSession], list[SessionError]]:
    """Return the sessions in ``folder``, the last one saved first, and what is wrong with other files.

    Those in which nothing was done are left out.
    """
    sound, broken = all_sessions_in(folder)
    return [session for session in sound if not session.is_blank], broken


def all_sessions_in(folder: Path) -> tuple[list[StoredSession], list[SessionError]]:
    """Return what :func:`sessions_in` does, and those in which nothing was done too."""
    sound, broken = [], []
    for path in files_in(folder):
        try:
            sound.append(read_session(path))
        except SessionError as error:
            broken.append(error)
    # of those saved in one second the order on the disk decides
    sound.sort(key=lambda session: (session.saved, session.written[1]), reverse=True)
    return sound, broken


def prune(folder: Path) -> None:
    """Remove all but the newest 50 sessions that nobody gave a name, and what was left half done.

    Those in which nothing was done go too; those open somewhere stay, and those of lessons: of what was
    learned nothing is thrown away. What cannot be removed stays as well:
    that is no reason to keep nothing new.
    """
    unnamed = [session for session in all_sessions_in(folder)[0] if not session.stays]
    worth_keeping = [session for session in unnamed if not session.is_blank][:MOST_UNNAMED]
    for session in unnamed:
        if session not in worth_keeping:
            lock = FileLock(session.path)
            with suppress(OSError):
                # it may have been gone on with, or named, since it was read
                if lock.acquire() and signature(session.path.stat()) == session.written:
                    remove_with_draft(session.path)
            lock.release()
    _remove_old_drafts(folder)


def _remove_old_drafts(folder: Path) -> None:
    """Remove what programs that were killed while they wrote have left."""
    for path, draft in drafts_in(folder, SUFFIX):
        lock = FileLock(path)
        with suppress(OSError):
            # on file systems without locks its age alone tells it from one that is being written
            if lock.acquire() and time.time() - draft.stat().st_mtime > _LONGEST_WRITE:
                draft.unlink()
        lock.release()


def remove(session: StoredSession) -> None:
    """Remove the file of ``session``. Raises UserError where it is open somewhere or cannot be removed."""
    lock = FileLock(session.path)
    try:
        if not lock.acquire():
            raise UserError(f"{session.title} is open in another program; close it there first")
        remove_with_draft(session.path)
    except OSError as error:
        raise UserError(f"{session.path}: cannot be removed ({error.strerror or error})") from error
    finally:
        lock.release()


def new_path(folder: Path, subject: str) -> Path:
    """Return a path in ``folder`` that no file has, named after its subject and the moment."""
    moment = datetime.now(UTC).strftime("%Y%m%d-%H%M%S")
    stem = f"{file_stem(subject)}-{moment}"
    candidate, number = folder / f"{stem}{SUFFIX}", 1
    while candidate.exists():
        number += 1
        candidate = folder / f"{stem}-{number}{SUFFIX}"
    return candidate


def named_path(folder: Path, name: str) -> Path:
    """Return the path of the session called ``name``. Raises UserError where that cannot be a name."""
    from rl_tui.lab.sessions.document import LONGEST_NAME

    if not name.strip():
        raise UserError("type a name")
    if len(name) > LONGEST_NAME or not is_plain(name):
        raise UserError(f"type one line of at most {LONGEST_NAME} characters")
    return folder / f"{file_stem(name)}{SUFFIX}"


def file_stem(name: str) -> str:
    """Return ``name`` with nothing but letters, digits and dashes: harmless in every file system."""
    words = re.sub(r"[\W_]+", "-", name.lower()).strip("-")
    return words.encode()[:_LONGEST_STEM].decode(errors="ignore") or "session"
