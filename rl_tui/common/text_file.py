"""Reading a text file that a person wrote."""

from __future__ import annotations

from pathlib import Path

from rl_tui.common.limits import LARGEST_FILE


class UnreadableError(Exception):
    """The file gives nothing at all; ``place`` is the line and column, if it is one."""

    def __init__(self, place: str, found: str, expected: str) -> None:
        super().__init__(found)
        self.place, self.found, self.expected = place, found, expected


def read_text(path: Path, kind: str = "a TOML file") -> str:
    """Return what stands in the file, which should be of this ``kind``. Raises UnreadableError."""
    content = _content(path, kind)
    try:
        # "sig" because editors on Windows begin a file with a byte order mark
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise UnreadableError(f"line {line}", f"byte {content[error.start]:#04x}", "text in UTF-8") from error


def _content(path: Path, kind: str) -> bytes:
    try:
        if path.is_dir():
            raise UnreadableError("", "a folder", kind)
        if not path.exists():
            raise UnreadableError("", "no such file", kind)
        if not path.is_file() or path.stat().st_size > LARGEST_FILE:
            raise UnreadableError("", "something else", f"{kind} of at most {LARGEST_FILE // 10**6} MB")
        return path.read_bytes()
    except (OSError, ValueError) as error:  # ValueError: a null character in the path
        reason = getattr(error, "strerror", None) or str(error)
        raise UnreadableError("", f"a file that cannot be read ({reason})", kind) from error
