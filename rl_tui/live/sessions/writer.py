"""The writer of a session, which keeps its file locked."""

from __future__ import annotations

import errno
import os
from collections.abc import Callable
from pathlib import Path
from typing import Final

from rl_tui.common.errors import UserError
from rl_tui.common.files import FileLock, remove_with_draft, signature, write_atomically
from rl_tui.live.record import Record
from rl_tui.live.sessions.document import LONGEST_NAME
from rl_tui.live.sessions.place import VARIABLE, is_homeless
from rl_tui.live.sessions.session import StoredSession, encoded, named_path, new_path, prune

# The locked file


PRIVATE: Final = 0o700


class ChangedElsewhereError(Exception):
    """Another program has written the file meanwhile."""


class HeldFile:
    """A file locked by `hold` or `hold_new` until `release`."""

    def __init__(self, path: Path, lock: FileLock, written: tuple[int, ...]) -> None:
        self.path = path
        self._lock = lock
        self._written = written

    def write(self, content: bytes) -> None:
        """Replace the content atomically, also of a deleted file.

        Raises OSError, or ChangedElsewhereError if a program that ignores the lock has written it, or another
        has it since the folder was deleted.
        """
        _make_folder(self.path.parent)
        if not self._lock.keep():
            raise ChangedElsewhereError
        if self.path.exists() and signature(self.path.stat()) != self._written:
            raise ChangedElsewhereError
        write_atomically(self.path, content)
        self._written = signature(self.path.stat())

    def remove(self) -> None:
        """Remove and release the file. Raises OSError."""
        remove_with_draft(self.path)
        self.release()

    def release(self) -> None:
        """Unlock the file."""
        self._lock.release()


def hold(session: StoredSession) -> HeldFile | None:
    """Lock the file of `session`, unless it is open elsewhere, changed or read-only."""
    path = session.path.resolve()
    lock = FileLock(path)
    try:
        if not (os.access(path, os.W_OK) and lock.acquire()):
            return None
        if signature(path.stat()) == session.written:
            return HeldFile(path, lock, session.written)
    except OSError:
        pass
    lock.release()
    return None


def hold_new(path: Path) -> HeldFile:
    """Lock a new file, creating its folder.

    Raises FileExistsError if it exists, or another program is about to create it, else OSError.
    """
    _make_folder(path.parent)
    lock = FileLock(path)
    if not lock.acquire() or path.exists():
        lock.release()
        raise FileExistsError(path)
    return HeldFile(path, lock, ())


def _make_folder(folder: Path) -> None:
    """Create `folder`. Raises OSError, but never FileExistsError, which refers to a file."""
    if is_homeless(folder):
        raise OSError(errno.ENOENT, f"there is no home folder; set HOME or {VARIABLE}")
    try:
        folder.mkdir(parents=True, exist_ok=True, mode=PRIVATE)
    except FileExistsError:
        raise NotADirectoryError(errno.ENOTDIR, os.strerror(errno.ENOTDIR), str(folder)) from None


# The writer


_COPY: Final = " (copy)"
_MOST_TRIES: Final = 100
OPEN_ELSEWHERE: Final = "is open in another program or cannot be written"
LESSON: Final = "lesson"


class SessionWriter:
    """Writes one session. Its file is created with the first record, and locked until `release`.

    Use it from one thread at a time. A session `resumed` is continued in its file, in a copy if that is open
    elsewhere or read-only.
    """

    def __init__(self, folder: Path, resumed: StoredSession | None, tell: Callable[[str], None]) -> None:
        self.title = ""
        """Name given by the user, or ""."""
        self.kept = False
        """True if the user saved it, so that it is never pruned."""
        self._folder = folder
        self._tell = tell
        self._file: HeldFile | None = None
        if resumed is not None:
            self._go_on_with(resumed)

    @property
    def path(self) -> Path | None:
        """Path of the file, if any."""
        return self._file.path if self._file else None

    def write(self, record: Record, digest: str) -> None:
        """Write `record`. Raises OSError, UserError."""
        if self._file is not None:
            try:
                self._file.write(self._encoded(record, digest))
            except ChangedElsewhereError:
                self._tell(
                    f"{self._file.path.name} was changed by another program; your work is saved in a copy"
                )
                self.become_copy()
            else:
                return
        self._file = self._begin_file(record)
        self._file.write(self._encoded(record, digest))
        prune(self._folder)

    def save_as(self, title: str, record: Record, digest: str) -> Path:
        """Write `record` as `title`, and continue at the returned path.

        Raises UserError if another session has that name, or the file cannot be written.
        """
        path, old = named_path(self._folder, title), self._file
        content = encoded(record, title=title, kept=True, digest=digest)
        try:
            file = old if old is not None and old.path == path else hold_new(path)
        except FileExistsError:
            raise UserError(f"another session is called {title}; type another name") from None
        except OSError as error:
            raise UserError(f"it cannot be saved: {reason(error)}") from error
        try:
            file.write(content)
        except (OSError, ChangedElsewhereError) as error:
            if file is not old:
                file.release()
            raise UserError(f"it cannot be saved: {reason(error)}") from error
        if old is not None and old is not file:
            self._let_go(old)
        self._file, self.title, self.kept = file, title, True
        return path

    def become_copy(self) -> None:
        """Leave the file unchanged, and continue in another one."""
        self.release()
        self._file, self.kept = None, False
        if self.title and not self.title.endswith(_COPY):
            self.title = f"{self.title[: LONGEST_NAME - len(_COPY)]}{_COPY}"

    def release(self) -> None:
        """Unlock the file."""
        if self._file is not None:
            self._file.release()

    def _go_on_with(self, session: StoredSession) -> None:
        self.title, self.kept = session.document.title, session.document.kept
        self._file = hold(session)
        if self._file is None:
            self.become_copy()
            self._tell(f"{session.path.name} {OPEN_ELSEWHERE}; what you do here is saved in a copy")

    def _encoded(self, record: Record, digest: str) -> bytes:
        return encoded(record, title=self.title, kept=self.kept, digest=digest)

    def _begin_file(self, record: Record) -> HeldFile:
        subject = record.lanes[0].recipe.scenario.id
        if record.lesson is not None:
            subject = f"{LESSON}-{record.lesson.lesson.id}"
        for _ in range(_MOST_TRIES):
            try:
                return hold_new(new_path(self._folder, subject))
            except FileExistsError:  # another program was quicker
                continue
        raise UserError("found no free file name")

    def _let_go(self, old: HeldFile) -> None:
        if self.kept or old.path.parent != self._folder:
            old.release()
        else:
            old.remove()


def reason(error: Exception) -> str:
    """Return why a write failed, in a few words."""
    if isinstance(error, OSError):
        place = f"{error.filename}: " if error.filename else ""
        return f"{place}{error.strerror or error}"
    if isinstance(error, ChangedElsewhereError):
        return "it was changed by another program"
    return str(error) if isinstance(error, UserError) else f"{type(error).__name__}: {error}"
