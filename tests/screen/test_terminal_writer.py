"""Output on its way to the terminal."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import suppress
from threading import Event

import pytest

from rl_tui.screen.terminal.writer import TerminalWriter

FULL = b"x" * 1_000_000  # more than any pipe holds


@pytest.fixture
def pipe() -> Iterator[tuple[int, int]]:
    read, write = os.pipe()
    yield read, write
    for end in (read, write):
        with suppress(OSError):  # a test may have closed it
            os.close(end)


def nothing() -> None:
    """Do nothing."""


def test_everything_arrives_in_order(pipe: tuple[int, int]) -> None:
    read, write = pipe
    writer = TerminalWriter(write, nothing)
    writer.write(b"a")
    writer.write(b"b" * 5000)
    writer.write(b"c")
    assert writer.drain(60)
    assert not writer.waiting
    assert os.read(read, 10_000) == b"a" + b"b" * 5000 + b"c"
    writer.close(60)


def test_who_writes_never_waits_and_a_farewell_waits_no_longer_than_it_may(pipe: tuple[int, int]) -> None:
    read, write = pipe
    is_lost = Event()
    writer = TerminalWriter(write, is_lost.set)
    writer.write(FULL)
    writer.write(FULL)
    assert writer.waiting > len(FULL)
    assert not writer.drain(0.0)
    os.close(read)  # its thread must not find another pipe with the number of this one
    assert is_lost.wait(60)


def test_what_has_not_begun_to_leave_can_be_taken_back(pipe: tuple[int, int]) -> None:
    read, write = pipe
    writer = TerminalWriter(write, nothing)
    writer.write(FULL)
    assert os.read(read, 1) == b"x"  # it has begun to
    writer.write(b"no")
    writer.forget()
    writer.write(b"yes")
    arrived = b"x"
    while not arrived.endswith(b"s"):
        arrived += os.read(read, 1_000_000)
    assert arrived == FULL + b"yes"
    writer.close(60)


def test_it_says_when_nobody_is_there_any_more() -> None:
    read, write = os.pipe()
    os.close(read)
    is_lost = Event()
    writer = TerminalWriter(write, is_lost.set)
    writer.write(b"a")
    assert is_lost.wait(60)
    writer.write(b"b")
    assert not writer.waiting
    writer.close(60)
    os.close(write)
