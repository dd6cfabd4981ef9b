"""The flips of a world as a list: γ, what the policy earns on both sides, and what turns."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import groupby
from typing import TYPE_CHECKING, Final

from rl_tui.tui.draw import numbers
from rl_tui.tui.draw.action_order import shown_pairs
from rl_tui.tui.draw.names import action_name, state_name
from rl_tui.tui.draw.pieces import Line, Piece, first_that_fits, kept, wrapped
from rl_tui.tui.panels.discount.chart import flip_sign, flip_style
from rl_tui.tui.theme.look import Look
from rl_tui.worlds.world import World

if TYPE_CHECKING:
    from rl_tui.agents.exact.flips.flips import Flip, Turn

_DIGITS: Final = (12, 9, 6, 4)
_RETURNS: Final = (6, 4, 3, 2)
_MOST_STATES: Final = 12
UNKNOWN: Final = "unknown"


def flip_lines(
    flip: Flip, state: int, world: World, look: Look, width: int, *, is_chosen: bool
) -> list[Line]:
    """Return the lines of one flip: γ and returns, then what turns, that in ``state`` first."""
    palette, glyphs = look.palette, look.glyphs
    is_here = any(turn.state == state for turn in flip.turns)
    signs = flip_sign(flip, look) + (glyphs.change_mark if is_here else " ")
    style = palette.focus if is_chosen else palette.strong if is_here or flip.turns_the_way else palette.text
    heads = (
        [
            Piece(f" {signs}", flip_style(flip, look)),
            Piece(gamma_text(flip.gamma, digits, look), style),
            Piece(f"  {earned}", palette.text),
        ]
        for digits, decimals in zip(_DIGITS, _RETURNS, strict=True)
        for earned in returns_in_words(flip, decimals, look)
    )
    lines: list[Line] = [first_that_fits(heads, width, look)]
    for text in turns_in_words(flip.turns, state, world, look):
        lines += wrapped(text, width, palette.text if is_here else palette.dim, look, "    ", "      ")
    return lines


def gamma_text(gamma: float, digits: int, look: Look) -> str:
    """Return a γ with at most so many decimals."""
    return numbers.brief(gamma, look.glyphs, decimals=digits)


def returns_in_words(flip: Flip, decimals: int, look: Look) -> tuple[str, str]:
    """Return what the optimal policy earns below and above ``flip``, the longer form first."""
    below, above = (
        UNKNOWN if each is None else numbers.brief(each, look.glyphs, decimals=decimals)
        for each in flip.expected_return
    )
    return f"earns {below} below, {above} above", f"earns {below}, then {above}"


def turns_in_words(turns: Sequence[Turn], state: int, world: World, look: Look) -> Iterator[str]:
    """Yield ``states 0, 2: ← to ↑``, a text for each change of actions, that in ``state`` first."""

    def changes(turn: Turn) -> tuple[str, str]:
        return _actions(turn.before, world, look), _actions(turn.after, world, look)

    def order(turn: Turn) -> tuple[tuple[str, str], int]:
        return changes(turn), turn.state

    groups = [list(group) for _, group in groupby(sorted(turns, key=order), changes)]
    for group in sorted(
        groups, key=lambda group: (all(turn.state != state for turn in group), group[0].state)
    ):
        before, after = changes(group[0])
        names = [kept(state_name(world, turn.state, look.glyphs)) for turn in group]
        more = len(names) - _MOST_STATES
        listed = ", ".join(names[:_MOST_STATES]) + (f" and {more} more" if more > 0 else "")
        yield f"{'state' if len(group) == 1 else 'states'} {listed}: {kept(f'{before} to {after}')}"


def _actions(pairs: Sequence[int], world: World, look: Look) -> str:
    """Return the names of the actions of ``pairs``, all of one state."""
    names = (
        action_name(world, int(world.space.pair_action[pair]), look.glyphs)
        for pair in shown_pairs(world, pairs)
    )
    return ", ".join(names)
