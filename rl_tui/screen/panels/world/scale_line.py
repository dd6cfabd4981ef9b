"""Colour scale and legend below a world."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import lru_cache
from typing import Final, NamedTuple

from textual.strip import Strip

from rl_tui.screen.draw.canvas import Line, Piece, length, spelled, strips_of
from rl_tui.screen.kit.panel import Legend
from rl_tui.screen.kit.value_scale import ValueScale, scale_pieces
from rl_tui.screen.theme.look import Look

VALUE: Final = "value"
NOTHING_KNOWN: Final = "nothing learned yet"
ALL_ZERO: Final = "0 so far"
VEILED: Final = "hidden: w h shows it"
_GAP: Final = "  "
_WIDE: Final = 50  # columns. In fewer, signs need the room of a long scale
_MOST_KEPT: Final = 64  # the same line is drawn in every frame


class NamedScale(NamedTuple):
    """A ``scale`` and its numbers' ``word``."""

    word: str
    scale: ValueScale
    unknown: str = NOTHING_KNOWN
    note: str = ""


@lru_cache(_MOST_KEPT)
def scale_line(
    said: tuple[Piece, ...], named: NamedScale | None, signs: Legend, width: int, look: Look
) -> Strip:
    """Draw ``said``, the scale, and fitting ``signs``."""
    line = list(said)
    forms = _scale_forms(named, width, look) if named is not None else ()
    _add(line, forms, width, look)
    if named is not None and named.note:
        _add(line, [(Piece(named.note, look.palette.dim),)], width, look)
    for sign in signs:
        meanings = filter(None, (sign.in_full, sign.meaning))
        mark = Piece(sign.sign.strip(), sign.style)
        _add(line, [(mark, Piece(f" {each}", look.palette.dim)) for each in meanings], width, look)
    return strips_of([line], width, 1, look)[0]


def _add(line: list[Piece], forms: Iterable[Line], width: int, look: Look) -> None:
    gap = [Piece(_GAP, look.palette.text)] if line else []
    for form in forms:
        if length(spelled([*line, *gap, *form], look)) <= width:
            line += [*gap, *form]
            return


def _scale_forms(named: NamedScale, width: int, look: Look) -> Iterator[tuple[Piece, ...]]:
    dim = look.palette.dim
    for every in (1, 2) if width >= _WIDE else (2,):
        if pieces := scale_pieces(named.scale, look, every=every):
            yield Piece(f"{named.word} ", dim), *pieces
    if named.scale.ends[0] >= named.scale.ends[1]:
        yield (Piece(f"{named.word}: {named.unknown}", dim),)
    if named.word != VALUE:
        yield (Piece(named.word, dim),)
