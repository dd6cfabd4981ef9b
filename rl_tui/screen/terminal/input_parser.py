"""What the text that a terminal sends means: keys, pastes, the mouse, answers.

Textual's parser gets one whole sequence at a time. By itself it would take escape and a key right after it
for that key with alt, or leave the escape out; look for the rest of what it does not know in the keys that
follow; take an escape in a paste for its end; and keep all of a paste that has none.
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

MOST_PASTED: Final = 1_000_000  # characters that are kept of one paste
ESCAPE_DELAY: Final = 0.1  # seconds after which an escape that nothing follows is the key of that name
_ESCAPE: Final = "\x1b"
_PASTE_BEGINS, _PASTE_ENDS = "\x1b[200~", "\x1b[201~"
_LONGEST: Final = 32  # characters of a sequence; Textual takes longer ones for keys
# Sequences as the Linux console, the oldest mice, rxvt, mice that may be left of the window, and all others
# have them; escape, and the key after it; keys. What begins like a sequence, but goes on like none, is escape
# and a key
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
    """Turns text into messages; ``clock`` tells seconds.

    A bracketed paste is text, whatever is in it. Of one that is longer than ``most`` characters the rest is
    dropped until it ends.
    """

    def __init__(
        self, *, debug: bool = False, most: int = MOST_PASTED, clock: Callable[[], float] = monotonic
    ) -> None:
        self._sequences = _Sequences(debug)
        self._most = most
        self._clock = clock
        self._rest = ""  # a sequence that has no end yet, or in a paste what may be the beginning of its end
        self._since = 0.0
        self._pasted: list[str] | None = None  # None: nothing is being pasted
        self._room = 0

    def feed(self, text: str) -> list[Message]:
        """Return what ``text`` means, together with what was unfinished before."""
        text, self._rest = self._rest + text, ""
        self._since = self._clock()
        messages: list[Message] = []
        while text:
            text = self._type(text, messages) if self._pasted is None else self._paste(text, messages)
        return messages

    def tick(self) -> list[Message]:
        """Return what is unfinished if nothing has followed for a while; to be called now and then."""
        if not self._rest or self._pasted is not None or self._clock() - self._since < ESCAPE_DELAY:
            return []
        rest, self._rest = self._rest, ""
        is_typed = not rest[2:].strip("[")  # of a sequence that was cut off nothing is typed
        return list(self._keys(rest)) if is_typed else []

    def _type(self, text: str, messages: list[Message]) -> str:
        """Add the keys of ``text`` up to a paste; return what is left."""
        text, pastes, left = text.partition(_PASTE_BEGINS)
        if pastes:
            self._pasted, self._room = [], self._most
        elif unfinished := _UNFINISHED.search(text):
            self._rest = unfinished[0]
            text = text[: unfinished.start()]
        messages += self._keys(text)
        return left

    def _paste(self, text: str, messages: list[Message]) -> str:
        """Keep ``text`` up to the end of the paste, and add that if it is there; return what is left."""
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
    """Knows sequences and keys one by one."""

    def take(self, piece: str) -> list[Message]:
        """Return what ``piece`` means, nothing if that is not known."""
        messages: list[Message] = []
        if not piece:  # for Textual the end of it all
            return messages
        with suppress(Exception):  # it takes for granted that there are numbers where they should be
            messages += self.feed(piece)
            if self._awaiting.timeout is None:  # it does not wait for more
                return messages
        super(XTermParser, self).__init__()  # from the beginning, but for what is known of the mouse
        return messages


def _beginning_of_end(text: str) -> str:
    """Return the end of ``text`` that the end of a paste may begin with, empty if there is none."""
    at = text.rfind(_ESCAPE, -len(_PASTE_ENDS))
    return text[at:] if at >= 0 and _PASTE_ENDS.startswith(text[at:]) else ""
