"""The values and actions in a picture of a world: the agent's, a planner's, or a studied policy's."""

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
from rl_tui.screen.kit.snapshot_facts import is_new_run
from rl_tui.screen.kit.value_scale import Ramp, ValueScale
from rl_tui.screen.panels.policies.studied import as_studied, studied_kind, study_headings
from rl_tui.screen.theme.look import Look
from rl_tui.worlds.mdp.space import FiniteSpace, FloatArray

# A drawn policy


AT_RANDOM: Final = "?"  # no action was drawn here: random


def drawn_actions(snapshot: Snapshot) -> Mapping[int, int] | None:
    """Return the action drawn in each state, None where the arrows are not those of the drawn policy."""
    answers = snapshot.answers
    return dict(answers.drawn.choices) if answers.studied is PolicyKind.DRAWN else None


def drawn_pairs(space: FiniteSpace, snapshot: Snapshot) -> tuple[frozenset[int], frozenset[int]] | None:
    """Return the pairs drawn, and the states in which none was; None as :func:`drawn_actions`."""
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


# A picture with values and actions


TITLE: Final = "World"


class PolicyPicture(Panel):
    """A picture with values and actions of states, and what it says of whose they are."""

    cell: Size | None = None
    """The size of a cell that the board gives it, 0 × 0 where it is no map; None in a preview."""
    studied: PolicyKind | None = None
    """The policy whose values and actions are drawn; None: they are what the agent has learned."""
    shows_drawing = False
    """Whether actions are those that a person drew, whether their values are known or not."""
    policy_shown = "greedy"  # what the arrows are, in a word
    lacks_table = False  # whether a program is watched of which no table is known
    names_policies_key = True
    """Whether it names the key that opens the panel of policies: not while that is open."""
    differing: frozenset[int] = frozenset()
    """The states whose greedy actions are others in the lane beside; seen when it is drawn again."""
    tints = ValueScale()  # the scale of the tints drawn last

    def show(self, snapshot: Snapshot) -> None:
        """Draw ``snapshot`` with values and actions of the policy that is studied, else of the agent."""
        shown, program = as_studied(snapshot), snapshot.program
        self.studied = studied_kind(snapshot)
        self.shows_drawing = snapshot.answers.studied is PolicyKind.DRAWN
        is_kept = len(shown.agent.policy) > 0  # by a planner
        self.policy_shown = "drawn" if self.shows_drawing else "policy" if is_kept else "greedy"
        self.lacks_table = program is not None and program.table is None and self.studied is None
        super().show(shown)

    def begins_anew(self, snapshot: Snapshot) -> bool:
        """Return whether the numbers of ``snapshot`` have nothing in common with those drawn until now."""
        before = self.snapshot
        if before is None or before.answers.studied is snapshot.answers.studied:
            return is_new_run(before, snapshot)
        return True

    @staticmethod
    def waits_for_study(snapshot: Snapshot) -> bool:
        """Return whether values of a policy are to come in place of those that ``snapshot`` shows."""
        return snapshot.answers.studied is not None and studied_kind(snapshot) is None

    def study_headings(self, what: str) -> tuple[str, ...]:
        """Return headings that say of which policy ``what`` is, or how to see it; none for the agent's."""
        if self.snapshot is None:
            return ()
        key = self.names_policies_key
        return study_headings(self.snapshot, self.studied, TITLE, what, names_key=key)

    def random_signs(self) -> Legend:
        """Return the signs of states in which nothing was drawn: those it may come to, and all others."""
        if not self.shows_drawing:
            return ()
        palette = self.look.palette
        return (
            LegendSign(AT_RANDOM, "random", palette.strong),
            LegendSign(AT_RANDOM, "off its way", palette.dim),
        )

    def valueless_signs(self) -> Legend:
        """Return the sign of a state of no value; none where there is no such state."""
        snapshot = self.snapshot
        if snapshot is None or self.studied is None or not np.isnan(snapshot.agent.values).any():
            return ()
        return (no_value_sign(self.look),)

    def missing_table_signs(self) -> Legend:
        """Return the sign of a value that is missing, since a program has no table; else none."""
        sign = LegendSign(numbers.missing(self.look.glyphs), "no table", self.look.palette.text)
        return (sign,) if self.lacks_table else ()


# V(s) and actions of all states


_DECIMALS: Final = 2


@dataclass(frozen=True, slots=True)
class StateValues:
    """``value[s]`` is V(s), None where nothing can be done; ``greedy`` are pairs, all ties.

    ``known`` are the states about which something was learned. Of a drawn policy ``greedy`` are its pairs,
    ``at_random`` the states without one, and ``off_way`` those that it never reaches. ``numbers`` are all
    values that share a form, and ``scale`` is that of their tints.
    """

    value: tuple[float | None, ...]
    known: frozenset[int]
    greedy: frozenset[int]
    numbers: FloatArray
    scale: ValueScale
    at_random: frozenset[int] = frozenset()
    off_way: frozenset[int] = frozenset()

    def number_form(self, width: int, forms: SteadyForms) -> NumberForm:
        """Return the form of all values in ``width`` cells; visits are whole."""
        ramp = self.scale.ramp
        return forms.form(ramp, self.numbers, width, 0 if ramp is Ramp.VISITS else _DECIMALS)

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
        """Return the background of a state, tinted by its value."""
        value = self.value[state]
        if value is None or math.isnan(value):
            return look.palette.text
        if state not in self.known:
            return look.palette.unvisited
        return self.scale.style(value, look.palette)


def state_values(space: FiniteSpace, snapshot: Snapshot, scale: ValueScale) -> StateValues:
    """Return the values of ``snapshot``, tinted on ``scale``."""
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
            if len(pairs) > 1:  # a single action is not the best of anything
                greedy |= {pair for pair in pairs if (policy[pair] > 0.0 if policy else q[pair] == best)}
    shown = drawn_pairs(space, snapshot) or (frozenset(greedy), frozenset())
    off_way = frozenset(state for state in shown[1] if is_off_way(snapshot, state))
    return StateValues(tuple(values), frozenset(known), shown[0], all_v(snapshot), scale, shown[1], off_way)
