"""Parses terminal input into keys, pastes, mouse events and answers.

Textual's parser gets one whole sequence at a time. On its own it confuses escape and a quick key with alt,
searches later keys for the rest of a sequence, and ends a paste at an escape.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from contextlib import suppress
from time import monotonic
from typing import Final

from textual._ansi_sequences import ANSI_SEQUENCES_KEYS
from textual._xterm_parser import XTermParser
from textual.events import Key, Paste
from textual.message import Message

from rl_tui.screen.terminal.key_queue import EscapeOrAlt

MOST_PASTED: Final = 1_000_000  # characters of one paste that are kept
ESCAPE_DELAY: Final = 0.1  # seconds until a lone escape counts as a key
_ESCAPE: Final = "\x1b"
_PASTE_BEGINS, _PASTE_ENDS = "\x1b[200~", "\x1b[201~"
_LONGEST: Final = 32  # characters of a sequence; Textual takes longer ones for keys
# Sequences of the Linux console, the oldest mice, rxvt, mice left of the window, and all others; escape and
# the next key; keys. An incomplete sequence of another form is escape and a key
_PIECE: Final = re.compile(
    r"\x1b(?:\[(?:\[.|M...|\d+\$|\?[\d;]{0,80}\$y|<[-0-?]{0,80}[Mm]"
    r"|[0-?]{1,80}M|[0-?]{0,80}[@-LN-Z^-~]|[0-?]{1,80}[ -/]{1,4}[@-~])|O[ -~])"
    r"|\x1b[^\x1b]?|[^\x1b]+",
    re.DOTALL,
)
_UNFINISHED: Final = re.compile(
    r"\x1b(?:\[(?:\[|M.{0,2}|[0-?]{0,80}|\?[\d;]{0,80}\$|<[-0-?]{0,80}|[0-?]{1,80}[ -#%-/]{1,4})|O)?\Z",
    re.DOTALL,
)


class InputParser:
    """Parses text, and cuts pastes after ``most`` characters."""

    def __init__(
        self, *, debug: bool = False, most: int = MOST_PASTED, clock: Callable[[], float] = monotonic
    ) -> None:
        self._sequences = _Sequences(debug)
        self._most = most
        self._clock = clock
        self._rest = ""  # an unfinished sequence, or in a paste the possible start of its end
        self._since = 0.0
        self._pasted: list[str] | None = None  # None outside a paste
        self._room = 0

    def feed(self, text: str) -> list[Message]:
        """Return the messages of unfinished and new text."""
        text, self._rest = self._rest + text, ""
        self._since = self._clock()
        messages: list[Message] = []
        while text:
            text = self._type(text, messages) if self._pasted is None else self._paste(text, messages)
        return messages

    def tick(self) -> list[Message]:
        """Return unfinished text as keys if nothing has followed."""
        if not self._rest or self._pasted is not None or self._clock() - self._since < ESCAPE_DELAY:
            return []
        rest, self._rest = self._rest, ""
        is_typed = not rest[2:].strip("[")  # a sequence that was cut off is not typed text
        return list(self._keys(rest)) if is_typed else []

    def _type(self, text: str, messages: list[Message]) -> str:
        text, pastes, left = text.partition(_PASTE_BEGINS)
        if pastes:
            self._pasted, self._room = [], self._most
        elif unfinished := _UNFINISHED.search(text):
            self._rest = unfinished[0]
            text = text[: unfinished.start()]
        messages += self._keys(text)
        return left

    def _paste(self, text: str, messages: list[Message]) -> str:
        assert self._pasted is not None
        text, ends, left = text.partition(_PASTE_ENDS)
        if not ends:
            self._rest = _beginning_of_end(text)
            text = text.removesuffix(self._rest)
        if kept := text[: self._room]:
            self._pasted.append(kept)
            self._room -= len(kept)
        if ends:
            messages.append(Paste("".join(self._pasted).replace("\0", "")))
            self._pasted = None
        return left

    def _keys(self, text: str) -> Iterator[Message]:
        for piece in _PIECE.findall(text):
            if piece.startswith(_ESCAPE) and len(piece) <= 2:
                yield from self._after_escape(piece[1:])
            elif len(piece) <= _LONGEST or not piece.startswith(_ESCAPE):
                yield from self._sequences.take(piece)

    def _after_escape(self, character: str) -> Iterator[Message]:
        typed = self._sequences.take(character)
        together = ANSI_SEQUENCES_KEYS.get(_ESCAPE + character)
        if len(typed) == 1 and isinstance(typed[0], Key) and isinstance(together, tuple):
            yield EscapeOrAlt(together[0].value, typed[0])
        else:
            yield Key("escape", _ESCAPE)
            yield from typed


class _Sequences(XTermParser):
    def take(self, piece: str) -> list[Message]:
        messages: list[Message] = []
        if not piece:  # an empty text means the end to Textual
            return messages
        with suppress(Exception):  # it assumes numbers at certain places
            messages += self.feed(piece)
            if self._awaiting.timeout is None:  # it waits for no more
                return messages
        super(XTermParser, self).__init__()  # restart, but keep the state of the mouse
        return messages


def _beginning_of_end(text: str) -> str:
    """Return the end of ``text`` that may start the end of a paste."""
    at = text.rfind(_ESCAPE, -len(_PASTE_ENDS))
    return text[at:] if at >= 0 and _PASTE_ENDS.startswith(text[at:]) else ""
