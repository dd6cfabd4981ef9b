"""What the screen says while a person draws a policy."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final

from rl_tui.common.words import counted
from rl_tui.lab.answers.policy_kind import PolicyKind
from rl_tui.lab.live.snapshot import Snapshot
from rl_tui.tui.draw import numbers
from rl_tui.tui.panels.policies.studied import is_kept_back
from rl_tui.tui.panels.snapshot_facts import shown_by
from rl_tui.tui.panels.world.drawn import AT_RANDOM
from rl_tui.tui.screens.key_line import Hints
from rl_tui.tui.screens.playground.actions.modes.action_keys import (
    actions_in_a_line,
    digits_in_words,
    has_directions,
)
from rl_tui.tui.theme.glyphs import Glyphs
from rl_tui.worlds.drawing import Arms
from rl_tui.worlds.world import World

NOTHING_TO_CHOOSE: Final = "nothing to choose"

_END = "D: end"
_FIGURE = 8  # cells of a return, as in the table of policies


def title(snapshot: Snapshot, glyphs: Glyphs) -> tuple[str, ...]:
    """Return what the world is called while a policy is drawn on it, the longest form first."""
    figures = tuple(_figures(snapshot, glyphs))
    if not figures:
        return "You draw a policy", "You draw"
    together = [" · ".join(each) for each in _forms(figures)]
    return (
        f"You draw a policy · {together[0]}",
        *(f"{start} · {each}" for each in together for start in ("You draw", "Drawn")),
        *(f"You draw · {form}" for each in figures for form in each),
        "You draw",
    )


def _forms(figures: Sequence[Sequence[str]]) -> Iterator[tuple[str, ...]]:
    """Yield all figures, from the longest forms of each to the shortest ones."""
    for place in range(max(map(len, figures))):
        yield tuple(each[min(place, len(each) - 1)] for each in figures)


def _figures(snapshot: Snapshot, glyphs: Glyphs) -> Iterator[tuple[str, ...]]:
    """Yield what the drawn policy earns, then what of it is open, each the longest form first."""
    world, answers = snapshot.world, snapshot.answers
    if not answers.drawn.choices:
        yield (f"all at random ({AT_RANDOM})", "all at random")
        return
    worth = answers.policies.get(PolicyKind.DRAWN)
    if is_kept_back(snapshot, PolicyKind.DRAWN):
        yield f"its return is hidden ({shown_by(snapshot)})", "its return is hidden", "return hidden"
    elif worth is not None and worth.expected_return is not None:
        yield (f"return {_amount(worth.expected_return, glyphs)}",)
    elif worth is not None and (worth.is_known or worth.refused):
        yield (f"no return: {worth.refused or 'it may never end'}",)
    left = answers.left_to_chance
    if left is not None and not isinstance(world.drawing, Arms):
        yield _left(int(left.sum()))


def _amount(x: float, glyphs: Glyphs) -> str:
    """Return ``x`` as briefly as it is, else as the table of policies writes it: ``1``, ``−131,546``."""
    exact = numbers.brief(x, glyphs, decimals=numbers.DECIMALS)
    return exact if len(exact) < _FIGURE - 1 and abs(x) < 1_000.0 else numbers.figure(x, _FIGURE, glyphs)


def _left(count: int) -> tuple[str, ...]:
    """Return in how many states it may come to act at random; elsewhere it may, but is never there."""
    if not count:
        return "all on its way drawn", "its way is drawn", "way drawn"
    return (
        f"{counted(count, 'state')} on its way at random ({AT_RANDOM})",
        f"{count:,} on its way at random ({AT_RANDOM})",
        f"{count:,} at random ({AT_RANDOM})",
        f"{count:,} at random",
        f"{count:,} random",
    )


def prompts(world: World, state: int | None, glyphs: Glyphs) -> tuple[str, ...]:
    """Return the keys for ``state``, under the cursor, the longest form first; None: nothing to choose."""
    if state is None:
        return f"{NOTHING_TO_CHOOSE} here · {_END}", _END
    forms = actions_in_a_line(world, state, glyphs) or (f"{digits_in_words(world, state)}: arm",)
    in_full = (f"{form} · del: none · C: clear · {_END}" for form in forms[:2])
    return (*in_full, *(f"{form} · {_END}" for form in forms), *forms, _END)


def hints(world: World) -> Hints:
    """Return the keys for the key line, with what they do in a word; the last but one goes first."""
    moves = (("arrows", "cursor"),)
    if isinstance(world.drawing, Arms):
        draws: Hints = (("enter", "draw"),)
    elif has_directions(world):
        draws = (("shift+arrow", "draw"),)
    else:
        draws = ()
    return (*draws, ("digits", "draw"), ("D", "end"), ("del", "none"), ("C", "clear"), *moves, ("?", "help"))
