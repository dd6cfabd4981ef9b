"""The values of a slider: its ends, its steps, the cells of its track, and what may be typed."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

from rl_tui.agents.hyperparameters import SAMPLE_AVERAGE, Parameter, Range

_SHORT_FORMS: Final = {"1/n": SAMPLE_AVERAGE}
_NOISE: Final = 12  # decimals; what lies beyond is left over from adding steps


@dataclass(frozen=True, slots=True)
class SliderScale:
    """A finite range, walked in steps of a hundredth; ``fine`` is a tenth of a step, ``coarse`` ten.

    A ``logarithmic`` one is walked in equal ratios: its steps are shares of the way from end to end. One of
    ``whole`` numbers has none that is smaller than 1.
    """

    range: Range
    logarithmic: bool = False
    whole: bool = False

    def __post_init__(self) -> None:
        if not math.isfinite(self.span) or self.span <= 0.0:
            raise ValueError(f"a slider needs a finite range, not {self.range}")
        if self.logarithmic and self.range.low <= 0.0:
            raise ValueError(f"equal ratios do not reach {self.range.low:g}")

    @property
    def span(self) -> float:
        """The width of the range; of equal ratios the whole way, 1."""
        return 1.0 if self.logarithmic else self.range.high - self.range.low

    @property
    def step(self) -> float:
        """What a key, or the wheel, moves."""
        return max(1.0, round(self.span / 100.0)) if self.whole else self.span / 100.0

    @property
    def fine(self) -> float:
        """The smallest movement."""
        return 1.0 if self.whole else self.span / 1000.0

    @property
    def coarse(self) -> float:
        """The largest movement but that to an end."""
        return max(1.0, round(self.span / 10.0)) if self.whole else self.span / 10.0

    @property
    def low(self) -> float:
        """The lower end for keys and mouse: inside the range, a fine step above an end that is left out."""
        return float(self.range.low + self.fine if self.range.open_low else self.range.low)

    @property
    def high(self) -> float:
        """The upper end."""
        return float(self.range.high)

    def moved(self, value: float, by: float) -> float:
        """Return ``value`` moved within the ends; one typed beyond an end is not brought back to it."""
        target = self._by_ratio(value, by) if self.logarithmic else round(value + by, _NOISE)
        if by < 0.0:
            return max(target, min(value, self.low))
        return min(target, max(value, self.high))

    def cell_of(self, value: float, cells: int) -> int:
        """Return the cell of the thumb on a track of ``cells``."""
        return min(cells - 1, max(0, round(self._share(value) * (cells - 1))))

    def at_cell(self, cell: int, cells: int) -> float:
        """Return the roundest value of a cell, clamped to the track; its ends are those of the scale."""
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
        """Return how far from end to end ``value`` is."""
        if self.logarithmic:
            return math.log(max(value, self.range.low) / self.range.low) / math.log(self._ratio)
        return (value - self.range.low) / self.span

    def _by_ratio(self, value: float, by: float) -> float:
        """Return ``value`` moved by a share of the way, rounded as fine as it was moved."""
        return _significant(value * self._ratio**by, 2 if abs(by) >= self.step else 3)


def scale_of(parameter: Parameter) -> SliderScale:
    """Return the scale of the slider of ``parameter``; raises ValueError where it cannot have one."""
    if parameter.range is None:
        raise ValueError(f"a slider needs a range; {parameter.name} takes words only")
    slide, whole = parameter.slide, parameter.range
    if slide is None:
        return SliderScale(whole, whole=parameter.whole)
    is_open = whole.open_low and slide.low == whole.low
    return SliderScale(Range(slide.low, slide.high, open_low=is_open), slide.logarithmic, parameter.whole)


def _significant(value: float, digits: int) -> float:
    return float(f"{value:.{digits}g}")


def parsed(text: str, parameter: Parameter) -> float | str:
    """Return what ``text`` means: a number, or a word of ``parameter``, the start of one, or ``1/N``.

    Raises ValueError where it is neither, or out of range.
    """
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
        raise ValueError(f"{text or 'nothing'} is not {parameter.expected_in_words}")
    return value
