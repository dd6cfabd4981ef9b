"""Keys, pastes and similar input, divided into any pieces."""

from __future__ import annotations

import pytest
from textual.events import Key, MouseMove, Paste
from textual.message import Message
from textual.messages import TerminalSupportsSynchronizedOutput

from rl_tui.screen.terminal.input_parser import ESCAPE_DELAY, InputParser
from rl_tui.screen.terminal.key_queue import EscapeOrAlt


class Typed:
    def __init__(self, most: int = 100) -> None:
        self.now = 0.0
        self.parser = InputParser(most=most, clock=lambda: self.now)
        self.messages: list[Message] = []

    def type(self, *texts: str) -> list[str]:
        before = len(self.messages)
        for text in texts:
            self.messages += [*self.parser.feed(text), *self.parser.tick()]
        self.now += ESCAPE_DELAY
        self.messages += self.parser.tick()
        return [name for message in self.messages[before:] if (name := name_of(message))]


def name_of(message: Message) -> str:
    match message:
        case EscapeOrAlt():
            return f"escape+{message.typed.key} or {message.key}"
        case Key():
            return message.key
        case Paste():
            return f"paste {message.text}"
    return ""


@pytest.mark.parametrize(
    ("text", "keys"),
    [
        ("\x1b", ["escape"]),
        ("\x1bq", ["escape", "q"]),
        ("\x1bss\x1bQ", ["escape", "s", "s", "escape", "Q"]),
        ("\x1b?", ["escape", "question_mark"]),
        ("\x1b]]", ["escape", "right_square_bracket", "right_square_bracket"]),
        ("\x1b[", ["escape", "left_square_bracket"]),
        ("\x1b\r", ["escape", "enter"]),
        ("\x1b1", ["escape", "1"]),
        ("\x1b\x10", ["escape", "ctrl+p"]),
        ("\x1bé" + "s" * 50, ["escape", "é", *"s" * 50]),
        ("\x1b\x1b", ["escape", "escape"]),
        ("\x1b\x1b[A", ["escape", "up"]),
        ("\x1bq\x1b[A", ["escape", "q", "up"]),
        ("\x1bb", ["escape+b or ctrl+left"]),
        ("\x1b\x7f", ["escape+backspace or ctrl+w"]),
        ("\x1b\t", ["escape+tab or shift+tab"]),
        ("\x1b[A\x1bOB\x1b[1;5C\x1b[[A\x1b[7$s", ["up", "down", "ctrl+right", "f1", "shift+home", "s"]),
        ("\x1b[113;3u\x1b[27u\x1b[97;2;65u", ["alt+q", "escape", "A"]),
        ("\x1b[I\x1b[O\x1b[?2026;2$y\x1b[M !!s", ["s"]),
    ],
)
def test_keys_are_the_same_in_one_piece_and_in_many(text: str, keys: list[str]) -> None:
    assert Typed().type(text) == keys
    assert Typed().type(*text) == keys


@pytest.mark.parametrize(
    "nonsense",
    [
        "\x1b[:~",
        "\x1b[1:R",
        "\x1b[:;:u",
        "\x1b[99999999999u",
        "\x1b[<1;~",
        "\x1b[<0;-1;5M",
        "\x1b[1 q",
        "\x1b[20;1$y",
        "\x1b[99z",
        "\x1bOz",
        f"\x1b[{'1;' * 30}A",
    ],
)
def test_what_is_not_known_is_no_key(nonsense: str) -> None:
    assert Typed().type(f"s{nonsense}q") == ["s", "q"]


def test_a_sequence_that_was_cut_off_is_no_key() -> None:
    typed = Typed()
    assert typed.type("\x1b[1;") == []
    assert typed.type("s") == ["s"]


def test_an_escape_waits_for_what_comes_soon() -> None:
    typed = Typed()
    typed.parser.feed("\x1b")
    typed.now += ESCAPE_DELAY / 2
    assert typed.parser.tick() == []
    assert typed.type("[A") == ["up"]


def test_the_mouse_stays_where_it_was_after_nonsense() -> None:
    typed = Typed()
    typed.type("\x1b[<35;11;6M", "\x1b[99z", "\x1b[<35;13;6M")
    last = typed.messages[-1]
    assert isinstance(last, MouseMove)
    assert (last.x, last.delta_x) == (12, 2)


def test_the_terminal_can_tell_what_it_is_able_to() -> None:
    (message,) = InputParser().feed("\x1b[?2026;2$y")
    assert isinstance(message, TerminalSupportsSynchronizedOutput)


@pytest.mark.parametrize(
    ("text", "pasted"),
    [("a\nb", "a\nb"), ("", ""), ("\x1bq\x1b[A", "\x1bq\x1b[A"), ("\x1b[200~", "\x1b[200~")],
)
def test_a_paste_is_text_whatever_is_in_it(text: str, pasted: str) -> None:
    whole = f"s\x1b[200~{text}\x1b[201~q"
    assert Typed().type(whole) == ["s", f"paste {pasted}", "q"]
    assert Typed().type(*whole) == ["s", f"paste {pasted}", "q"]


def test_of_a_paste_without_end_so_much_is_kept_and_then_keys_work_again() -> None:
    typed = Typed(most=10)
    assert typed.type("\x1b[200~0123") == []
    for _ in range(1000):
        assert typed.type("4567\x1b[20q") == []
    kept = typed.parser._pasted
    assert kept is not None
    assert len("".join(kept)) == 10
    assert len(kept) <= 3
    assert typed.type("\x1b[2", "01~s") == ["paste 01234567\x1b[", "s"]
