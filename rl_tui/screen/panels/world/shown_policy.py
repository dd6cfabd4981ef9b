"""A picture's values and actions: learned, or of a studied policy."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np
from rich.style import Style
from textual.geometry import Size

from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.answers.policy_kind import PolicyKind
from rl_tui.screen.draw import numbers
from rl_tui.screen.draw.number_form import NumberForm, SteadyForms
from rl_tui.screen.kit.numbers_in_common import all_v
from rl_tui.screen.kit.panel import Legend, LegendSign, Panel, no_value_sign
from rl_tui.screen.kit.snapshot_facts import is_new_run, studied_kind
from rl_tui.screen.kit.value_scale import Ramp, ValueScale
from rl_tui.screen.panels.policies.studied import as_studied, study_headings
from rl_tui.screen.theme.look import Look
from rl_tui.worlds.mdp.space import FiniteSpace, FloatArray

# A drawn policy


AT_RANDOM: Final = "?"  # no action drawn: random


def drawn_actions(snapshot: Snapshot) -> Mapping[int, int] | None:
    """Return each state's drawn action, if shown."""
    answers = snapshot.answers
    return dict(answers.drawn.choices) if answers.studied is PolicyKind.DRAWN else None


def drawn_pairs(space: FiniteSpace, snapshot: Snapshot) -> tuple[frozenset[int], frozenset[int]] | None:
    """Return the drawn pairs and the states without one."""
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
    """Return whether an undrawn ``state`` is never reached."""
    left = snapshot.answers.left_to_chance
    return left is not None and not left[state]


def off_way_style(style: Style, look: Look) -> Style:
    """Restyle states that are never reached."""
    return style + look.palette.dim + Style(bold=False)


# A picture with values and actions


TITLE: Final = "World"


class PolicyPicture(Panel):
    """A picture with values and actions."""

    cell: Size | None = None
    """The cell size set by the board: 0 × 0 without a map, None in a preview."""
    studied: PolicyKind | None = None
    """The policy that is drawn, or None if learned."""
    shows_drawing = False
    """Whether the actions were drawn by a person."""
    policy_shown = "greedy"  # one word for the arrows
    lacks_table = False  # a watched program without a known table
    names_policies_key = True
    """Whether headings name the key of the panel of policies."""
    differing: frozenset[int] = frozenset()
    """States with other greedy actions in the second run."""
    tints = ValueScale()  # scale of the last colours

    def show(self, snapshot: Snapshot) -> None:
        """Draw the studied policy, else the agent's."""
        shown, program = as_studied(snapshot), snapshot.program
        self.studied = studied_kind(snapshot)
        self.shows_drawing = snapshot.answers.studied is PolicyKind.DRAWN
        is_kept = len(shown.agent.policy) > 0  # by a planner
        self.policy_shown = "drawn" if self.shows_drawing else "policy" if is_kept else "greedy"
        self.lacks_table = program is not None and program.table is None and self.studied is None
        super().show(shown)

    def begins_anew(self, snapshot: Snapshot) -> bool:
        """Return whether the numbers are unrelated to before."""
        before = self.snapshot
        if before is None or before.answers.studied is snapshot.answers.studied:
            return is_new_run(before, snapshot)
        return True

    @staticmethod
    def waits_for_study(snapshot: Snapshot) -> bool:
        """Return whether a policy's values will come soon."""
        return snapshot.answers.studied is not None and studied_kind(snapshot) is None

    def study_headings(self, what: str) -> tuple[str, ...]:
        """Return headings that name the policy."""
        if self.snapshot is None:
            return ()
        key = self.names_policies_key
        return study_headings(self.snapshot, self.studied, TITLE, what, names_key=key)

    def random_signs(self) -> Legend:
        """Return the sign of undrawn states."""
        if not self.shows_drawing:
            return ()
        palette = self.look.palette
        return (
            LegendSign(AT_RANDOM, "random", palette.strong),
            LegendSign(AT_RANDOM, "off its way", palette.dim),
        )

    def valueless_signs(self) -> Legend:
        """Return the sign of a missing value."""
        snapshot = self.snapshot
        if snapshot is None or self.studied is None or not np.isnan(snapshot.agent.values).any():
            return ()
        return (no_value_sign(self.look),)

    def missing_table_signs(self) -> Legend:
        """Return the sign of values missing without a table."""
        sign = LegendSign(numbers.missing(self.look.glyphs), "no table", self.look.palette.text)
        return (sign,) if self.lacks_table else ()


# V(s) and actions of all states


_DECIMALS: Final = 2


@dataclass(frozen=True, slots=True)
class StateValues:
    """Values and actions of all states.

    ``value``: V(s), None without actions. ``greedy``: pairs with ties, or drawn ones. ``at_random``: without
    a drawn action. ``off_way``: those never reached.
    """

    value: tuple[float | None, ...]
    known: frozenset[int]
    greedy: frozenset[int]
    numbers: FloatArray
    scale: ValueScale
    at_random: frozenset[int] = frozenset()
    off_way: frozenset[int] = frozenset()

    def number_form(self, width: int, forms: SteadyForms) -> NumberForm:
        """Return the form of all values."""
        ramp = self.scale.ramp
        return forms.form(ramp, self.numbers, width, 0 if ramp is Ramp.VISITS else _DECIMALS)

    def text(self, state: int, form: NumberForm, look: Look) -> str:
        """Write a state's value: a dash for NaN, empty without actions."""
        value = self.value[state]
        if value is None:
            return ""
        return numbers.missing(look.glyphs) if math.isnan(value) else form.text(value, look.glyphs)

    def flag(self, state: int, differing: frozenset[int], look: Look) -> str:
        """Return the flag after a state's name."""
        if state in self.at_random:
            return AT_RANDOM
        return look.glyphs.differs if state in differing else ""

    def flag_style(self, state: int, style: Style, look: Look) -> Style:
        """Return the flag's style on ``style``."""
        return off_way_style(style, look) if state in self.off_way else style

    def style(self, state: int, look: Look) -> Style:
        """Return the background, coloured by value."""
        value = self.value[state]
        if value is None or math.isnan(value):
            return look.palette.text
        if state not in self.known:
            return look.palette.unvisited
        return self.scale.style(value, look.palette)


def state_values(space: FiniteSpace, snapshot: Snapshot, scale: ValueScale) -> StateValues:
    """Return the values, coloured on ``scale``."""
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
            if len(pairs) > 1:  # a single action is not better than others
                greedy |= {pair for pair in pairs if (policy[pair] > 0.0 if policy else q[pair] == best)}
    shown = drawn_pairs(space, snapshot) or (frozenset(greedy), frozenset())
    off_way = frozenset(state for state in shown[1] if is_off_way(snapshot, state))
    return StateValues(tuple(values), frozenset(known), shown[0], all_v(snapshot), scale, shown[1], off_way)
