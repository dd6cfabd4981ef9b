"""A slider in one row."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import groupby
from operator import attrgetter
from typing import Final

from rich.cells import cell_len
from rich.segment import Segment
from textual.strip import Strip

from rl_tui.agents.hyperparameters import SAMPLE_AVERAGE, Parameter, Range
from rl_tui.screen.draw import numbers
from rl_tui.screen.theme.glyphs import Glyphs
from rl_tui.screen.theme.look import Look

_SHORT_FORMS: Final = {"1/n": SAMPLE_AVERAGE}
_NOISE: Final = 12  # decimals: further ones are rounding errors


@dataclass(frozen=True, slots=True)
class SliderScale:
    """A finite range in hundredths. ``fine`` is a tenth of a step, ``coarse`` ten."""

    range: Range
    logarithmic: bool = False
    whole: bool = False

    def __post_init__(self) -> None:
        if not math.isfinite(self.span) or self.span <= 0.0:
            raise ValueError(f"a slider needs a finite range, not {self.range}")
        if self.logarithmic and self.range.low <= 0.0:
            raise ValueError(f"a slider with equal ratios cannot reach {self.range.low:g}")

    @property
    def span(self) -> float:
        """The range's width, or 1 if logarithmic."""
        return 1.0 if self.logarithmic else self.range.high - self.range.low

    @property
    def step(self) -> float:
        """The move of key or wheel."""
        return max(1.0, round(self.span / 100.0)) if self.whole else self.span / 100.0

    @property
    def fine(self) -> float:
        """The smallest move."""
        return 1.0 if self.whole else self.span / 1000.0

    @property
    def coarse(self) -> float:
        """The largest move except to an end."""
        return max(1.0, round(self.span / 10.0)) if self.whole else self.span / 10.0

    @property
    def low(self) -> float:
        """The lower end, a fine step above an excluded one."""
        return float(self.range.low + self.fine if self.range.open_low else self.range.low)

    @property
    def high(self) -> float:
        """The upper end."""
        return float(self.range.high)

    def moved(self, value: float, by: float) -> float:
        """Move within the ends, unless typed beyond them."""
        if self.logarithmic:  # rounded to the step of the keys
            target = _significant(value * self._ratio**by, 2 if abs(by) >= self.step else 3)
        else:
            target = round(value + by, _NOISE)
        if by < 0.0:
            return max(target, min(value, self.low))
        return min(target, max(value, self.high))

    def cell_of(self, value: float, cells: int) -> int:
        """Return the thumb's cell."""
        return min(cells - 1, max(0, round(self._share(value) * (cells - 1))))

    def at_cell(self, cell: int, cells: int) -> float:
        """Return the roundest value of a cell."""
        if cell <= 0 or cells <= 1:
            return self.low
        if cell >= cells - 1:
            return self.high
        if self.logarithmic:
            value = self.range.low * self._ratio ** (cell / (cells - 1))
            rounder = (_significant(value, digits) for digits in (1, 2, 3))
            return next((each for each in rounder if self.cell_of(each, cells) == cell), value)
        value = self.range.low + cell / (cells - 1) * self.span
        for grain in (self.step, self.fine):
            rounded = round(round(value / grain) * grain, _NOISE)
            if self.cell_of(rounded, cells) == cell and rounded >= self.low:
                return rounded
        return float(round(value)) if self.whole else value

    @property
    def _ratio(self) -> float:
        return self.range.high / self.range.low

    def _share(self, value: float) -> float:
        if self.logarithmic:
            return math.log(max(value, self.range.low) / self.range.low) / math.log(self._ratio)
        return (value - self.range.low) / self.span


def scale_of(parameter: Parameter) -> SliderScale:
    """Return the scale, or raise ValueError without one."""
    if parameter.range is None:
        raise ValueError(f"a slider needs a range; {parameter.name} has only words as values")
    slide, whole = parameter.slide, parameter.range
    if slide is None:
        return SliderScale(whole, whole=parameter.whole)
    is_open = whole.open_low and slide.low == whole.low
    return SliderScale(Range(slide.low, slide.high, open_low=is_open), slide.logarithmic, parameter.whole)


def _significant(value: float, digits: int) -> float:
    return float(f"{value:.{digits}g}")


def parsed(text: str, parameter: Parameter) -> float | str:
    """Parse a value, or raise ValueError."""
    text = text.strip().lower()
    words = [word for word in parameter.words if text and word.startswith(text)]
    words += [word for form, word in _SHORT_FORMS.items() if text == form and word in parameter.words]
    if words:
        return words[0]
    try:
        value = float(text.replace(",", "."))
    except ValueError:
        value = math.nan
    if not parameter.accepts(value):
        raise ValueError(f"type {parameter.expected_in_words}, not {text!r}")
    return value


ROOMY: Final = 30
LEAST_TRACK: Final = 3
_NUMBER: Final = 5
_LEAST_NUMBER: Final = 3
_SPELLED: Final = 7  # cells of ``epsilon``
_BESIDE_NAME: Final = 17  # cells: a short track and a number
_CARET: Final = " "
_WORDS: Final = {SAMPLE_AVERAGE: ("1/N  sample average", "1/N sample average", "1/N")}


@dataclass(frozen=True, slots=True)
class SliderMark:
    """A mark, with the values just beyond it."""

    value: float
    below: float
    above: float
    stands_out: bool = True


