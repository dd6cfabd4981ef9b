"""The flips of a world as a list: γ, what the policy earns on both sides, and what turns."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import groupby
from typing import TYPE_CHECKING, Final, NamedTuple

from rich.cells import cell_len

from rl_tui.tui.draw import numbers
from rl_tui.tui.draw.action_order import shown_pairs
from rl_tui.tui.draw.names import action_name, state_name
from rl_tui.tui.draw.pieces import Line, Piece, kept, wrapped
from rl_tui.tui.draw.to_ascii import to_ascii
from rl_tui.tui.panels.discount.chart import flip_sign, flip_style
from rl_tui.tui.theme.look import Look
from rl_tui.worlds.world import World

if TYPE_CHECKING:
    from rl_tui.agents.exact.flips.flips import Flip, Turn

_LEAST_DECIMALS: Final = 4
_MOST_DECIMALS: Final = 12
_LARGE: Final = 1e7  # from here on a return is written with an exponent
_MOST_STATES: Final = 12
_SIGNS: Final = 3  # columns before γ
_GAP: Final = "  "
UNKNOWN: Final = "unknown"


class FlipForm(NamedTuple):
    """How γ and returns are written, the same for all flips of a list."""

    gamma_decimals: int
    return_decimals: int
    verb: str = "earns "

    def gamma(self, flip: Flip, look: Look) -> str:
        """Return the γ of ``flip``."""
        return numbers.fixed(flip.gamma, self.gamma_decimals, look.glyphs, leading_zero=False)

    def returns(self, flip: Flip, look: Look) -> str:
        """Return what the optimal policy earns below and above ``flip``: different texts where it differs."""
        known = [each for each in flip.expected_return if each is not None]
        is_equal = len(known) < 2 or abs(known[0] - known[1]) < numbers.NEGLIGIBLE
        decimals = self.return_decimals
        while not is_equal and decimals < _MOST_DECIMALS:
            if _return_text(known[0], decimals, look) != _return_text(known[1], decimals, look):
                break
            decimals += 1
        below, above = (_return_text(each, decimals, look) for each in flip.expected_return)
        return f"{self.verb}{below} below, {above} above"


_FORMS: Final = (
    FlipForm(12, 6),
    FlipForm(9, 4),
    FlipForm(6, 3),
    FlipForm(6, 3, ""),
    FlipForm(_LEAST_DECIMALS, 3, ""),
    FlipForm(_LEAST_DECIMALS, 2, ""),
)


def fitting_form(flips: Sequence[Flip], look: Look, width: int) -> FlipForm:
    """Return the longest form in which ``width`` cells hold γ and returns of each of ``flips``.

    It tells every γ from the next, and has no more decimals than there are.
    """
    gammas = [flip.gamma for flip in flips]
    returns = [each for flip in flips for each in flip.expected_return if each is not None]
    least = next(
        (
            decimals
            for decimals in range(_LEAST_DECIMALS, _MOST_DECIMALS)
            if len({round(gamma, decimals) for gamma in gammas}) == len(gammas)
        ),
        _MOST_DECIMALS,
    )
    for longest in _FORMS:
        form = longest._replace(
            gamma_decimals=_decimals_of(gammas, max(least, longest.gamma_decimals)),
            return_decimals=_decimals_of(returns, longest.return_decimals),
        )
        texts = (f"{form.gamma(flip, look)}{_GAP}{form.returns(flip, look)}" for flip in flips)
        if all(_SIGNS + cell_len(to_ascii(text, look.glyphs)) <= width for text in texts):
            break
    return form


def _decimals_of(values: Sequence[float], most: int) -> int:
    """Return how many decimals, ``most`` at the most, ``values`` have."""
    return max((len(f"{value:.{most}f}".rstrip("0").partition(".")[2]) for value in values), default=most)


def _return_text(value: float | None, decimals: int, look: Look) -> str:
    if value is None:
        return UNKNOWN
    if not 10.0**-decimals <= abs(value) < _LARGE:
        return numbers.brief(value, look.glyphs, decimals=decimals)
    return numbers.fixed(value, decimals, look.glyphs, leading_zero=False)


def flip_lines(
    flip: Flip, state: int, world: World, look: Look, width: int, form: FlipForm, *, is_chosen: bool
) -> list[Line]:
    """Return the lines of one flip: γ and returns, then what turns, that in ``state`` first."""
    palette, glyphs = look.palette, look.glyphs
    is_here = any(turn.state == state for turn in flip.turns)
    signs = flip_sign(flip, look) + (glyphs.change_mark if is_here else " ")
    style = palette.focus if is_chosen else palette.strong if is_here or flip.turns_the_way else palette.text
    lines: list[Line] = [
        [
            Piece(f" {signs}", flip_style(flip, look)),
            Piece(form.gamma(flip, look), style),
            Piece(f"{_GAP}{form.returns(flip, look)}", palette.text),
        ]
    ]
    for text in turns_in_words(flip.turns, state, world, look):
        lines += wrapped(text, width, palette.text if is_here else palette.dim, look, "    ", "      ")
    return lines


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
