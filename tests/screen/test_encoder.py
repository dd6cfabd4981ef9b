"""A terminal shows exactly what is drawn."""

from __future__ import annotations

import gc
from itertools import pairwise
from typing import Any

import pytest
from emulator import Emulator
from hypothesis import given, settings
from hypothesis import strategies as st
from rich.color import ColorSystem
from rich.segment import Segment
from rich.style import Style
from textual.strip import Strip
from wcwidth import wcwidth

from rl_tui.screen.terminal.encoder import Encoder
from rl_tui.screen.terminal.pens import Pen, Pens
from rl_tui.screen.terminal.screen_buffer import Cutter, ScreenBuffer

COLOURS = (None, "default", "red", "bright_blue", "color(7)", "color(99)", "#102030", "#fedcba")
SHOWS_ON_BLANKS = ("underscore", "strikethrough", "reverse", "blink")
SYSTEMS = (ColorSystem.STANDARD, ColorSystem.EIGHT_BIT, ColorSystem.TRUECOLOR)

attributes = st.sets(st.sampled_from(["bold", "dim", "italic", "underline", "reverse", "strike", "blink"]))
styles = st.builds(
    lambda on, foreground, background: Style(color=foreground, bgcolor=background, **dict.fromkeys(on, True)),
    attributes,
    st.sampled_from(COLOURS),
    st.sampled_from(COLOURS),
)
texts = st.one_of(
    st.text("ab01.─│⣿↑", max_size=6), st.integers(0, 8).map(" ".__mul__), st.text("ab 漢é한", max_size=4)
)
pieces = st.lists(st.tuples(texts, styles), min_size=1, max_size=4)
puts = st.tuples(st.just("put"), st.integers(0, 13), st.integers(0, 4), pieces)
resizes = st.tuples(st.just("resize"), st.integers(1, 14), st.integers(1, 5))
commands = st.lists(
    st.one_of(puts, puts, puts, st.just(("send",)), resizes, st.just(("forget",))), max_size=25
)


class Screen:
    def __init__(self, system: ColorSystem, width: int = 14, height: int = 5) -> None:
        pens, cutter = Pens(system), Cutter()
        self.system = system
        self.buffer = ScreenBuffer(pens, cutter)
        self.encoder = Encoder(pens, cutter)
        self.terminal = Emulator(width, height)
        self.terminal.feed(b"\x1b[?7l")
        self.written = ""
        self.resize(width, height)

    def resize(self, width: int, height: int) -> None:
        self.terminal.resize(height, width)
        self.terminal.feed(b"\x1b[H\x1b[1;4;31;42m" + b"#" * width + b"\x1b[m")
        self.buffer.resize(width, height)
        self.expected: list[list[tuple[str, Style] | None]] = [[None] * width for _ in range(height)]

    def forget(self) -> None:
        self.terminal.feed(b"\x1b[2J")
        self.buffer.forget()

    def put(self, x: int, y: int, pieces: list[tuple[str, Style]]) -> None:
        self.buffer.put(x, y, [Segment(text, style) for text, style in pieces])
        if y >= len(self.expected):
            return
        row = self.expected[y]
        for character, style in [(character, style) for text, style in pieces for character in text]:
            for half in range(wcwidth(character)):
                if x < len(row):
                    row[x] = ("" if half else character, style)
                x += 1
        for at, cell in enumerate(row):  # halves of wide characters without their other half
            if cell and (cell[0] == "" and not self.is_wide(row, at - 1)):
                row[at] = (" ", cell[1])
            if cell and self.is_wide(row, at) and (row[at + 1 : at + 2] or [None])[0] != ("", cell[1]):
                row[at] = (" ", cell[1])

    @staticmethod
    def is_wide(row: list[tuple[str, Style] | None], at: int) -> bool:
        cell = row[at] if at >= 0 else None
        return cell is not None and cell[0] != "" and wcwidth(cell[0]) == 2

    def send(self, size: float = float("inf")) -> str:
        text = self.encoder.frame(self.buffer.changed(), size)
        self.terminal.feed(text.encode())
        self.written += text
        return text

    def check(self) -> None:
        for y, row in enumerate(self.expected):
            for x, cell in enumerate(row):
                if cell is not None and cell[0]:
                    shown = self.terminal.cell(x, y)
                    assert seen(shown) == seen(self.plainly(*cell)), (x, y, shown, cell)
        plain = self.terminal.cursor.attrs
        assert not any((plain.bold, plain.underscore, plain.reverse))
        assert (plain.fg, plain.bg) == ("default", "default")

    def plainly(self, character: str, style: Style) -> Any:
        terminal = Emulator(4, 1)
        terminal.feed(Strip.render_style(style, character, self.system).encode())
        return terminal.cell(0, 0)


def seen(cell: Any) -> tuple[Any, ...]:
    if cell.data == " " and not any(getattr(cell, name) for name in SHOWS_ON_BLANKS):
        return (" ", cell.bg)
    return tuple(cell)


