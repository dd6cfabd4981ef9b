"""The number under the cursor, explained."""

from __future__ import annotations

import math
from typing import Final, NamedTuple

from textual.geometry import Offset
from textual.widget import Widget

from rl_tui.common.words import counted
from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.answers.policy_kind import PolicyKind
from rl_tui.screen.draw import names
from rl_tui.screen.draw.action_order import shown_pairs
from rl_tui.screen.draw.number_form import number_form
from rl_tui.screen.kit.layers import Layer, exact_q, other_lane
from rl_tui.screen.kit.snapshot_facts import has_estimates, hides_means, is_secret, shown_by
from rl_tui.screen.panels.model import SECRET
from rl_tui.screen.panels.policies.studied import policy_name
from rl_tui.screen.panels.q_table.layers import policy_q
from rl_tui.screen.panels.q_table.q_table import QTable
from rl_tui.screen.panels.world.view import WorldView
from rl_tui.screen.theme.look import Look

_COLUMNS: Final = 9
_OF_POLICY: Final = "policy-value"
_NO_VALUE: Final = "may never end, and rewards go on without a discount: there is no value."
_EXACT: Final = "Exact: computed from the transition table."


class NumberHere(NamedTuple):
    """``name``, such as ``Q(6,↓) = .942``, ``meaning`` and ``term``."""

    name: str
    meaning: str
    term: str


def number_here(panel: Widget | None, look: Look, at: Offset | None = None) -> NumberHere | None:
    """Return the number under the cursor or at offset ``at``."""
    if not isinstance(panel, QTable | WorldView) or panel.snapshot is None:
        return None
    number = _of_table(panel, look, at) if isinstance(panel, QTable) else _of_world(panel, look, at)
    group = panel.snapshot.run_group
    if number is None or not group.lanes:
        return number
    lane = group.shown + 1
    whose = f"Run {lane} of {len(group.lanes)}: {group.lanes[group.shown].name}."
    return number._replace(name=f"{number.name} in run {lane}", meaning=f"{whose} {number.meaning}")


def _of_table(table: QTable, look: Look, at: Offset | None) -> NumberHere | None:
    pair = table.shown_cursor if at is None else table.pair_at(*at)
    if pair is None or table.snapshot is None:
        return None
    return number_of_pair(table.snapshot, pair, table.shown_layer, look)


def _of_world(view: WorldView, look: Look, at: Offset | None) -> NumberHere | None:
    place = view.cursor_place if at is None else view.place_at(*at)
    if place is None or view.snapshot is None or (at is None and view.is_manual):
        return None
    if view.world.is_bandit:
        return number_of_pair(view.snapshot, place, Layer.Q, look)
    state = view.state_at(place)
    if state is not None and view.studied is not None:
        return _number_of_policy(view.snapshot, state, view.studied, look)
    return None if state is None else number_of_state(view.snapshot, state, look, view.drawn_layer)


def number_of_pair(snapshot: Snapshot, pair: int, layer: Layer, look: Look) -> NumberHere | None:
    """Return a pair's number, if known."""
    is_known = has_estimates(snapshot) or layer in (Layer.VISITS, Layer.POLICY)
    return _Teller(snapshot, look).of_pair(pair, layer) if is_known and snapshot.agent.holds(pair) else None


def number_of_state(snapshot: Snapshot, state: int, look: Look, layer: Layer = Layer.Q) -> NumberHere | None:
    """Return a state's number (mostly V)."""
    pairs, is_known = snapshot.world.space.pairs_of(state), has_estimates(snapshot) or layer is Layer.VISITS
    held = not pairs or (is_known and snapshot.agent.holds(pairs.start))
    return _Teller(snapshot, look).of_state(state, layer) if held else None


def _number_of_policy(snapshot: Snapshot, state: int, kind: PolicyKind, look: Look) -> NumberHere:
    name = names.state_name(snapshot.world, state, look.glyphs)
    value = float(snapshot.agent.values[state])
    if math.isnan(value):
        meaning = f"From state {name} {policy_name(kind)} {_NO_VALUE}"
        return NumberHere(f"Vπ({name}): none", meaning, _OF_POLICY)
    text = number_form([value], _COLUMNS).text(value, look.glyphs)
    meaning = f"The expected discounted return of {policy_name(kind)} from state {name}. {_EXACT[:-1]}, "
    return NumberHere(f"Vπ({name}) = {text}", f"{meaning}not learned. t p compares policies.", _OF_POLICY)


