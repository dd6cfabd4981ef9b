"""Session files, one JSON file each. The start screen does not wait for the document model."""

from __future__ import annotations

import hashlib
import json
import re
from contextlib import suppress
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, NoReturn

from pydantic import ValidationError

from rl_tui.common.errors import UserError
from rl_tui.common.files import FileLock, free_name, remove_old_drafts, remove_with_draft, signature
from rl_tui.common.findings import is_plain, one_line, place
from rl_tui.common.kiosk import in_kiosk
from rl_tui.common.limits import LARGEST_SESSION
from rl_tui.common.text_file import UnreadableError, read_bytes

if TYPE_CHECKING:
    from pydantic_core import ErrorDetails

    from rl_tui.live.record import Record
    from rl_tui.live.sessions.document import Document
    from rl_tui.worlds.mdp.space import FloatArray


# Reading and encoding a file


SUFFIX: Final = ".json"
MOST_PAIRS_DIGESTED: Final = 100_000
OTHER_BITS: Final = (
    "Q differs from the saved one: the version of rl-tui, NumPy or Numba has changed, and so has the run"
)
_CHECKSUM: Final = "checksum"
_LONGEST_FAULT: Final = 300


class SessionError(UserError):
    """An invalid session file: its `path`, and the `fault` with a remedy."""

    def __init__(self, path: Path, fault: str) -> None:
        super().__init__(f"{one_line(str(path), 1000)}: {one_line(fault, _LONGEST_FAULT)}")
        self.path = path
        self.fault = one_line(fault, _LONGEST_FAULT)


@dataclass(frozen=True, slots=True, eq=False)
class StoredSession:
    """A valid session file. `written` distinguishes it from a later version."""

    path: Path
    document: Document
    written: tuple[int, ...]

    @property
    def title(self) -> str:
        """Title by user, lesson or scenario."""
        document = self.document
        lesson = "" if document.lesson is None else document.lesson.title
        return document.title or lesson or document.scenario.title or document.scenario.id

    @property
    def saved(self) -> datetime:
        """Last save, in UTC."""
        return datetime.fromisoformat(self.document.saved).astimezone(UTC)

    @property
    def step(self) -> int:
        """Step of the visible run."""
        lane = self.document.lanes[self.document.shown]
        return lane.branches[lane.branch].here

    @property
    def is_blank(self) -> bool:
        """True without step, drawing, name or lesson."""
        document = self.document
        branches = [branch for lane in document.lanes for branch in lane.branches]
        has_steps = any(branch.end for branch in branches)
        is_drawn = any(entry.world for branch in branches for entry in branch.journal)
        return not (has_steps or is_drawn or document.drawn or document.title or self.stays)

    @property
    def stays(self) -> bool:
        """True if saved by the user or a lesson's, and never pruned."""
        return self.document.kept or self.document.lesson is not None

    @property
    def algorithm(self) -> str:
        """Id of the current algorithm."""
        return self.document.lanes[self.document.shown].algorithm_in_force

    @property
    def changes(self) -> int:
        """Number of changes in all branches."""
        return self.document.changes

    @lru_cache(maxsize=1)  # noqa: B019  # one is opened at a time: checked first, then put on the screen
    def record(self) -> Record:
        """Return the record to resume. Raises SessionError if unusable here."""
        from rl_tui.live.sessions.encoding import record_of

        try:
            return record_of(self.document)
        except UserError as fault:
            raise SessionError(self.path, str(fault)) from fault


def read_session(path: Path) -> StoredSession:
    """Read a session. Raises SessionError if invalid, or in a kiosk."""
    if in_kiosk():
        raise SessionError(path, "kiosk mode opens no files: only the shipped scenarios")
    try:
        content, status = read_bytes(path, "the .json file of a session", LARGEST_SESSION)
    except UnreadableError as reason:
        raise SessionError(path, str(reason)) from reason
    return StoredSession(path, _document(path, content), signature(status))


def encoded(record: Record, *, title: str = "", kept: bool = False, digest: str = "") -> bytes:
    """Encode `record` as a session file. Raises UserError if it is too large, or its scenario's file unknown.

    Sessions without `kept` may be pruned. `digest` is that of the visible run's Q, or "".
    """
    from rl_tui.live.sessions.encoding import document_of

    fields = document_of(record, title=title, kept=kept, digest=digest)
    try:
        content = json.dumps({**fields, _CHECKSUM: checksum_of(fields)}, allow_nan=False).encode()
    except ValueError as error:
        raise UserError(f"the session contains a number that a file cannot hold ({error})") from error
    if len(content) > LARGEST_SESSION:
        raise UserError(f"the session is larger than {LARGEST_SESSION // 10**6} MB")
    return content


def digest_of(q: FloatArray) -> str:
    """Return a digest of all bits of `q`, `[P]`, "" above 100,000 pairs."""
    if len(q) > MOST_PAIRS_DIGESTED:
        return ""
    import numpy as np  # the catalogue lists sessions before it is needed

    return hashlib.sha256(np.ascontiguousarray(q, dtype="<f8").tobytes()).hexdigest()


