"""What the terminal sends: keys, the mouse, answers."""

from __future__ import annotations

import os
import re
from codecs import getincrementaldecoder
from collections.abc import Iterator
from selectors import EVENT_READ, SelectSelector
from threading import Event
from typing import Final

from textual._xterm_parser import XTermParser
from textual.message import Message

_TICK: Final = 0.1  # seconds: an escape that nothing follows is the key of that name
_AT_ONCE: Final = 4096
_SEQUENCES: Final = re.compile(r"\x1b[^\x1b]*|[^\x1b]+")


def messages_from(fileno: int, ended: Event, *, debug: bool = False) -> Iterator[Message]:
    """Yield what comes from the terminal until ``ended`` is set.

    Bytes that mean nothing, as a bad line or a paste may bring, are passed over. Raises EOFError or OSError
    where the terminal is gone.
    """
    parser = XTermParser(debug)
    decode = getincrementaldecoder("utf-8")("replace").decode
    with SelectSelector() as selector:
        selector.register(fileno, EVENT_READ)
        while not ended.is_set():
            text = decode(_read(fileno)) if selector.select(_TICK) else ""
            messages: list[Message] = []
            for piece in _SEQUENCES.findall(text):
                try:
                    messages.extend(parser.feed(piece))
                except Exception:  # the parser takes for granted that there are numbers where they should be
                    parser = XTermParser(debug)
            messages.extend(parser.tick())
            yield from messages
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
