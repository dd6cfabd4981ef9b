"""How a slider is drawn, in one row of any width."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import groupby
from typing import Final

from rich.cells import cell_len
from rich.segment import Segment
from rich.style import Style
from textual.strip import Strip

from rl_tui.agents.hyperparameters import SAMPLE_AVERAGE, Parameter
from rl_tui.screen.draw import numbers
from rl_tui.screen.draw.to_ascii import to_ascii
from rl_tui.screen.panels.controls.slider_scale import SliderScale
from rl_tui.screen.theme.glyphs import Glyphs
from rl_tui.screen.theme.look import Look

ROOMY: Final = 30
LEAST_TRACK: Final = 3
_NUMBER: Final = 5
_SPELLED: Final = 7  # cells of ``epsilon``
_BESIDE_NAME: Final = 17  # cells: a short track and a number
_CARET: Final = " "
_WORDS: Final = {SAMPLE_AVERAGE: ("1/N  sample average", "1/N sample average", "1/N")}


@dataclass(frozen=True, slots=True)
class SliderMark:
    """A mark on the track at ``value``; the values ``below`` and ``above`` are beyond it on either side.

    One that ``stands_out`` hides another in the same cell.
    """

    value: float
    below: float
    above: float
    stands_out: bool = True


@dataclass(frozen=True, slots=True)
class SliderState:
    """What a slider shows. ``typed`` is the text being typed, else None; ``refused``: it was not accepted.

    Behind its symbol stands its ``name``, where there is room. The label takes at least so many
    ``label_columns``, those of others above and below it. ``is_pointed_at`` says that a lesson points here.
    """

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
    """A row: a blank, ``label``, a gap, ``cells`` of track (0 without room), a gap, ``text``."""

    label: str
    gap: int
    cells: int
    text: str

    @property
    def start(self) -> int:
        """The first column of the track, or of the text where there is none."""
        return 1 + cell_len(self.label) + self.gap


def slider_form(parameter: Parameter, state: SliderState, glyphs: Glyphs, width: int) -> SliderForm:
    """Return what stands where in ``width`` cells."""
    gap = 2 if width >= ROOMY else 1
    label = to_ascii(parameter.symbol, glyphs)
    if state.name and width >= ROOMY and width >= state.label_columns + _BESIDE_NAME:
        label = f"{label} {to_ascii(state.name, glyphs)}".ljust(state.label_columns)
    elif not state.name:
        label = label.ljust(state.label_columns)
    if width >= ROOMY and label.rstrip() != parameter.symbol:
        label = label.ljust(_SPELLED)  # sliders one above the other begin in one column
    room = width - 1 - cell_len(label) - 2 * gap - (width < ROOMY)
    is_word = isinstance(state.value, str) and state.typed is None and not state.refused
    forms = [to_ascii(form, glyphs) for form in _texts(parameter, state, glyphs)]
    if is_word:
        return SliderForm(label, gap, 0, next((form for form in forms if cell_len(form) <= room + gap), ""))
    text = next((form for form in forms if cell_len(form) + LEAST_TRACK <= room), forms[-1])
    cells = room - cell_len(text)
    if cells >= LEAST_TRACK:
        return SliderForm(label, gap, cells, text)
    return SliderForm(label, gap, 0, text if cell_len(text) <= room + gap + 1 else "")


def slider_strip(
    parameter: Parameter, scale: SliderScale, state: SliderState, look: Look, width: int
) -> Strip:
    """Return the row of a slider."""
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
    """Return a segment for each cell of the track: the thumb covers marks, and they the track."""
    palette, glyphs = look.palette, look.glyphs
    thumb = scale.cell_of(value, cells)
    track = [Segment(glyphs.track_done, palette.slider_done)] * thumb
    track += [Segment(glyphs.track_rest, palette.slider_rest)] * (cells - thumb)
    for mark in sorted(state.marks, key=lambda mark: mark.stands_out):
        drawn = (glyphs.flip, palette.best) if mark.stands_out else (glyphs.side_flip, palette.dim)
        track[scale.cell_of(mark.value, cells)] = Segment(*drawn)
    track[thumb] = Segment(glyphs.thumb, palette.press if state.focused else palette.slider_thumb)
    return [Segment("".join(each.text for each in run), style) for style, run in groupby(track, _style_of)]


def _style_of(segment: Segment) -> Style | None:
    return segment.style


def _text_segments(text: str, state: SliderState, look: Look) -> list[Segment]:
    palette = look.palette
    if state.refused:
        return [Segment(text, palette.bad)]
    if state.typed is None:
        return [Segment(text, palette.strong)]
    return [Segment(text[: -len(_CARET)], palette.strong), Segment(_CARET, palette.focus)]


def _texts(parameter: Parameter, state: SliderState, glyphs: Glyphs) -> tuple[str, ...]:
    """Return the ways to write what stands beside the track, the longest first."""
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
