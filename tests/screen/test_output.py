"""Output to a terminal."""

from __future__ import annotations

import asyncio
import re

from emulator import Emulator
from rich.color import ColorSystem
from rich.segment import Segment
from rich.style import Style

from rl_tui.screen.terminal.output import Output

ASKED = re.compile(r"\x1b\[2;?(\d*)H\x1b\[6n")


class FarTerminal:
    def __init__(self) -> None:
        self.written: list[str] = []
        self.waiting = 0
        self.now = 0.0
        self.emulator = Emulator(20, 4)
        self.output = Output(self.write, ColorSystem.EIGHT_BIT, lambda: self.waiting, lambda: self.now)
        self.output.resize(20, 4)
        self.output.wake()

    def write(self, text: str) -> None:
        self.written.append(text)
        self.emulator.feed(text.encode())

    def show(self, text: str, y: int = 0) -> None:
        self.output.buffer.put(0, y, [Segment(text.ljust(20), Style())])
        self.output.send()

    def answer(self, number: int = -1) -> None:
        found = ASKED.search(self.written[number])
        self.output.answer(int(found[1] or 1) - 1, 1)


async def test_what_gathers_meanwhile_goes_out_as_one_frame() -> None:
    terminal = FarTerminal()
    for step in range(5):
        terminal.show(f"step {step}")
        terminal.show("paused" if step % 2 else "runs", 1)
    assert len(terminal.written) == 1
    terminal.answer()
    assert len(terminal.written) == 2
    assert terminal.emulator.text.split("\n")[:2] == ["step 4", "runs"]
    terminal.answer()
    assert len(terminal.written) == 2, "nothing more to tell"


async def test_it_keeps_up_while_each_frame_leaves_before_the_next_is_drawn() -> None:
    terminal = FarTerminal()
    terminal.show("step 0")
    assert terminal.output.keeps_up
    terminal.show("step 1")
    assert not terminal.output.keeps_up
    terminal.answer()
    assert terminal.output.keeps_up


async def test_each_frame_asks_for_another_place() -> None:
    terminal = FarTerminal()
    places = set()
    for step in range(5):
        terminal.show(f"step {step}")
        found = ASKED.search(terminal.written[-1])
        places.add(found[1])
        terminal.answer()
    assert len(places) == 5


async def test_a_terminal_of_one_line_is_not_asked() -> None:
    terminal = FarTerminal()
    terminal.output.resize(20, 1)
    terminal.output.wake()
    for text in ("one", "two"):
        terminal.show(text)
    assert len(terminal.written) == 2
    assert "\x1b[6n" not in "".join(terminal.written)


async def test_after_a_resize_all_is_told_again() -> None:
    terminal = FarTerminal()
    terminal.show("return")
    terminal.output.resize(20, 4)
    terminal.output.wake()
    terminal.output.send()
    assert "return" in terminal.written[-1]
    terminal.output.resize(10, 4)
    terminal.output.wake()
    terminal.output.send()
    assert len(terminal.written) == 2, "nothing is drawn for this size yet"
    terminal.answer()
    terminal.show("return")
    assert "return" in terminal.written[-1]


async def test_frames_are_held_together_where_the_terminal_can() -> None:
    terminal = FarTerminal()
    terminal.output.synchronises = True
    terminal.show("return")
    assert terminal.written[-1].startswith("\x1b[?2026h")
    assert terminal.written[-1].index("\x1b[?2026l") < terminal.written[-1].index("\x1b[6n")


async def test_the_cursor_ends_where_text_is_entered() -> None:
    terminal = FarTerminal()
    terminal.output.cursor = (7, 3)
    terminal.show("goto")
    assert (terminal.emulator.cursor.x, terminal.emulator.cursor.y) == (7, 3)


async def test_who_draws_next_waits_until_all_has_arrived() -> None:
    terminal = FarTerminal()
    await terminal.output.arrived()
    terminal.show("one")
    waiting = asyncio.create_task(terminal.output.arrived())
    await asyncio.sleep(0)
    terminal.show("two")
    terminal.answer()
    for _ in range(3):
        await asyncio.sleep(0)
    assert not waiting.done(), "what was drawn meanwhile is on its way now"
    terminal.answer()
    await waiting


async def test_without_an_answer_it_goes_on_when_the_wait_is_over() -> None:
    terminal = FarTerminal()
    terminal.show("one")
    terminal.now += 60.0
    terminal.show("two")
    assert len(terminal.written) == 2


async def test_a_silent_terminal_gets_no_more_than_leaves_the_program() -> None:
    terminal = FarTerminal()
    for number in range(4):
        terminal.show(str(number))
        terminal.now += 60.0
    terminal.show("silent")
    assert len(terminal.written) == 5
    terminal.waiting = 1
    terminal.show("waits")
    assert len(terminal.written) == 5
    waiting = asyncio.create_task(terminal.output.arrived())
    await asyncio.sleep(0)
    terminal.waiting = 0
    await waiting
    assert terminal.emulator.text.split("\n")[0] == "waits"


async def test_at_the_end_the_last_answer_is_awaited_and_nothing_more_is_sent() -> None:
    terminal = FarTerminal()
    terminal.show("one")
    closing = asyncio.create_task(terminal.output.rest())
    await asyncio.sleep(0)
    terminal.show("two")
    assert not closing.done()
    terminal.answer()
    await closing
    assert len(terminal.written) == 1


async def test_at_the_end_a_terminal_without_answers_is_not_waited_for() -> None:
    terminal = FarTerminal()
    for number in range(5):
        terminal.show(str(number))
        terminal.now += 60.0
    await asyncio.wait_for(terminal.output.rest(), 60.0)


async def test_what_stands_there_can_be_drawn_again() -> None:
    terminal = FarTerminal()
    terminal.show("return")
    terminal.answer()
    terminal.emulator.feed(b"\x1b[Hmail has come")
    terminal.output.draw_again()
    assert terminal.emulator.text.split("\n")[0] == "return"


async def test_lines_that_were_asked_for_are_in_the_first_frame_on_a_slow_link() -> None:
    terminal = FarTerminal()
    terminal.output.resize(400, 12)
    terminal.output.wake()
    terminal.emulator.resize(12, 400)
    for text in ("at once", "─" * 400, "│" * 400, "─" * 400):
        terminal.show(text)
        terminal.now += 0.0 if text == "at once" else 2.0
        terminal.answer()
    assert terminal.output.link.is_slow
    for y in range(12):
        terminal.output.buffer.put(0, y, [Segment(chr(ord("a") + y) * 400, Style())])
    terminal.output.buffer.begin_with(range(8, 10))
    before = len(terminal.written)
    terminal.output.send()
    shown = [row[:1] for row in terminal.emulator.text.split("\n")]
    assert len(terminal.written) == before + 1
    assert shown[8:10] == ["i", "j"]
    assert shown[11] != "l", "the rest is for the next frame"


async def test_a_terminal_that_is_lent_gets_nothing_until_it_is_back() -> None:
    terminal = FarTerminal()
    terminal.show("return")
    resting = asyncio.create_task(terminal.output.rest())
    await asyncio.sleep(0)
    terminal.answer()
    await asyncio.wait_for(resting, 60.0)
    terminal.show("another")
    assert len(terminal.written) == 1
    terminal.output.resize(20, 4)
    assert len(terminal.written) == 1
    terminal.output.wake()
    assert terminal.emulator.text.split("\n")[0] == "another"
