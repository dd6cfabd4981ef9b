"""A slider for one parameter.

A key that cannot belong to a value ends the typing and keeps its usual effect.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Final

from textual import events
from textual.binding import BindingType
from textual.message import Message
from textual.strip import Strip
from textual.widget import Widget

from rl_tui.agents.hyperparameters import PARAMETERS, SAMPLE_AVERAGE, Hyperparameters, Parameter
from rl_tui.screen.kit.bindings import binding
from rl_tui.screen.kit.pointing import Draggable
from rl_tui.screen.panels.controls import slider_picture
from rl_tui.screen.theme.look import Look

_BEGINS_TYPING: Final = frozenset("056789.,")  # 1 to 4 focus the other sliders
_TYPED: Final = frozenset("0123456789.,/")
_NUMBER: Final = re.compile(r"\d*[.,]?\d*", re.ASCII)
_SIGN: Final = "-"
_AVERAGE: Final = "1/n"
_LONGEST_TYPED: Final = 14
_STAY: Final = frozenset({"enter", "tab", "shift+tab", "left", "right", "home", "end", "pageup", "pagedown"})


class Slider(Draggable, can_focus=True):
    """A slider for ``parameter``.

    Posts Changed, with ``reports_at_once`` at every cell of a drag. Messages go directly to the screen, to
    arrive before the key that ended the typing. Raises ValueError without a finite range.
    """

    BINDINGS: ClassVar[list[BindingType]] = [
        binding("left", "move('step', -1)", "slider.less", "A hundredth less"),
        binding("right", "move('step', 1)", "slider.more", "A hundredth more"),
        binding("shift+left,less_than_sign", "move('fine', -1)", "slider.little_less", "A thousandth less"),
        binding(
            "shift+right,greater_than_sign", "move('fine', 1)", "slider.little_more", "A thousandth more"
        ),
        binding("pagedown", "move('coarse', -1)", "slider.much_less", "A tenth less"),
        binding("pageup", "move('coarse', 1)", "slider.much_more", "A tenth more"),
        binding("home", "end(False)", "slider.least", "The least value"),
        binding("end", "end(True)", "slider.most", "The greatest value"),
        binding("left_curly_bracket", "jump(False)", "slider.previous_mark", "Go past the previous mark"),
        binding("right_curly_bracket", "jump(True)", "slider.next_mark", "Go past the next mark"),
        binding("enter", "type", "slider.type", "Type a value, then press enter"),
        binding("escape", "release", "slider.release", "Leave the slider"),
    ]

    @dataclass
    class Changed(Message):
        """The user set a parameter."""

        name: str
        value: float | str

    @dataclass
    class Refused(Message):
        """The typed text is not valid."""

        reason: str

    class Released(Message):
        """The user leaves the slider."""

    class TypingChanged(Message):
        """Typing has begun or ended."""

    def __init__(
        self,
        look: Look,
        parameter: Parameter,
        value: float | str,
        *,
        reports_at_once: bool = True,
        label_columns: int = 0,
    ) -> None:
        super().__init__(id=parameter.name)
        self._reports_at_once = reports_at_once
        self._before_drag = value
        self.look = look
        self.parameter = parameter
        self.scale = slider_picture.scale_of(parameter)
        typed = "a number or 1/N" if SAMPLE_AVERAGE in parameter.words else "a number"
        help_text = (
            f"{parameter.help}. The arrows change it. enter, or a click on its value, types {typed}. "
            "For a value that begins with 1 to 4, press enter first."
        )
        self._help = self.tooltip = look.glyphs.spelled(help_text)
        self._state = slider_picture.SliderState(value, label_columns=label_columns)
        self._number = _first_number(parameter, self.scale, value)

    @property
    def value(self) -> float | str:
        """The current value."""
        return self._state.value

    def set_value(self, value: float | str) -> None:
        """Show ``value`` without a message."""
        if isinstance(value, float | int):
            self._number = value = float(value)
        self._change(value=value)

    @property
    def marks(self) -> tuple[slider_picture.SliderMark, ...]:
        """The rising marks on the track."""
        return self._state.marks

    def set_marks(self, marks: tuple[slider_picture.SliderMark, ...], meaning: str = "") -> None:
        """Show rising ``marks`` with their ``meaning``."""
        if marks != self.marks:
            self._change(marks=marks)
            tip = f"{self._help} {meaning} {{ and }} go past the marks." if marks else self._help
            self.tooltip = self.look.glyphs.spelled(tip)

    def label(self, name: str, columns: int, *, is_pointed_at: bool) -> None:
        """Write ``name``, marked if a lesson points here."""
        self._change(name=name, label_columns=columns, is_pointed_at=is_pointed_at)

    @property
    def is_typing(self) -> bool:
        """True if the user is typing."""
        return self._state.typed is not None

    @property
    def state(self) -> slider_picture.SliderState:
        """The displayed state."""
        return replace(self._state, focused=self.has_focus)

    def _change(self, **changes: Any) -> None:
        before, self._state = self._state, replace(self._state, **changes)
        if self._state != before:
            self.refresh()

    def render_line(self, y: int) -> Strip:
        """Draw the slider, or a blank row."""
        width = self.size.width
        if y > 0 or width < 1:
            return Strip.blank(width, self.rich_style)
        strip = slider_picture.slider_strip(self.parameter, self.scale, self.state, self.look, width)
        return strip.apply_style(self.rich_style)

    # Keys

    def action_move(self, step: str, direction: int) -> None:
        """Move by ``step``. A word becomes the last number."""
        by = {"step": self.scale.step, "fine": self.scale.fine, "coarse": self.scale.coarse}[step]
        self._set(self._moved(direction * by))

    def action_end(self, high: bool) -> None:
        """Go to an end of the range."""
        self._set(self.scale.high if high else self.scale.low)

    def action_jump(self, upwards: bool) -> None:
        """Go beyond the next or previous mark."""
        value = self._number if isinstance(self.value, str) else self.value
        if upwards:
            beyond = next((mark.above for mark in self.marks if mark.value > value), value)
        else:
            beyond = next((mark.below for mark in reversed(self.marks) if mark.value < value), value)
        self._set(beyond)

    def action_type(self) -> None:
        """Begin typing a value."""
        self._type("")

    def action_release(self) -> None:
        """Give up the focus."""
        self.screen.post_message(self.Released())

    def on_key(self, event: events.Key) -> None:
        """Type, or end the typing."""
        if self._state.typed is not None:
            self._take_key(event, self._state.typed)
        elif event.character in _BEGINS_TYPING or (event.character and self._is_sign(event.character)):
            event.stop()
            self._type(event.character)

    def on_focus(self) -> None:
        """Show the focus."""
        self.refresh()

    def on_blur(self) -> None:
        """Set the typed value, unless the terminal lost the focus."""
        if self.app.app_focus and self.is_attached:
            self._set_typed()
            self._type(None)

    def _take_key(self, event: events.Key, typed: str) -> None:
        character = event.character if event.is_printable else None
        longer = typed + (character or "")
        if event.key == "escape":
            event.stop()
            self._type(None)
        elif event.key == "backspace":
            event.stop()
            self._type(typed[:-1])
        elif character is not None and self._may_become_a_value(longer):
            event.stop()
            self._type(longer)
        elif character is not None and (character in _TYPED or self._is_sign(character)):
            event.stop()  # a second point, or too many digits
        elif not self._set_typed():
            if event.key in _STAY:
                event.stop()
        elif event.key == "enter":
            event.stop()
            self.action_release()

    def _is_sign(self, character: str) -> bool:
        return character == _SIGN and self.parameter.range is not None and self.parameter.range.low < 0

    def _may_become_a_value(self, text: str) -> bool:
        if SAMPLE_AVERAGE in self.parameter.words and _AVERAGE.startswith(text.lower()):
            return True
        digits = text[1:] if text and self._is_sign(text[0]) else text
        return _NUMBER.fullmatch(digits) is not None and len(text) <= _LONGEST_TYPED

    def _type(self, text: str | None) -> None:
        was_typing = self.is_typing
        self._change(typed=text, refused=False)
        if self.is_typing != was_typing:
            self.screen.post_message(self.TypingChanged())

    def _set_typed(self) -> bool:
        text = self._state.typed
        if text is None:
            return True
        self._type(None)
        if not text:
            return True
        try:
            value = slider_picture.parsed(text, self.parameter)
        except ValueError as fault:
            self._change(refused=True)
            now = self.value if isinstance(self.value, str) else f"{self.value:g}"
            reason = f"{self.parameter.symbol} stays {now}: {fault}"
            self.screen.post_message(self.Refused(reason))
            self.app.bell()
            return False
        self._set(value)
        return True

    # Mouse

    def on_mouse_down(self, event: events.MouseDown) -> None:
        """Take and hold the thumb."""
        offset = event.get_content_offset(self)
        if event.button != 1 or offset is None:
            return
        if isinstance(self.value, str):
            self._set(self._number)
            return
        self._type(None)
        start, cells = self._track()
        if start <= offset.x < start + cells:
            self._before_drag = self.value
            self.take_hold(offset.x)
        elif offset.x >= start + cells:
            self._type("")

    def on_mouse_scroll_up(self, event: events.MouseScrollUp) -> None:
        """Raise the value."""
        event.stop()
        self._set(self._moved(self.scale.step))

    def on_mouse_scroll_down(self, event: events.MouseScrollDown) -> None:
        """Lower the value."""
        event.stop()
        self._set(self._moved(-self.scale.step))

    def _track(self) -> tuple[int, int]:
        plain = replace(self.state, value=self._number, typed=None, refused=False)
        form = slider_picture.slider_form(self.parameter, plain, self.look.glyphs, self.size.width)
        return form.start, form.cells

    def drag_to(self, column: int) -> None:
        """Set the value at ``column``."""
        start, cells = self._track()
        self._set(self.scale.at_cell(column - start, cells))

    def on_mouse_up(self) -> None:
        """Report the dragged value."""
        self._tell_drag()

    def on_mouse_release(self) -> None:
        """Report the dragged value if another widget takes the mouse."""
        self._tell_drag()

    def _tell_drag(self) -> None:
        if not self._reports_at_once and self.is_held and self.value != self._before_drag:
            self._before_drag = self.value
            self.screen.post_message(self.Changed(self.parameter.name, self.value))

    def _moved(self, by: float) -> float:
        return self._number if isinstance(self.value, str) else self.scale.moved(self.value, by)

    def _set(self, value: float | str) -> None:
        self._type(None)
        if value == self.value:
            return
        self.set_value(value)
        if self._reports_at_once or not self.is_held:
            self.screen.post_message(self.Changed(self.parameter.name, value))


def _first_number(parameter: Parameter, scale: slider_picture.SliderScale, value: float | str) -> float:
    default = Hyperparameters().value(parameter.name) if parameter.name in PARAMETERS else scale.low
    return next((float(each) for each in (value, default) if not isinstance(each, str)), scale.low)


def key_hints(focused: Widget | None) -> tuple[tuple[tuple[str, str], ...], ...]:
    """Return the focused slider's keys."""
    if not isinstance(focused, Slider):
        return ()
    if not focused.is_typing:
        symbol, short = focused.parameter.symbol, focused.parameter.short_name
        name = "", short if short.startswith(symbol) else symbol if short in symbol else f"{symbol} {short}"
        forms = ("type a number", "type")
        jump = (("{ }", "to flips"),) if focused.marks else ()
        return tuple((name, ("← →", "move"), *jump, ("enter", form), ("esc", "leave")) for form in forms)
    average = (("1/N", "sample average"),) if SAMPLE_AVERAGE in focused.parameter.words else ()
    return ((("enter", "set"), ("esc", "drop"), *average),)