class _Teller:
    def __init__(self, snapshot: Snapshot, look: Look) -> None:
        self._snapshot = snapshot
        self._world = snapshot.world
        self._look = look
        self._exact = exact_q(snapshot)
        self._is_bandit = snapshot.world.is_bandit

    def of_pair(self, pair: int, layer: Layer) -> NumberHere:
        name, deed = names.pair_name(self._world, pair, self._look.glyphs), self._deed(pair)
        q, exact = float(self._snapshot.agent.q[pair]), None if self._exact is None else self._exact[0][pair]
        done, best = f"taken {deed}", f"The largest expected discounted return of {deed}."
        whose = "The planner's value" if self._plans else "The agent's estimate"
        about = f"{whose} of the discounted return of {deed}"
        if self._is_bandit:
            done, best = "pulled this arm", "The true mean reward of this arm."
            about = "The agent's estimate of the mean reward of this arm"
        if layer is Layer.LANES and (other := other_lane(self._snapshot)) is not None:
            mine, its, gap = self._written(q, float(other.q[pair]), q - float(other.q[pair]))
            meaning = (
                f"The estimate here, {mine}, minus the estimate of {other.name}, {its}. Both are learned."
            )
            return NumberHere(f"Q({name}) − Q of {other.name} = {gap}", meaning, "q")
        if layer is Layer.POLICY and (known := policy_q(self._snapshot)) is not None:
            if math.isnan(known[0][pair]):
                return NumberHere(f"Qπ({name}): none", f"After {deed} the chosen policy {_NO_VALUE}", "q-pi")
            worth = self._written(float(known[0][pair]))[0]
            meaning = (
                f"The expected discounted return of {deed}, and of the chosen policy afterwards. {_EXACT}"
            )
            return NumberHere(f"Qπ({name}) = {worth}", meaning, "q-pi")
        return self._told("Q", name, layer, range(pair, pair + 1), (q, exact), (done, best, f"{about}, "))

    def of_state(self, state: int, layer: Layer = Layer.Q) -> NumberHere:
        pairs, q = self._world.space.pairs_of(state), self._snapshot.agent.q
        name = names.state_name(self._world, state, self._look.glyphs)
        if not pairs:
            kind = names.landmark(self._world, state) or "terminal state"
            meaning = f"A {kind}: nothing is earned after it, so its value is 0."
            return NumberHere(f"V({name}) = 0", meaning, "value")
        best = max(float(q[pair]) for pair in pairs)
        exact = None if self._exact is None else max(self._exact[0][pair] for pair in pairs)
        greedy = [pair for pair in shown_pairs(self._world, pairs) if float(q[pair]) == best]
        actions = ", ".join(self._action(pair) for pair in greedy)
        whose = f"Q of {actions}" if len(greedy) == 1 else f"{actions} are tied"
        about = (
            f"The largest of the agent's estimates Q in state {name}: {whose}. It estimates the discounted "
        )
        largest = f"The largest expected discounted return from state {name}."
        texts = f"acted in state {name}", largest, f"{about}return from there, "
        return self._told("V", name, layer, pairs, (best, exact), texts)

    def _told(
        self,
        symbol: str,
        name: str,
        layer: Layer,
        pairs: range,
        values: tuple[float, float | None],
        texts: tuple[str, str, str],
    ) -> NumberHere:
        # texts: what the agent has done, what the exact value is, what the estimate is of
        visits = int(self._snapshot.agent.visits[pairs.start : pairs.stop].sum())
        (value, exact), (done, best, about), learned = values, texts, self._learned(visits)
        estimate, optimum, error = self._written(value, exact, None if exact is None else value - exact)
        if layer is Layer.VISITS:
            meaning = f"How often the agent has {done}, counted over the run so far."
            return NumberHere(f"N({name}) = {visits:,}", meaning, "visits")
        if layer is Layer.OPTIMAL and optimum:
            meaning = f"{best} {_EXACT} The agent's estimate is {estimate}, {learned}."
            return NumberHere(f"{symbol}*({name}) = {optimum}", meaning, "q-star")
        if layer is Layer.ERROR and optimum:
            meaning = (
                f"The agent's estimate, {estimate}, minus the exact value, {optimum}: above 0 it is too high."
            )
            shown = f"{symbol}({name}) − {symbol}* = {error}"
            return NumberHere(shown, f"{meaning} The estimate is {learned}.", "error")
        meaning = f"{about}{learned}. {self._truth(optimum, symbol)}".strip()
        return NumberHere(f"{symbol}({name}) = {estimate}", meaning, "q" if symbol == "Q" else "value")

    def _written(self, *values: float | None) -> tuple[str, ...]:
        form = number_form([each for each in values if each is not None], _COLUMNS)
        return tuple("" if each is None else form.text(each, self._look.glyphs) for each in values)

    def _action(self, pair: int) -> str:
        return names.action_name(self._world, int(self._world.space.pair_action[pair]), self._look.glyphs)

    def _deed(self, pair: int) -> str:
        state = self._world.space.state_of(pair)
        return f"{self._action(pair)} in state {names.state_name(self._world, state, self._look.glyphs)}"

    @property
    def _plans(self) -> bool:
        return self._snapshot.agent.row.planner

    def _learned(self, visits: int) -> str:
        if not visits:
            return "not tried yet: still the initial estimate"
        if self._plans:
            return f"after {counted(visits, 'backup')}"
        return f"learned from {counted(visits, 'pull' if self._is_bandit else 'visit')}"

    def _truth(self, optimum: str, symbol: str) -> str:
        if optimum:
            return f"The exact {symbol}* here is {optimum}."
        if hides_means(self._snapshot):
            return f"The true mean is {SECRET}."
        if refused := self._snapshot.exact_answer.refused:
            return f"There is no exact value: {refused}"
        key = shown_by(self._snapshot)
        return f"The exact {symbol}* is hidden: {key}." if is_secret(self._snapshot) else ""
