"""File descriptors 1 and 2, which are everybody's: what an environment in C, or what it starts, writes there.

What Python prints passes by ``sys.stdout``, and can be led elsewhere there; this goes past it.
"""

from __future__ import annotations

import os
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from io import BufferedWriter, FileIO, TextIOWrapper
from typing import Any, Final, TextIO

_STDOUT, _STDERR = 1, 2
_NAMES: Final = {_STDOUT: "stdout", _STDERR: "stderr"}
STDOUT: Final = "<stdout>"
"""The ``filename`` of an OSError that says that stdout could not be written."""


class _Named(FileIO):
    """A descriptor that has a name, which its errors tell."""

    def __init__(self, descriptor: int, name: str) -> None:
        super().__init__(descriptor, "w")
        self.name = name

    def write(self, data: object, /) -> int | None:  # type: ignore[override]
        """Write as many bytes of ``data`` as the system takes."""
        try:
            return super().write(data)  # type: ignore[arg-type]
        except OSError as error:
            error.filename = self.name
            raise


def keep_stdout() -> None:
    """Keep stdout for what this program says itself, until the process ends.

    ``sys.stdout`` goes on to where it went. All else that is written to descriptor 1 goes to stderr. Nothing
    changes on Windows, where a console is no file.
    """
    if sys.platform == "win32":
        return
    _open_stderr()
    ours = _copy(_STDOUT, sys.stdout)
    if ours is None:
        return
    sys.stdout = sys.__stdout__ = ours  # type: ignore[misc]
    _lead(_STDOUT, _STDERR)


class _RawOfOurs(_Named):
    """A descriptor for what this program says: where nothing is buffered, it stands right behind a stream."""

    def write(self, data: Any, /) -> int | None:  # type: ignore[override]
        """Write ``data`` if it is ours."""
        return super().write(data) if _is_ours() else memoryview(data).nbytes


class _OursOnly(TextIOWrapper):
    """A stream for what this program says, which environments find too: what they print is dropped."""

    def write(self, text: str, /) -> int:
        """Write ``text`` if it is ours."""
        return super().write(text) if _is_ours() else len(text)


class _BufferOfOurs(BufferedWriter):
    """What stands behind such a stream."""

    def write(self, data: Any, /) -> int:
        """Write ``data`` if it is ours."""
        return super().write(data) if _is_ours() else memoryview(data).nbytes


def _is_ours() -> bool:
    """Return True in the main thread, and in one that writes for Textual: environments run in others."""
    thread = threading.current_thread()
    return thread is threading.main_thread() or type(thread).__module__.startswith("textual.")


@contextmanager
def screen_alone() -> Iterator[None]:
    """Let nothing reach the terminal, from now to the end, but what this program says itself.

    All else is dropped, as what is printed while a screen is shown: an environment may go on printing after
    that, to the end of the process. Where stderr is no terminal, what goes there goes on. Nothing changes on
    Windows, where the terminal is reached in other ways too.
    """
    if sys.platform != "win32":
        for descriptor, name in _NAMES.items():
            stream = getattr(sys, name)
            if isinstance(stream, TextIOWrapper) and _is_terminal(stream):
                ours = _copy(stream.fileno(), stream, _OursOnly, _BufferOfOurs)
                setattr(sys, name, ours)
                setattr(sys, f"__{name}__", ours)
            if os.isatty(descriptor):
                lead_nowhere(descriptor)
    yield


def say_no_more() -> None:
    """Let nothing at all reach the terminal where a screen was shown: what is left is not for people."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, _OursOnly):
            with suppress(OSError, ValueError):
                stream.flush()
                lead_nowhere(stream.fileno())


def _is_terminal(stream: TextIO) -> bool:
    try:
        return os.isatty(stream.fileno())
    except (OSError, ValueError):
        return False


def _copy(
    descriptor: int,
    stream: TextIO | None,
    kind: type[TextIOWrapper] = TextIOWrapper,
    buffer: type[BufferedWriter] = BufferedWriter,
) -> TextIOWrapper | None:
    """Return ``stream`` once more, over a copy of ``descriptor``; None where it does not write to that."""
    if not isinstance(stream, TextIOWrapper):
        return None
    with suppress(OSError, ValueError):
        if stream.fileno() == descriptor:
            stream.flush()
            raw = (_RawOfOurs if kind is _OursOnly else _Named)(os.dup(descriptor), stream.name)
            return kind(
                raw if stream.write_through else buffer(raw),  # as the interpreter has it with -u
                encoding=stream.encoding,
                errors=stream.errors,
                line_buffering=stream.line_buffering,
                write_through=stream.write_through,
            )
    return None


def _open_stderr() -> None:
    """Let stderr lead nowhere if it is closed, or the next file that is opened would become descriptor 2."""
    try:
        os.fstat(_STDERR)
    except OSError:
        lead_nowhere(_STDERR)
        if sys.stderr is None:
            sys.stderr = open(_STDERR, "w", encoding="utf-8", closefd=False)  # noqa: SIM115


def lead_nowhere(descriptor: int) -> None:
    """Let ``descriptor``, open or closed, take all that is written to it, and drop it."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    if nowhere != descriptor:  # the system gives the first number that is free
        _lead(descriptor, nowhere)
        os.close(nowhere)


def _lead(descriptor: int, to: int) -> None:
    with suppress(OSError):  # closed: then nothing that is written there can be seen either
        os.dup2(to, descriptor)
