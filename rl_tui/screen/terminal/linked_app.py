"""An app that sends only differences, as fast as they arrive."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from contextlib import suppress
from functools import partial
from typing import Any, Final, Protocol, TypeVar, runtime_checkable

from rich.color import ColorSystem
from rich.console import COLOR_SYSTEMS, RenderableType
from textual import events
from textual.app import App
from textual.driver import Driver
from textual.geometry import Region, Size
from textual.message import Message
from textual.screen import Screen
from textual.strip import Strip
from textual.timer import Timer

from rl_tui.common.limits import LARGEST_SCREEN
from rl_tui.screen.terminal.output import Output
from rl_tui.screen.terminal.screen_buffer import ScreenBuffer

_ARRANGING: Final = 0.1  # seconds after a change of size until the panels are arranged
ReturnType = TypeVar("ReturnType")


@runtime_checkable
class _Lines(Protocol):
    """A region as Textual draws it: the strips of each line."""

    strips: list[Iterable[Strip]]
    region: Region


@runtime_checkable
class _Pieces(Protocol):
    """A small update as Textual draws it: per line, strips by start column."""

    chops: Sequence[Mapping[int, Strip | None]]
    chop_ends: list[list[int]]
    spans: list[tuple[int, int, int]]


class LinkedApp(App[ReturnType]):
    """An app with an :class:`Output` between compositor and driver, if there is a terminal.

    It uses private names of Textual. A version that draws differently then draws on its own.
    """

    def __init__(self, driver_class: type[Driver] | None = None, *, ansi_color: bool = False) -> None:
        super().__init__(driver_class, ansi_color=ansi_color)
        self.stops: Collection[str] = ()
        """Keys that end something, which count in a flood of others."""
        self.synchronises = False
        """True if the terminal supports synchronised output."""
        self.ticks = 0.0
        """Frames per second of a moving picture, 0 for none."""
        self._output: Output | None = None
        self._claimed = Size(0, 0)  # size that the terminal reports
        self._draws = True
        self._arranging: Timer | None = None
        self._drawn: Screen[object] | None = None
        self._in_front = range(0)  # lines of the dialog that was drawn last
        self._painted = asyncio.Event()

    def set_timer(self, delay: float, callback: Callable[[], object] | None = None, **options: Any) -> Timer:
        """Call ``callback`` once after ``delay`` seconds, or later if the machine is busy.

        Textual skips late timers, which could lose a resize and block all later ones.
        """
        timer = super().set_timer(delay, callback, **options)
        timer._skip = False
        return timer

    def start_timer(self, seconds: float, callback: Callable[[], object], *, repeats: bool) -> Timer:
        """Call ``callback`` after, or every, ``seconds`` on screen."""
        return self.set_interval(seconds, callback) if repeats else self.set_timer(seconds, callback)

    @property
    def size(self) -> Size:
        """The drawn columns and lines."""
        return _bounded(super().size)

    @property
    def has_slow_link(self) -> bool:
        """True if changes take noticeable time to arrive."""
        return self._output is not None and self._output.link.is_slow

    @property
    def keeps_up(self) -> bool:
        """True if a moving picture arrives in time."""
        return self._output is None or self._output.keeps_up

    async def painted(self) -> None:
        """Wait for the first drawing; slow work starts then."""
        if self._draws and not self.is_headless and not self.is_inline:
            await self._painted.wait()

    async def arrived(self) -> None:
        """Wait until the terminal shows everything."""
        if self._output is not None:
            await self._output.arrived()

    async def rest(self) -> None:
        """Draw nothing until the terminal is taken again."""
        if self._output is not None:
            await self._output.rest()

    async def go_to_shell(self) -> bool:
        """Stop until the shell resumes the program. Return False without a shell."""
        driver = self._terminal
        suspend = getattr(driver, "suspend", None)
        return driver is not None and suspend is not None and driver.can_suspend and bool(await suspend())

    def give_back_terminal(self) -> None:
        """Restore the terminal before the process ends, from any thread."""
        give_back = getattr(self._terminal, "give_back", None)
        if give_back is not None:
            give_back()

    def action_redraw(self) -> None:
        """Draw everything again: another program may have written over it."""
        if self._output is not None:
            self._output.draw_again()

    def on_resize(self, event: events.Resize) -> None:
        """Draw everything again."""
        if self._output is not None:
            self._output.resize(*event.size)
            self._tell_of_rest(self._output)
            if self._arranging is not None:
                self._arranging.stop()
            self._arranging = self.set_timer(_ARRANGING, self._output.wake)

    def on_terminal_supports_synchronized_output(self) -> None:
        """Use synchronised output."""
        self.synchronises = True

    def _display(self, screen: Screen[object], renderable: RenderableType | None) -> None:
        driver = self._terminal
        if self._draws and driver is not None and not self.is_headless and not self.is_inline:
            if renderable is None or isinstance(renderable, _Lines | _Pieces):
                if renderable is not None and self.is_running and not getattr(self, "_batch_count", 0):
                    self._draw_on(self._output_of(driver), screen, renderable)
                self.post_display_hook()
                return
            self._draws = False  # an unknown way of drawing: Textual has to draw everything
            self._painted.set()
            if self._output is not None:
                self._output.stop()
                self._output = None
                self.refresh(layout=True)
        super()._display(screen, renderable)

    @property
    def _terminal(self) -> Driver | None:
        driver: Driver | None = getattr(self, "_driver", None)
        return driver

    def _output_of(self, driver: Driver) -> Output:
        if self._output is None:
            system = COLOR_SYSTEMS.get(self.console.color_system or "", ColorSystem.TRUECOLOR)
            self._output = Output(driver.write, system, partial(getattr, driver, "waiting", 0))
            self._output.resize(*self.size)
            self._tell_of_rest(self._output)
            self._output.wake()
        return self._output

    def _tell_of_rest(self, output: Output) -> None:
        (width, height), claimed = _bounded(self._claimed), self._claimed
        words = f"no more than {width} columns and {height} lines are drawn"
        if claimed.height > height:
            output.write_beside(0, height, words[: claimed.width])
        else:
            output.write_beside(width, 0, f" {words}"[: claimed.width - width])

    def _draw_on(self, output: Output, screen: Screen[object], update: _Lines | _Pieces) -> None:
        buffer, lines = output.buffer, _lines_of_dialog(screen)
        if screen is not self._drawn:  # a dialog has opened or closed: send it first
            buffer.begin_with(lines or self._in_front)
        self._drawn, self._in_front = screen, lines
        output.synchronises = self.synchronises
        output.cursor = self.screen.outer_size.clamp_offset(self.cursor_position)
        if isinstance(update, _Lines):
            _put_lines(update, buffer)
        else:
            for y, start, end in update.spans:
                # like Textual: pieces that start in the span, cut at its end
                for (x, strip), piece_end in zip(update.chops[y].items(), update.chop_ends[y], strict=True):
                    if strip is not None and x <= end and piece_end > start:
                        piece, is_inside = _untied(strip), start <= x and piece_end <= end
                        buffer.put(x, y, piece if is_inside else piece.crop(0, min(piece_end, end) - x))
        output.send()
        self._painted.set()

    def put_on(self, buffer: ScreenBuffer) -> None:
        """Draw the screen and those below it."""
        update = self.screen._compositor.render_update(full=True, screen_stack=self._background_screens)
        if isinstance(update, _Lines):
            _put_lines(update, buffer)

    def post_message(self, message: Message) -> bool:
        """Queue ``message``, unless it is the terminal's answer."""
        if isinstance(message, events.Resize):
            self._claimed = message.size
            if (size := _bounded(message.size)) != message.size:
                message = events.Resize(size, size)
        if self._output is not None:
            if isinstance(message, events.CursorPosition):
                # handled at once: other messages need not wait
                self._output.answer(message.x, message.y)
                return True
            if isinstance(message, events.Key | events.MouseDown):
                self._output.link.hurry()
        return super().post_message(message)

    async def _process_messages_loop(self) -> None:
        try:
            await super()._process_messages_loop()
        finally:
            if self._output is not None:
                await self._output.rest()


