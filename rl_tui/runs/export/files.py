"""New files: nothing that is there already is ever written over."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Final

from rl_tui.common.errors import UserError
from rl_tui.worlds.sections.schema import is_plain

_MOST_TRIED: Final = 1_000


def new_path(text: str) -> Path:
    """Return the path that ``text`` names; ``~`` is the user's home.

    Raises UserError, in a line, where no new file can be made there: it is there already, or its folder is
    not.
    """
    text = text.strip()
    if not text:
        raise UserError("type the name of a new file")
    if not is_plain(text):
        raise UserError("a file name has no control characters")
    path = Path(text)
    try:
        path = path.expanduser()
        if path.is_dir():
            raise UserError(f"{text} is a folder: type the name of a new file")
        if path.exists() or path.is_symlink():
            raise UserError(f"{text} is there already: type another name")
        if not path.parent.is_dir():
            raise UserError(f"there is no folder {path.parent}")
    except (OSError, RuntimeError, ValueError) as error:
        raise UserError(f"{text}: {getattr(error, 'strerror', None) or error}") from error
    return path


def free_name(stem: str, ending: str) -> str:
    """Return a name that is free in the working folder: the plain one, or one with a number."""
    stem = "".join(letter if letter.isalnum() or letter in "-_." else "-" for letter in stem)
    for number in range(1, _MOST_TRIED):
        name = f"{stem}{'' if number == 1 else f'-{number}'}{ending}"
        if not Path(name).exists():
            return name
    return f"{stem}{ending}"


@contextmanager
def new_file(path: Path, *, binary: bool = False) -> Iterator[Any]:
    """Yield the new file ``path``, opened to write; it goes again where writing is broken off.

    Raises UserError, in a line, where it is there already or cannot be written.
    """
    try:
        stream = path.open("xb") if binary else path.open("x", encoding="utf-8", newline="")
    except FileExistsError as error:
        raise UserError(f"{path} is there already: choose another name") from error
    except OSError as error:
        raise _unwritable(path, error) from error
    try:
        with stream:
            yield stream
    except OSError as error:
        path.unlink(missing_ok=True)
        raise _unwritable(path, error) from error
    except BaseException:
        path.unlink(missing_ok=True)
        raise


def write_text(path: Path, text: str) -> None:
    """Write a new file. Raises UserError where that cannot be."""
    with new_file(path) as stream:
        stream.write(text)


def _unwritable(path: Path, error: OSError) -> UserError:
    return UserError(f"{path} cannot be written ({error.strerror or error})")
