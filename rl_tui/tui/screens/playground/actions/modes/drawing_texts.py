"""What the screen says while a person draws a policy."""

from __future__ import annotations

from collections.abc import Iterator

from rl_tui.common.words import counted
from rl_tui.lab.answers.policy_kind import PolicyKind
from rl_tui.lab.live.snapshot import Snapshot
from rl_tui.tui.draw import numbers
from rl_tui.tui.panels.policies.studied import is_kept_back
from rl_tui.tui.screens.key_line import Hints
from rl_tui.tui.screens.playground.actions.modes.action_keys import (
    actions_in_a_line,
    digits_in_words,
    has_directions,
)
from rl_tui.tui.theme.glyphs import Glyphs
from rl_tui.worlds.drawing import Arms
from rl_tui.worlds.world import World

_END = "D: end"
_FIGURE = 8  # cells of a return, as in the table of policies


def title(snapshot: Snapshot, glyphs: Glyphs) -> tuple[str, ...]:
    """Return what the world is called while a policy is drawn on it, the longest form first."""
    figures = tuple(_figures(snapshot, glyphs))
    if not figures:
        return "You draw a policy", "You draw"
    whole = " · ".join(figures)
    brief = whole.replace(" states at", " at").replace(" state at", " at")
    forms = (
        f"You draw a policy · {whole}",
        f"You draw · {whole}",
        f"You draw · {brief}",
        f"Drawn · {brief}",
        brief,
    )
    return (*forms, *(form for each in figures for form in (f"You draw · {each}", each)), "You draw")


def _figures(snapshot: Snapshot, glyphs: Glyphs) -> Iterator[str]:
    """Yield what the drawn policy earns, then what of it is open."""
    world, answers = snapshot.world, snapshot.answers
    if not answers.drawn.choices:
        yield "nothing drawn: all at random"
        return
    worth = answers.policies.get(PolicyKind.DRAWN)
    if is_kept_back(snapshot, PolicyKind.DRAWN):
        yield "its return is hidden"
    elif worth is not None and worth.expected_return is not None:
        yield f"return {numbers.figure(worth.expected_return, _FIGURE, glyphs)}"
    elif worth is not None and (worth.is_known or worth.refused):
        yield f"no return: {worth.refused or 'it may never end'}"
    if isinstance(world.drawing, Arms):
        return
    left = answers.left_to_chance
    if left is not None:
        yield f"{counted(left, 'state')} at random" if left else "nothing at random"


def prompts(world: World, state: int | None, glyphs: Glyphs) -> tuple[str, ...]:
    """Return the keys for ``state``, under the cursor, the longest form first; None: nothing to choose."""
    if state is None:
        return f"nothing to choose here · {_END}", _END
    forms = actions_in_a_line(world, state, glyphs) or (f"{digits_in_words(world, state)}: arm",)
    ends = f" · del: none · C: clear · {_END}", f" · {_END}"
    return (*(f"{form}{end}" for end in ends for form in forms[:2]), *forms, _END)


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
