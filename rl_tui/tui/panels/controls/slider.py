"""A slider for one hyper-parameter, one row high: keys, wheel, click, drag, or a value typed in its place."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Final

from textual import events
from textual.binding import BindingType
from textual.message import Message
from textual.strip import Strip

from rl_tui.agents.hyperparameters import PARAMETERS, Hyperparameters, Parameter
from rl_tui.tui.panels.bindings import binding
from rl_tui.tui.panels.controls.slider_picture import SliderState, slider_form, slider_strip
from rl_tui.tui.panels.controls.slider_scale import SliderScale, parsed, scale_of
from rl_tui.tui.panels.draggable import Draggable
from rl_tui.tui.theme.look import Look

_BEGINS_TYPING: Final = frozenset("0123456789.")
_LONGEST_TYPED: Final = 14
_LEAVE_TYPING: Final = frozenset({"tab", "shift+tab"})


class Slider(Draggable, can_focus=True):
    """Shows and sets the value of ``parameter``, which needs a finite range (ValueError otherwise).

    ``value`` is a number, or one of the parameter's words (sample-average). Changed is posted for what the
    user does, not for :meth:`set_value`; a text that is no value is refused on the slider itself.
    """

    ALLOW_SELECT = False
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
        binding("enter", "type", "slider.type", "Type a value"),
    ]

    @dataclass
    class Changed(Message):
        """The user set the parameter ``name`` to ``value``."""

        name: str
        value: float | str

    def __init__(self, look: Look, parameter: Parameter, value: float | str) -> None:
        super().__init__(id=parameter.name)
        self.look = look
        self.parameter = parameter
        self.scale = scale_of(parameter)
        self.tooltip = parameter.help
        self._value = value
        self._number = _first_number(parameter, self.scale, value)
        self._typed: str | None = None
        self._refused = False

    @property
    def value(self) -> float | str:
        """The value in force."""
        return self._value

    def set_value(self, value: float | str) -> None:
        """Show ``value``, without a message."""
        if isinstance(value, float | int):
            self._number = value = float(value)
        if value != self._value:
            self._value = value
            self.refresh()

    @property
    def state(self) -> SliderState:
        """What the slider shows now."""
        return SliderState(self._value, self._typed, self._refused, self.has_focus)

    def render_line(self, y: int) -> Strip:
        """Draw the row, and blank ones below it."""
        width = self.size.width
        if y > 0 or width < 1:
            return Strip.blank(width, self.rich_style)
        strip = slider_strip(self.parameter, self.scale, self.state, self.look, width)
        return strip.apply_style(self.rich_style)

    # Keys

    def action_move(self, step: str, direction: int) -> None:
        """Move the value by a ``step`` of the scale; from a word back to the last number."""
        by = {"step": self.scale.step, "fine": self.scale.fine, "coarse": self.scale.coarse}[step]
        self._set(self._moved(direction * by))

    def action_end(self, high: bool) -> None:
        """Go to an end of the range."""
        self._set(self.scale.high if high else self.scale.low)

    def action_type(self) -> None:
        """Begin typing a value."""
        self._type("")

    def on_key(self, event: events.Key) -> None:
        """Take what is being typed; digits and the point begin it."""
        if self._typed is None:
            if event.character is not None and event.character in _BEGINS_TYPING:
                event.stop()
                self._type(event.character)
            elif event.key == "escape" and self._refused:
                event.stop()
                self._type(None)
        elif event.key not in _LEAVE_TYPING and not event.key.startswith("ctrl+"):
            event.stop()
            self._take_key(event, self._typed)

    def on_focus(self) -> None:
        """Show the focus."""
        self.refresh()

    def on_blur(self) -> None:
        """Give up what was being typed."""
        self._type(None)

    def _take_key(self, event: events.Key, typed: str) -> None:
        if event.key == "enter":
            self._commit(typed)
        elif event.key == "escape":
            self._type(None)
        elif event.key == "backspace":
            self._type(typed[:-1])
        elif event.is_printable and event.character is not None and len(typed) < _LONGEST_TYPED:
            self._type(typed + event.character)

    def _type(self, text: str | None) -> None:
        self._typed, self._refused = text, False
        self.refresh()

    def _commit(self, text: str) -> None:
        self._type(None)
        if not text:
            return
        try:
            value = parsed(text, self.parameter)
        except ValueError:
            self._refused = True
            self.app.bell()
        else:
            self._set(value)

    # Mouse

    def on_mouse_down(self, event: events.MouseDown) -> None:
        """Take hold of the thumb, which jumps to the pointer."""
        offset = event.get_content_offset(self)
        if event.button != 1 or offset is None:
            return
        if isinstance(self._value, str):
            self._set(self._number)
            return
        self._type(None)
        start, cells = self._track()
        if start <= offset.x < start + cells:
            self.take_hold(offset.x)

    def on_mouse_scroll_up(self, event: events.MouseScrollUp) -> None:
        """Raise the value by one step."""
        event.stop()
        self._set(self._moved(self.scale.step))

    def on_mouse_scroll_down(self, event: events.MouseScrollDown) -> None:
        """Lower the value by one step."""
        event.stop()
        self._set(self._moved(-self.scale.step))

    def _track(self) -> tuple[int, int]:
        plain = SliderState(self._number)
        form = slider_form(self.parameter, plain, self.look.glyphs, self.size.width)
        return form.start, form.cells

    def drag_to(self, column: int) -> None:
        """Set the value that belongs to ``column``."""
        start, cells = self._track()
        self._set(self.scale.at_cell(column - start, cells))

    def _moved(self, by: float) -> float:
        return self._number if isinstance(self._value, str) else self.scale.moved(self._value, by)

    def _set(self, value: float | str) -> None:
        self._type(None)
        if value == self._value:
            return
        self.set_value(value)
        self.post_message(self.Changed(self.parameter.name, value))


def _first_number(parameter: Parameter, scale: SliderScale, value: float | str) -> float:
    """Return the number that a slider goes to from a word: the value, or the default of the parameter."""
    default = Hyperparameters().value(parameter.name) if parameter.name in PARAMETERS else scale.low
    return next((float(each) for each in (value, default) if not isinstance(each, str)), scale.low)
