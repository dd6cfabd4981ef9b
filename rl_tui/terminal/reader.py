"""Reading what the terminal sends."""

from __future__ import annotations

import os
from codecs import getincrementaldecoder
from collections.abc import Iterator
from selectors import EVENT_READ, SelectSelector
from threading import Event
from typing import Final

from textual.message import Message

from rl_tui.terminal.input_parser import InputParser

_TICK: Final = 0.1  # seconds after which it is seen that nothing followed an escape
_AT_ONCE: Final = 4096


def messages_from(fileno: int, ended: Event, *, debug: bool = False) -> Iterator[Message]:
    """Yield what comes from the terminal until ``ended`` is set.

    Bytes that mean nothing, as a bad line or a paste may bring, are passed over. Raises EOFError or OSError
    where the terminal is gone.
    """
    parser = InputParser(debug=debug)
    decode = getincrementaldecoder("utf-8")("replace").decode
    with SelectSelector() as selector:
        selector.register(fileno, EVENT_READ)
        while not ended.is_set():
            if selector.select(_TICK):
                yield from parser.feed(decode(_read(fileno)))
            yield from parser.tick()
        if selector.select(_TICK):  # an answer, or a movement of the mouse, that was on its way
            _read(fileno)


def _read(fileno: int) -> bytes:
    try:
        data = os.read(fileno, _AT_ONCE)
    except BlockingIOError:  # another program that shares the terminal has set it so, and was quicker
        return b""
    if not data:
        raise EOFError
    return data