def _document(path: Path, content: bytes) -> Document:
    from rl_tui.live.sessions.document import FORMAT, VERSION, Document

    fields = _fields(path, content, FORMAT)
    if fields.get("format") != FORMAT:
        raise SessionError(path, "not a session; choose a file that rl-tui saved")
    version = fields.get("version")
    if isinstance(version, int) and version > VERSION:
        raise SessionError(
            path, f"saved by a newer rl-tui (file format {version}, not {VERSION}); update rl-tui"
        )
    checksum = fields.pop(_CHECKSUM, None)
    if checksum != checksum_of(fields):
        raise SessionError(path, "damaged or edited (wrong checksum); open an earlier copy")
    try:
        document = Document.model_validate(fields)
        if not 1970 <= datetime.fromisoformat(document.saved).year < 9000:
            raise ValueError(f"{document.saved}: expected a time from 1970 to 8999")
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        where = place(first["loc"]) or "the document"
        raise SessionError(path, f"not a valid session: {where}: {_reason(first)}") from error
    except ValueError as error:
        raise SessionError(path, f"not a valid session: saved: {error}") from error
    return document


def _reason(error: ErrorDetails) -> str:
    if error["type"] == "value_error":
        return str(error["ctx"]["error"])
    return error["msg"].lower()


def _fields(path: Path, content: bytes, mark: str) -> dict[str, Any]:
    """Parse the object in `content`; `mark` distinguishes a truncated session from another file."""
    if not content:
        raise SessionError(path, "the file is empty; open an earlier copy")
    try:
        fields = json.loads(content.decode("utf-8"), parse_constant=_refuse_constant)
    except (ValueError, RecursionError) as error:
        if mark.encode() in content[:100]:
            raise SessionError(path, "incomplete or damaged; open an earlier copy") from error
        raise SessionError(path, "not JSON, so not a session of rl-tui") from error
    if not isinstance(fields, dict):
        raise SessionError(path, "not a session; choose a file that rl-tui saved")
    return fields


def _refuse_constant(name: str) -> NoReturn:
    raise ValueError(f"{name} is not JSON")


def checksum_of(fields: dict[str, Any]) -> str:
    """Return the SHA-256 of `fields` in a canonical form."""
    text = json.dumps(fields, sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()


# The folder of sessions


MOST_UNNAMED: Final = 50
_LONGEST_STEM: Final = 200  # bytes; file systems allow 255, some of which a lock needs


def files_in(folder: Path) -> list[Path]:
    """Return the files in `folder` that may be sessions."""
    try:
        # hidden files are locks and drafts
        return sorted(path for path in folder.glob(f"*{SUFFIX}") if not path.name.startswith("."))
    except OSError:  # an unreadable folder counts as empty
        return []


def sessions_in(folder: Path) -> tuple[list[StoredSession], list[SessionError]]:
    """Return sessions that are not blank, last saved first, and errors of other files."""
    sound, broken = all_sessions_in(folder)
    return [session for session in sound if not session.is_blank], broken


def all_sessions_in(folder: Path) -> tuple[list[StoredSession], list[SessionError]]:
    """Return the same as `sessions_in`, with blank sessions."""
    sound, broken = [], []
    for path in files_in(folder):
        try:
            sound.append(read_session(path))
        except SessionError as error:
            broken.append(error)
    # the file system decides the order within a second
    sound.sort(key=lambda session: (session.saved, session.written[1]), reverse=True)
    return sound, broken


def prune(folder: Path) -> None:
    """Remove unnamed sessions except the newest 50, blank ones, and old drafts.

    Open sessions and those of lessons stay. A failed removal must not prevent saving.
    """
    unnamed = [session for session in all_sessions_in(folder)[0] if not session.stays]
    worth_keeping = [session for session in unnamed if not session.is_blank][:MOST_UNNAMED]
    for session in unnamed:
        if session not in worth_keeping:
            lock = FileLock(session.path)
            with suppress(OSError):
                # it may have been resumed or named meanwhile
                if lock.acquire() and signature(session.path.stat()) == session.written:
                    remove_with_draft(session.path)
            lock.release()
    remove_old_drafts(folder, SUFFIX)


def remove(session: StoredSession) -> None:
    """Remove a session. Raises UserError if that is impossible, or open elsewhere."""
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
    """Return a path named after subject and time, free unless a thousand are used."""
    moment = datetime.now(UTC).strftime("%Y%m%d-%H%M%S")
    return folder / free_name(f"{file_stem(subject)}-{moment}", SUFFIX, folder)


def named_path(folder: Path, name: str) -> Path:
    """Return the path of the session `name`. Raises UserError if invalid."""
    from rl_tui.live.sessions.document import LONGEST_NAME

    if not name.strip():
        raise UserError("type a name")
    if len(name) > LONGEST_NAME or not is_plain(name):
        raise UserError(f"type one line of at most {LONGEST_NAME} characters")
    return folder / f"{file_stem(name)}{SUFFIX}"


def file_stem(name: str) -> str:
    """Keep only letters, digits and dashes, for any file system."""
    words = re.sub(r"[\W_]+", "-", name.lower()).strip("-")
    return words.encode()[:_LONGEST_STEM].decode(errors="ignore") or "session"