@dataclass(frozen=True, slots=True)
class SliderState:
    """A slider's state. ``typed``: None unless typing."""

    value: float | str
    typed: str | None = None
    refused: bool = False
    focused: bool = False
    label_columns: int = 0
    name: str = ""
    is_pointed_at: bool = False
    marks: tuple[SliderMark, ...] = ()


@dataclass(frozen=True, slots=True)
class SliderForm:
    """Blank, ``label``, gap, ``cells`` of track, gap, ``text``."""

    label: str
    gap: int
    cells: int
    text: str

    @property
    def start(self) -> int:
        """The first column of track or text."""
        return 1 + cell_len(self.label) + self.gap


def slider_form(parameter: Parameter, state: SliderState, glyphs: Glyphs, width: int) -> SliderForm:
    """Lay out the row."""
    gap = 2 if width >= ROOMY else 1
    label = glyphs.spelled(parameter.symbol)
    if state.name and width >= ROOMY and width >= state.label_columns + _BESIDE_NAME:
        label = f"{label} {glyphs.spelled(state.name)}".ljust(state.label_columns)
    elif not state.name:
        label = label.ljust(state.label_columns)
    if width >= ROOMY and label.rstrip() != parameter.symbol:
        label = label.ljust(_SPELLED)  # align sliders one above the other
    room = width - 1 - cell_len(label) - 2 * gap - (width < ROOMY)
    is_word = isinstance(state.value, str) and state.typed is None and not state.refused
    forms = [glyphs.spelled(form) for form in _texts(parameter, state, glyphs)]
    if is_word:
        return SliderForm(label, gap, 0, next((form for form in forms if cell_len(form) <= room + gap), ""))
    text = next((form for form in forms if cell_len(form) + LEAST_TRACK <= room), forms[-1])
    cells = room - cell_len(text)
    if cells >= LEAST_TRACK:
        return SliderForm(label, gap, cells, text)
    alone = room + gap + 1
    if alone < _LEAST_NUMBER:
        label = label[: max(1, len(label) - _LEAST_NUMBER - 1 + alone)]
        alone = width - 1 - cell_len(label) - gap
    is_number = not isinstance(state.value, str) and state.typed is None and not state.refused
    if cell_len(text) > alone >= _LEAST_NUMBER and is_number:
        text = numbers.value(float(state.value), alone, glyphs)
    return SliderForm(label, gap, 0, text if cell_len(text) <= alone else "")


def slider_strip(
    parameter: Parameter, scale: SliderScale, state: SliderState, look: Look, width: int
) -> Strip:
    """Draw a slider's row."""
    palette, glyphs = look.palette, look.glyphs
    form = slider_form(parameter, state, glyphs, width)
    symbol, name, padding = form.label.partition(" ")
    start = glyphs.cursor if state.is_pointed_at else " "
    label = palette.focus if state.focused else palette.press
    segments = [
        Segment(start + symbol, label),
        Segment(name + padding, palette.focus if state.focused else palette.dim),
        Segment(" " * (form.start - 1 - cell_len(form.label)), palette.text),
    ]
    if form.cells and not isinstance(state.value, str):
        segments += _track(scale, state, state.value, form.cells, look)
    elif form.cells:
        segments.append(Segment(glyphs.track_rest * form.cells, palette.slider_rest))
    if form.cells:
        segments.append(Segment(" " * form.gap, palette.text))
    segments += _text_segments(form.text, state, look)
    return Strip([segment for segment in segments if segment.text]).adjust_cell_length(width, palette.text)


def _track(scale: SliderScale, state: SliderState, value: float, cells: int, look: Look) -> list[Segment]:
    palette, glyphs = look.palette, look.glyphs
    thumb = scale.cell_of(value, cells)
    track = [Segment(glyphs.track_done, palette.press)] * thumb
    track += [Segment(glyphs.track_rest, palette.slider_rest)] * (cells - thumb)
    for mark in sorted(state.marks, key=lambda mark: mark.stands_out):
        drawn = (glyphs.flip, palette.best) if mark.stands_out else (glyphs.side_flip, palette.dim)
        track[scale.cell_of(mark.value, cells)] = Segment(*drawn)
    track[thumb] = Segment(glyphs.thumb, palette.press if state.focused else palette.strong)
    return [
        Segment("".join(each.text for each in run), style)
        for style, run in groupby(track, attrgetter("style"))
    ]


def _text_segments(text: str, state: SliderState, look: Look) -> list[Segment]:
    palette = look.palette
    if state.refused:
        return [Segment(text, palette.bad)]
    if state.typed is None:
        return [Segment(text, palette.strong)]
    return [Segment(text[: -len(_CARET)], palette.strong), Segment(_CARET, palette.focus)]


def _texts(parameter: Parameter, state: SliderState, glyphs: Glyphs) -> tuple[str, ...]:
    if state.refused:
        return (f"expected {parameter.expected_in_words}", f"not in {parameter.range}", str(parameter.range))
    if state.typed is not None:
        return (state.typed.rjust(_NUMBER - len(_CARET)) + _CARET,)
    if isinstance(state.value, str):
        return _WORDS.get(state.value, (state.value.replace("-", " "),))
    if parameter.whole:
        return (f"{state.value:,.0f}".rjust(_NUMBER),)
    exact = numbers.brief(state.value, glyphs, leading_zero=True)
    short = numbers.value(state.value, _NUMBER, glyphs).rjust(_NUMBER)
    return (exact, short) if len(exact) > _NUMBER else (short,)
