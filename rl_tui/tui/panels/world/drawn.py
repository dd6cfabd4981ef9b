"""The policy that a person drew, as the pictures of worlds show it while it is studied."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from rich.style import Style

from rl_tui.lab.answers.policy_kind import PolicyKind
from rl_tui.lab.live.snapshot import Snapshot
from rl_tui.tui.panels.legend import LegendSign
from rl_tui.tui.theme.look import Look
from rl_tui.worlds.mdp.space import FiniteSpace

AT_RANDOM: Final = "?"
"""In place of an arrow: no action was drawn, so it acts at random."""
DRAWN_IN_FULL: Final = "drawn: your choice"


def drawn_actions(snapshot: Snapshot) -> Mapping[int, int] | None:
    """Return the action drawn in each state, None where the arrows are not those of the drawn policy."""
    answers = snapshot.answers
    return dict(answers.drawn.choices) if answers.studied is PolicyKind.DRAWN else None


def drawn_pairs(space: FiniteSpace, snapshot: Snapshot) -> tuple[frozenset[int], frozenset[int]] | None:
    """Return the pairs drawn, and the states in which none was; None as :func:`drawn_actions`.

    Where a state has a single action, that is its pair.
    """
    drawn = drawn_actions(snapshot)
    if drawn is None:
        return None
    pairs, at_random = set(), set()
    for state in range(space.states):
        own = space.pairs_of(state)
        pair = own.start if len(own) == 1 else space.pair_of(state, drawn.get(state, -1))
        if pair is not None:
            pairs.add(pair)
        elif own:
            at_random.add(state)
    return frozenset(pairs), frozenset(at_random)


def is_off_way(snapshot: Snapshot, state: int) -> bool:
    """Return whether the drawn policy never comes to ``state``, in which nothing was drawn."""
    left = snapshot.answers.left_to_chance
    return left is not None and not left[state]


def off_way_style(style: Style, look: Look) -> Style:
    """Return ``style`` for what need not be drawn, since the policy never comes there."""
    return style + look.palette.dim + Style(bold=False)


def random_signs(look: Look) -> tuple[LegendSign, ...]:
    """Return how states are marked in which nothing was drawn: those it may come to, and all others."""
    return (
        LegendSign(AT_RANDOM, "random", look.palette.strong, "nothing drawn: at random"),
        LegendSign(AT_RANDOM, "off its way", look.palette.dim, "off its way"),
    )
