"""V(s) and the policy in all states at one moment, for worlds small enough to show whole."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

from rich.style import Style

from rl_tui.lab.live.snapshot import Snapshot
from rl_tui.tui.draw import numbers
from rl_tui.tui.draw.number_form import NumberForm, SteadyForms
from rl_tui.tui.panels.numbers_in_common import all_v, ends
from rl_tui.tui.panels.world.drawn import AT_RANDOM, drawn_pairs, is_off_way, off_way_style
from rl_tui.tui.theme.look import Look
from rl_tui.worlds.mdp.space import FiniteSpace, FloatArray

_DECIMALS: Final = 2


@dataclass(frozen=True, slots=True)
class StateValues:
    """``value[s]`` is max over a of Q(s, a), None where nothing can be done.

    ``known`` holds the states about which something was learned: updated, or with estimates that differ;
    ``greedy`` the greedy pairs of those states, all ties. Where policy iteration keeps a policy, value and
    pairs are those of that. Where a drawn one is studied, the pairs are those drawn, ``at_random`` has the
    states in which none was, and ``off_way`` those of them to which it never comes. ``numbers`` are all
    values that have one form and one scale of tints: of two lanes side by side those of both.
    """

    value: tuple[float | None, ...]
    known: frozenset[int]
    greedy: frozenset[int]
    numbers: FloatArray
    at_random: frozenset[int] = frozenset()
    off_way: frozenset[int] = frozenset()

    def number_form(self, width: int, forms: SteadyForms) -> NumberForm:
        """Return the form of all values in ``width`` cells."""
        return forms.form("values", self.numbers, width, _DECIMALS)

    def text(self, state: int, form: NumberForm, look: Look) -> str:
        """Return the value of a state in ``form``: a dash for NaN, nothing where nothing can be done."""
        value = self.value[state]
        if value is None:
            return ""
        return numbers.missing(look.glyphs) if math.isnan(value) else form.text(value, look.glyphs)

    def flag(self, state: int, differing: frozenset[int], look: Look) -> str:
        """Return the sign after the name of a state: that it acts at random, or is ``differing``; or none."""
        if state in self.at_random:
            return AT_RANDOM
        return look.glyphs.differs if state in differing else ""

    def flag_style(self, state: int, style: Style, look: Look) -> Style:
        """Return the style of that sign, which stands on ``style``."""
        return off_way_style(style, look) if state in self.off_way else style

    def style(self, state: int, look: Look) -> Style:
        """Return the background of a state, tinted from the least to the greatest value, 0 included."""
        value = self.value[state]
        if value is None or math.isnan(value):
            return look.palette.text
        if state not in self.known:
            return look.palette.unvisited
        low, high = ends(self.numbers)
        return look.palette.value(fraction(value, min(low, 0.0), max(high, 0.0)))


def fraction(value: float, low: float, high: float) -> float:
    """Return where ``value`` lies between ``low`` (0) and ``high`` (1); 0 where that means nothing."""
    span = high - low
    return (value - low) / span if math.isfinite(value) and math.isfinite(span) and span > 0.0 else 0.0


def state_values(space: FiniteSpace, snapshot: Snapshot) -> StateValues:
    """Return the values of ``snapshot``."""
    values: list[float | None] = []
    known, greedy = set(), set()
    agent = snapshot.agent
    q, visits, policy = agent.q.tolist(), agent.visits.tolist(), agent.policy.tolist()
    for state in range(space.states):
        pairs = space.pairs_of(state)
        if not pairs:
            values.append(None)
            continue
        best = max(q[pairs.start : pairs.stop])
        values.append(float(agent.values[state]) if policy else best)
        if any(visits[pairs.start : pairs.stop]) or min(q[pairs.start : pairs.stop]) != best:
            known.add(state)
            greedy |= {pair for pair in pairs if (policy[pair] > 0.0 if policy else q[pair] == best)}
    shown = drawn_pairs(space, snapshot) or (frozenset(greedy), frozenset())
    off_way = frozenset(state for state in shown[1] if is_off_way(snapshot, state))
    return StateValues(tuple(values), frozenset(known), shown[0], all_v(snapshot), shown[1], off_way)