@given(st.sampled_from(SYSTEMS), commands)
@settings(max_examples=150, deadline=None)
def test_the_terminal_shows_what_was_drawn(system: ColorSystem, sequence: list[Any]) -> None:
    screen = Screen(system)
    for name, *rest in sequence:
        getattr(screen, name)(*rest)
    screen.send()
    screen.check()
    assert screen.send() == "", "nothing is told twice"


@given(commands)
@settings(max_examples=50, deadline=None)
def test_many_short_frames_come_to_the_same(sequence: list[Any]) -> None:
    screen = Screen(ColorSystem.EIGHT_BIT)
    for name, *rest in sequence:
        getattr(screen, name)(*([1] if name == "send" else rest))
    while screen.send(1):
        pass
    screen.check()


def drawn(*pieces: tuple[str, str], system: ColorSystem = ColorSystem.EIGHT_BIT, width: int = 40) -> Screen:
    screen = Screen(system, width)
    screen.put(0, 1, [(text, Style.parse(style)) for text, style in pieces])
    return screen


def test_only_the_digit_that_changed_is_written() -> None:
    screen = drawn(("α 0.100 ", "white on color(99)"), ("on", "bold"))
    screen.send()
    screen.put(0, 1, [("α 0.110 ", Style.parse("white on color(99)")), ("on", Style.parse("bold"))])
    assert screen.send() == "\x1b[2;6H\x1b[37;48;5;99m1\x1b[m"


def test_what_was_drawn_again_alike_costs_nothing() -> None:
    screen = drawn(("steps", "red"))
    screen.send()
    screen.put(0, 1, [("steps", Style.parse("red"))])
    assert screen.send() == ""


def test_blanks_take_the_pen_of_what_stands_beside_them() -> None:
    screen = drawn(("a", "red on blue"), ("  ", "green on blue"), ("b", "red on blue"))
    assert screen.send() == "\x1b[2H\x1b[31;44ma  b\x1b[m"


def test_a_pen_is_set_once_for_all_lines() -> None:
    screen = drawn(("ab", "red"), ("c", "blue"), system=ColorSystem.STANDARD)
    screen.put(0, 3, [("d", Style.parse("blue")), ("e", Style.parse("red"))])
    assert screen.send() == "\x1b[2H\x1b[31mab\x1b[4;2He\x1b[2;3H\x1b[34mc\x1b[4Hd\x1b[m"


def test_a_few_cells_between_two_changes_are_written_again() -> None:
    screen = drawn(("0.532 0.514", ""))
    screen.send()
    screen.put(0, 1, [("0.541 0.523", Style())])
    assert screen.send() == "\x1b[2;4H41 0.523"


def test_the_rest_of_a_line_is_erased_where_the_background_is_the_terminals_own() -> None:
    screen = drawn(("return" + " " * 34, "red"))
    assert screen.send() == "\x1b[2H\x1b[31mreturn\x1b[m\x1b[K"
    painted = drawn(("return" + " " * 34, "red on blue"))
    assert "\x1b[K" not in painted.send()


def test_control_characters_never_reach_the_terminal() -> None:
    screen = drawn(("a\x1b[31mb\r\n\x07\x9bc\x00", ""))
    assert screen.send() == "\x1b[2Ha[31mbc"


@pytest.mark.parametrize("system", SYSTEMS)
def test_changes_of_attributes_are_short_and_right(system: ColorSystem) -> None:
    looks = ("bold red", "red", "dim red on blue", "bold dim on blue", "bold", "underline2", "underline", "")
    for before, after in pairwise((*looks, *reversed(looks))):
        screen = drawn(("a", before), ("b", after), system=system)
        screen.send()
        screen.check()
    pens = Pens(system)
    change = pens.change(pens.of(Style(bold=True, dim=True)), pens.of(Style(dim=True)))
    assert change in ("\x1b[0;2m", "\x1b[22;2m"), "what ends bold ends dim too"


def test_a_pen_is_made_once() -> None:
    pens = Pens(ColorSystem.EIGHT_BIT)
    assert pens.of(Style(color="red")) is pens.of(Style(color="red", meta={"@click": "x"}))
    assert pens.of(Style(color="default", bgcolor="default")) is pens.of(None) is pens.plain
    assert pens.of(Style(color="red", bgcolor="blue", bold=True)).blank is pens.of(Style(bgcolor="blue"))
    assert pens.of(Style(underline=True)).blank is pens.of(Style(underline=True))


def pens_alive() -> int:
    gc.collect()
    return sum(type(thing) is Pen for thing in gc.get_objects())


@pytest.mark.exhaustive("draws hundreds of thousands of cells")
def test_pens_that_no_cell_has_are_forgotten(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("rl_tui.screen.terminal.pens.MOST_KEPT", 100)
    pens = Pens(ColorSystem.TRUECOLOR)
    kept = pens.of(Style(color="#102030"))
    before = pens_alive()
    for number in range(1_000):
        pens.of(Style(color=f"#{number:06x}"))
    assert pens_alive() < before + 200
    assert pens.of(Style(color="#102030")) is kept
