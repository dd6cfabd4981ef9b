"""File descriptors 1 and 2, which are everybody's: what an environment in C, or what it starts, writes there.

What Python prints passes by ``sys.stdout``, and can be led elsewhere there; this goes past it.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from io import BufferedWriter, FileIO, TextIOWrapper
from typing import Final, TextIO

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


@contextmanager
def screen_alone() -> Iterator[None]:
    """Let nothing but ``sys.stdout`` and ``sys.stderr`` reach the terminal.

    What goes past them is dropped, as what is printed while a screen is shown; where stderr is no terminal,
    it goes there. Nothing changes on Windows, where the terminal is reached in other ways too.
    """
    if sys.platform == "win32":
        yield
        return
    with ExitStack() as stack:
        for descriptor in filter(os.isatty, (_STDERR, _STDOUT)):
            stack.enter_context(_silent(descriptor))
        yield


@contextmanager
def _silent(descriptor: int) -> Iterator[None]:
    """Let ``descriptor`` lead nowhere; the stream of ``sys`` that wrote to it goes on to where it led."""
    name = _NAMES[descriptor]
    before = getattr(sys, name), getattr(sys, f"__{name}__")
    kept = os.dup(descriptor)
    ours = _copy(descriptor, before[0])
    if ours is not None:
        setattr(sys, name, ours)
        setattr(sys, f"__{name}__", ours)
    lead_nowhere(descriptor)
    try:
        yield
    finally:
        setattr(sys, name, before[0])
        setattr(sys, f"__{name}__", before[1])
        _lead(descriptor, kept)
        os.close(kept)


def _copy(descriptor: int, stream: TextIO | None) -> TextIOWrapper | None:
    """Return ``stream`` once more, over a copy of ``descriptor``; None where it does not write to that."""
    if not isinstance(stream, TextIOWrapper):
        return None
    with suppress(OSError, ValueError):
        if stream.fileno() == descriptor:
            stream.flush()
            raw = _Named(os.dup(descriptor), f"<{_NAMES[descriptor]}>")
            return TextIOWrapper(
                raw if stream.write_through else BufferedWriter(raw),  # as the interpreter has it with -u
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
