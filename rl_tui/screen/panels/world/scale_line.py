"""The line below the picture of a world: the scale of its tints, then what its signs mean."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import lru_cache
from typing import Final, NamedTuple

from textual.strip import Strip

from rl_tui.screen.draw import numbers
from rl_tui.screen.draw.canvas import Line, Piece, length, spelled, strips_of
from rl_tui.screen.kit.panel import Legend
from rl_tui.screen.kit.value_scale import Ramp, ValueScale
from rl_tui.screen.theme.look import Look

VALUE: Final = "value"
NOTHING_KNOWN: Final = "nothing known yet"
VEILED: Final = "hidden, h shows it"
_GAP: Final = "  "
_END: Final = 4  # characters of the value of an end
_MOST_KEPT: Final = 64  # the same line is drawn in every frame


class NamedScale(NamedTuple):
    """A ``scale`` and the ``word`` for what its tints say; ``unknown`` is said where it has no numbers.

    A ``note`` about the picture comes behind it.
    """

    word: str
    scale: ValueScale
    unknown: str = NOTHING_KNOWN
    note: str = ""


@lru_cache(_MOST_KEPT)
def scale_line(
    said: tuple[Piece, ...], named: NamedScale | None, signs: Legend, width: int, look: Look
) -> Strip:
    """Return one row of ``width`` cells: what is ``said`` first, the scale, then ``signs`` as there is room.

    Without a scale the signs follow at once.
    """
    line = list(said)
    forms = _scale_forms(named, look) if named is not None else ()
    _add(line, forms, width, look)
    if named is not None and named.note:
        _add(line, [(Piece(named.note, look.palette.dim),)], width, look)
    for sign in signs:
        pieces = sign.pieces or (Piece(sign.sign.strip(), sign.style),)
        _add(line, [(*pieces, Piece(f" {sign.meaning}", look.palette.dim))], width, look)
    return strips_of([line], width, 1, look)[0]


def _add(line: list[Piece], forms: Iterable[Line], width: int, look: Look) -> None:
    """Put the longest of ``forms`` that fits at the end of ``line``; nothing where none does."""
    gap = [Piece(_GAP, look.palette.text)] if line else []
    for form in forms:
        if length(spelled([*line, *gap, *form], look)) <= width:
            line += [*gap, *form]
            return


def scale_pieces(scale: ValueScale, look: Look, *, every: int = 1) -> tuple[Piece, ...]:
    """Return ``scale`` as its two ends with its tints between them, ``every`` second one, say.

    Without colours a word is between the ends; nothing where all that is known is 0.
    """
    low, high = scale.ends
    if high <= low:
        return ()
    palette = look.palette
    ends = [_end_text(end, scale, look) for end in (low, high)]
    if not palette.tints:
        return (Piece(f"{ends[0]} to {ends[1]}", palette.dim),)
    tints = (Piece(" ", style) for style in scale.tints(palette)[::every])
    return Piece(f"{ends[0]} ", palette.dim), *tints, Piece(f" {ends[1]}", palette.dim)


def _end_text(end: float, scale: ValueScale, look: Look) -> str:
    if scale.ramp is Ramp.VISITS:
        return numbers.count(int(end))
    return numbers.value(end, _END, look.glyphs, 2) if end else "0"


def _scale_forms(named: NamedScale, look: Look) -> Iterator[tuple[Piece, ...]]:
    """Yield the scale behind its word, the longest form first."""
    dim = look.palette.dim
    for every in (1, 2):
        if pieces := scale_pieces(named.scale, look, every=every):
            yield Piece(f"{named.word} ", dim), *pieces
    if named.scale.ends[0] >= named.scale.ends[1]:
        yield (Piece(f"{named.word}: {named.unknown}", dim),)
    yield (Piece(named.word, dim),)
