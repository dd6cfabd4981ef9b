"""Protection of file descriptors 1 and 2 from foreign output.

An environment in C, or a process that it starts, writes directly to these, whatever ``sys.stdout`` is.
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
"""The ``filename`` of an OSError that means: stdout cannot be written."""


class _Named(FileIO):
    """A descriptor whose errors carry its name."""

    def __init__(self, descriptor: int, name: str) -> None:
        super().__init__(descriptor, "w")
        self.name = name

    def write(self, data: object, /) -> int | None:  # type: ignore[override]
        try:
            return super().write(data)  # type: ignore[arg-type]
        except OSError as error:
            error.filename = self.name
            raise


def keep_stdout() -> None:
    """Reserve stdout for this program until the process ends.

    Everything else written to descriptor 1 goes to stderr. Nothing changes on Windows, where a console is not
    a file.
    """
    if sys.platform == "win32":
        return
    _open_stderr()
    ours = _copy(_STDOUT, sys.stdout)
    if ours is None:
        return
    for name in ("stdout", "__stdout__"):
        setattr(sys, name, ours)
    _lead(_STDOUT, _STDERR)


class _RawOfOurs(_Named):
    def write(self, data: Any, /) -> int | None:  # type: ignore[override]
        return super().write(data) if _is_ours() else memoryview(data).nbytes


class _OursOnly(TextIOWrapper):
    """A text stream that drops foreign output. Environments find it as ``sys.stdout``."""

    def write(self, text: str, /) -> int:
        return super().write(text) if _is_ours() else len(text)


class _BufferOfOurs(BufferedWriter):
    def write(self, data: Any, /) -> int:
        return super().write(data) if _is_ours() else memoryview(data).nbytes


def _is_ours() -> bool:
    # Environments run in other threads
    thread = threading.current_thread()
    return thread is threading.main_thread() or type(thread).__module__.startswith("textual.")


@contextmanager
def screen_alone() -> Iterator[None]:
    """Keep foreign output off the terminal, from now until the process ends.

    It is dropped even after the context, because an environment may print until then. Output to a stderr that
    is not a terminal is kept. Nothing changes on Windows, which reaches the terminal in other ways too.
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
    """Drop all further output to the terminal, if a screen was shown."""
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
    # None if `stream` does not write to `descriptor`
    if not isinstance(stream, TextIOWrapper):
        return None
    with suppress(OSError, ValueError):
        if stream.fileno() == descriptor:
            stream.flush()
            raw = (_RawOfOurs if kind is _OursOnly else _Named)(os.dup(descriptor), stream.name)
            return kind(
                raw if stream.write_through else buffer(raw),  # unbuffered with python -u
                encoding=stream.encoding,
                errors=stream.errors,
                line_buffering=stream.line_buffering,
                write_through=stream.write_through,
            )
    return None


def _open_stderr() -> None:
    # Otherwise the next opened file would become descriptor 2
    try:
        os.fstat(_STDERR)
    except OSError:
        lead_nowhere(_STDERR)
        if sys.stderr is None:
            sys.stderr = open(_STDERR, "w", encoding="utf-8", closefd=False)  # noqa: SIM115


def lead_nowhere(descriptor: int) -> None:
    """Discard everything written to `descriptor`, open or closed."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    if nowhere != descriptor:  # the system returns the lowest free number
        _lead(descriptor, nowhere)
        os.close(nowhere)


def _lead(descriptor: int, to: int) -> None:
    with suppress(OSError):  # closed: nothing written there is visible anyway
        os.dup2(to, descriptor)
