"""The legend of a panel: its signs and what they mean, on rows of its own or on the border."""

from __future__ import annotations

from functools import lru_cache
from typing import Final, NamedTuple

from rich.cells import cell_len
from rich.style import Style
from textual.strip import Strip

from rl_tui.lab.live.snapshot import Snapshot
from rl_tui.tui.draw import numbers
from rl_tui.tui.draw.pieces import Piece, length, spelled, strips_of
from rl_tui.tui.draw.to_ascii import separated, to_ascii
from rl_tui.tui.theme.look import Look

GREEDY_IN_FULL: Final = "greedy: looks best"
POLICY_IN_FULL: Final = "policy: what it does"
AGENT: Final = "agent"
MAY_NEVER_END: Final = "may never end"
_GAP: Final = "  "
_BETWEEN: Final = " · "
_CLOSER: Final = ", "  # where all signs fit so
_MOST_KEPT: Final = 64  # the same legend is drawn in every frame


class LegendSign(NamedTuple):
    """A ``sign`` as the panel draws it, characters and ``style``, and its ``meaning`` in a word or two.

    The sign is in the characters of the look already. ``in_full`` is the meaning where all of the legend has
    room for that; empty: the same.
    """

    sign: str
    meaning: str
    style: Style
    in_full: str = ""


Legend = tuple[LegendSign, ...]


def agent_meaning(snapshot: Snapshot) -> str:
    """Return what the sign of the agent means; a planner is nowhere, but has backed up a state."""
    return "backed up" if snapshot.agent.row.planner else AGENT


def no_value_sign(look: Look) -> LegendSign:
    """Return how a state or pair is marked that has no value, since its policy may never end from there."""
    return LegendSign(numbers.missing(look.glyphs), "none", look.palette.text, f"no value: {MAY_NEVER_END}")


def no_table_sign(look: Look) -> LegendSign:
    """Return how a state is marked that has no value, since no table of the program is known."""
    return LegendSign(numbers.missing(look.glyphs), "no table", look.palette.text, "no table, so no value")


@lru_cache(_MOST_KEPT)
def legend_rows(signs: Legend, width: int, most: int, look: Look) -> tuple[Strip, ...]:
    """Return ``signs`` in as many rows of ``width`` cells as they take, ``most`` of them."""
    lines = _lines(_in_full(signs), width, look)
    if len(lines) > most:
        lines = _lines(signs, width, look)
    return tuple(strips_of(lines, width, min(most, len(lines)), look))


def _in_full(signs: Legend) -> Legend:
    return tuple(sign._replace(meaning=sign.in_full or sign.meaning) for sign in signs)


def _lines(signs: Legend, width: int, look: Look) -> list[list[Piece]]:
    lines: list[list[Piece]] = []
    for sign in signs:
        entry = [Piece(sign.sign, sign.style), Piece(f" {sign.meaning}", look.palette.dim)]
        if lines and length(spelled([*lines[-1], *entry], look)) + len(_GAP) <= width:
            lines[-1] += [Piece(_GAP, look.palette.dim), *entry]
        else:
            lines.append([Piece(" ", look.palette.dim), *entry])
    return lines


@lru_cache(_MOST_KEPT)
def legend_text(signs: Legend, room: int, look: Look) -> str:
    """Return as many of ``signs``, the first before the others, as ``room`` cells of a border hold."""
    entries = _entries(_in_full(signs), look)
    if cell_len(separated(_BETWEEN.join(entries), look.glyphs)) > room:
        entries = _entries(signs, look)
    whole = _CLOSER.join(entries)
    if cell_len(separated(_BETWEEN.join(entries), look.glyphs)) > room >= cell_len(whole):
        return whole
    text = ""
    for entry in entries:
        longer = f"{text}{_BETWEEN}{entry}" if text else entry
        if cell_len(separated(longer, look.glyphs)) <= room:
            text = longer
    return text


def _entries(signs: Legend, look: Look) -> list[str]:
    return [f"{sign.sign.strip()} {to_ascii(sign.meaning, look.glyphs)}".strip() for sign in signs]
