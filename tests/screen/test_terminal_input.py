"""Input of a terminal."""

from __future__ import annotations

import os
from contextlib import suppress
from threading import Event

import pytest
from textual.events import Key, Paste

from rl_tui.screen.terminal.driver import messages_from


def keys_of(sent: bytes) -> list[str]:
    read, write = os.pipe()
    os.write(write, sent)
    os.close(write)
    keys = []
    with suppress(EOFError):
        for message in messages_from(read, Event()):
            keys += [message.key] if isinstance(message, Key) else []
            keys += [f"paste {message.text}"] if isinstance(message, Paste) else []
    os.close(read)
    return keys


def test_keys_and_pastes_are_read() -> None:
    assert keys_of("sé\x1b[A\x1b[200~a\nb\x1b[201~q".encode()) == ["s", "é", "up", "paste a\nb", "q"]


@pytest.mark.parametrize(
    "nonsense", [b"\xff", b"\x1b[:~", b"\x1b[1:R", b"\x1b[:;:u", b"\x1b[99999999999u", b"\x1b[<1;~"]
)
def test_what_means_nothing_is_passed_over(nonsense: bytes) -> None:
    assert keys_of(b"s" + nonsense + b"\x1b[115u")[-1] == "s"


def test_it_stops_reading_when_told() -> None:
    read, write = os.pipe()
    ended = Event()
    ended.set()
    assert list(messages_from(read, ended)) == []
    os.close(read)
    os.close(write)