def _put_lines(update: _Lines, buffer: ScreenBuffer) -> None:
    for y, strips in enumerate(update.strips, update.region.y):
        buffer.put(update.region.x, y, (segment for strip in map(_untied, strips) for segment in strip))


def _untied(strip: Strip) -> Strip:
    # Textual's strips hold themselves in this cache. Without references in a circle they need no garbage
    # collection, which stops all threads for a tenth of a second
    getattr(strip, "_divide_cache", set()).clear()
    return strip


def _bounded(size: Size) -> Size:
    return Size(*map(min, size, LARGEST_SCREEN))


def _lines_of_dialog(screen: Screen[object]) -> range:
    if not screen.is_modal:
        return range(0)
    box = Region.from_union([child.region for child in screen.children] or [Region()])
    return range(box.y, box.bottom)


def is_open(screen: Screen[Any]) -> bool:
    """Return True while ``screen`` is in use: neither closed nor about to lose its widgets."""
    return screen.is_attached and screen.app.is_running and screen in screen.app.screen_stack


def forget_left_screens(_: object) -> None:
    """Free the cached lines of removed widgets.

    Textual's cache would keep a third of a megabyte per opened dialog (Textualize/textual #6665).
    """
    with suppress(ImportError, AttributeError):  # another version of Textual may have no such cache
        from textual._styles_cache import StylesCache

        StylesCache.get_inner_outer.cache_clear()
