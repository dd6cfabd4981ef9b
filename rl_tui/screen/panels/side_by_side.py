"""Two runs side by side."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Final, NamedTuple

import numpy as np

from rl_tui.agents.catalogue import OWN_PROGRAM
from rl_tui.live.snapshot import AgentView, Snapshot
from rl_tui.live.viewport import pairs_of_states
from rl_tui.runs.timeline.run_names import feature_text
from rl_tui.screen.draw import numbers
from rl_tui.screen.draw.canvas import Line, Piece
from rl_tui.screen.kit.counterparts import are_alike, are_same_size, in_common
from rl_tui.screen.kit.layers import Layer, as_layer, shown_exact
from rl_tui.screen.kit.panel import BoardPanel
from rl_tui.screen.kit.snapshot_facts import hides_greedy, studied_kind
from rl_tui.screen.panels.controls.controls import in_force, sliders_of
from rl_tui.screen.panels.policies.studied import as_studied
from rl_tui.screen.panels.program.words import name_of
from rl_tui.screen.panels.q_table.q_table import QTable
from rl_tui.screen.panels.world.view import WorldView
from rl_tui.screen.theme.look import Look
from rl_tui.worlds.editing.carried import differing_choices
from rl_tui.worlds.mdp.space import BoolArray, IntArray

DIFFERS: Final = "◤"
_TWO_DIGITS: Final = 10.0  # numbers from here on have no decimals


def sides(snapshot: Snapshot) -> tuple[Snapshot, Snapshot]:
    """Return both runs as shown ones, lower number first. Raises ValueError without a second run."""
    group, beside = snapshot.run_group, snapshot.beside
    if beside is None or group.beside is None:
        raise ValueError("only one run is shown")
    swapped = replace(group, shown=group.beside, beside=group.shown)
    other = replace(beside, run_group=swapped, beside=snapshot)
    return (snapshot, other) if group.shown < group.beside else (other, snapshot)


@dataclass(frozen=True, slots=True)
class GreedyDifferences:
    """States in which two runs have different greedy actions, ties included.

    Only states count that both have learned about. Two worlds are compared by matching cells or names.
    """

    states: frozenset[int]
    """The differing states, by their number in the left run."""
    known: int
    """The number of states that both runs know."""
    is_part: bool
    """Whether only visible states of a large world were compared."""
    right: frozenset[int]
    """The differing states, by their number in the right run."""
    is_compared: bool = True
    """Whether the worlds could be compared."""

    def words(self, lane: Snapshot) -> tuple[str, ...]:
        """Return the count as a sentence."""
        if not self.is_compared:
            return (
                "other worlds: greedy actions are not compared",
                "other worlds: not compared",
                "not compared",
            )
        if not self.known:
            return ()
        if lane.world.is_bandit:
            return (f"{DIFFERS} other greedy arms" if self.states else "the same greedy arms",)
        count, seen = f"{len(self.states)} of {self.known:,}", " in view" if self.is_part else ""
        return (
            f"{DIFFERS} greedy actions differ in {count} states{seen}",
            f"{DIFFERS} greedy differs in {count} states{seen}",
            f"{DIFFERS} differs in {count} states{seen}",
            f"{DIFFERS} differs in {count}{seen}",
        )


class Differing(NamedTuple):
    """The differing states of a run's world and of its table."""

    world: frozenset[int]
    table: frozenset[int]


def seen_differences(
    left: Snapshot, right: Snapshot, layer: Layer
) -> tuple[GreedyDifferences, GreedyDifferences]:
    """Compare the actions that worlds, and those that tables show in ``layer``."""
    table = greedy_differences(_as_seen(left, layer), _as_seen(right, layer))
    if studied_kind(left) is None and studied_kind(right) is None:
        return table, table
    return greedy_differences(as_studied(left), as_studied(right)), table


def _as_seen(lane: Snapshot, layer: Layer) -> Snapshot:
    """Put the actions that ``layer`` shows in place of the learned ones."""
    if layer is Layer.POLICY:
        return as_studied(lane)
    return as_layer(lane, layer) if layer is Layer.OPTIMAL and shown_exact(lane) is not None else lane


def name_panels(
    panels: Iterable[BoardPanel], lane: Snapshot, differing: Differing, *, is_led: bool, look: Look
) -> None:
    """Title a run's panels. ``is_led``: keys and sliders control it."""
    number = f"{look.glyphs.cursor if is_led else ''}{lane.run_group.shown + 1}"
    for panel in panels:
        panel.is_led = not is_led
        if isinstance(panel, WorldView):
            panel.lane, panel.results = lane_titles(lane, number), lane_results(lane, look)
            panel.differing = differing.world
        elif isinstance(panel, QTable):
            panel.lane, panel.differing = number, differing.table


def stand_alone(panel: BoardPanel) -> None:
    """Make it the panel of a single run."""
    panel.is_led = False
    if isinstance(panel, WorldView):
        panel.lane, panel.results, panel.note, panel.differing = (), (), (), frozenset()
    elif isinstance(panel, QTable):
        panel.lane, panel.differing = "", frozenset()


def lane_titles(lane: Snapshot, number: str) -> tuple[str, ...]:
    """Return titles, without a program's unknown settings."""
    if lane.program is not None:
        known = f" · {lane.agent.row.name}" if lane.agent.row is not OWN_PROGRAM else ""
        return f"{number} {name_of(lane.program)}{known}", f"{number} {name_of(lane.program)}"
    group, agent = lane.run_group, lane.agent
    name, algorithm = group.lanes[group.shown].name, agent.row.name
    is_bandit = lane.world.is_bandit
    settings = []
    for parameter in sliders_of(agent.algorithm, agent.hyperparameters, is_bandit=is_bandit):
        value = in_force(agent.hyperparameters, parameter)
        if parameter.name != "gamma" and f"{parameter.symbol} " not in name:
            settings.append(feature_text(parameter.name, value))
    known = "" if algorithm in name else algorithm
    forms = (" ".join(filter(None, (known, *settings))), known)
    return (*(f"{number} {name} · {form}" for form in forms if form), f"{number} {name}")


def lane_results(lane: Snapshot, look: Look) -> tuple[Line, ...]:
    """Return greedy return, return and steps."""
    results, palette = lane.results, look.palette
    own = palette.lanes[lane.run_group.shown % len(palette.lanes)]
    greedy = None if hides_greedy(lane) else results.greedy_return
    known = (
        ("greedy", greedy, palette.best),
        ("agent", results.return_last_100, own),
        ("steps", results.length_last_100, palette.text),
    )
    return tuple(
        [Piece(f"  {name:7}", palette.dim), Piece(_brief(value, look), style)]
        for name, value, style in known
        if value is not None
    )


def _brief(value: float, look: Look) -> str:
    return numbers.brief(value, look.glyphs, decimals=0 if abs(value) >= _TWO_DIGITS else 2)


def greedy_differences(left: Snapshot, right: Snapshot) -> GreedyDifferences:
    """Find the states with other greedy actions."""
    if not are_alike(left.world, right.world):
        return _differences_of_worlds(left, right)
    space = left.world.space
    states, is_part = _states_held(left, right)
    pairs = pairs_of_states(space, states)
    if not len(pairs):
        return GreedyDifferences(frozenset(), 0, is_part, frozenset())
    count = np.diff(space.first_pair)[states]
    first = np.cumsum(count) - count
    is_greedy, knows = zip(*(_greedy(lane.agent, pairs, first, count) for lane in (left, right)), strict=True)
    known = knows[0] & knows[1]
    differs = known & np.logical_or.reduceat(is_greedy[0] != is_greedy[1], first)
    found = frozenset(states[differs].tolist())
    return GreedyDifferences(found, int(known.sum()), is_part, found)


def _differences_of_worlds(left: Snapshot, right: Snapshot) -> GreedyDifferences:
    is_large = left.agent.part is not None or right.agent.part is not None
    if is_large or not are_same_size(left.world, right.world):
        return GreedyDifferences(frozenset(), 0, is_large, frozenset(), is_compared=False)
    common, choices = in_common(right.world, left.world), []
    for lane in (left, right):
        space = lane.world.space
        states = np.flatnonzero(np.diff(space.first_pair))
        count = np.diff(space.first_pair)[states]
        is_greedy, knows = _greedy(lane.agent, np.arange(space.pairs), space.first_pair[states], count)
        known = np.zeros(space.states, dtype=np.bool_)
        known[states] = knows
        choices.append((space, is_greedy, known))
    (was, was_greedy, was_known), (now, is_greedy, is_known) = choices
    known = is_known & np.append(was_known, False)[common.states]
    differs = known & differing_choices((was, was_greedy), (now, is_greedy), common)
    found = frozenset(common.states[differs].tolist())
    return GreedyDifferences(found, int(known.sum()), False, frozenset(np.flatnonzero(differs).tolist()))


def _states_held(left: Snapshot, right: Snapshot) -> tuple[IntArray, bool]:
    """Return the states in both snapshots, and whether they are only a part."""
    first = left.world.space.first_pair
    parts = [each.agent.part for each in (left, right)]
    if parts[0] is None or parts[1] is None:
        return np.flatnonzero(np.diff(first)), False
    pairs = np.unique(parts[0].pairs)
    pairs = pairs[parts[1].held[pairs]]
    states, held = np.unique(np.searchsorted(first, pairs, side="right") - 1, return_counts=True)
    return states[held == first[states + 1] - first[states]], True


def _greedy(
    agent: AgentView, pairs: IntArray, first: IntArray, count: IntArray
) -> tuple[BoolArray, BoolArray]:
    """Return which ``pairs`` are greedy, and which states are known.

    A policy kept by policy iteration counts as greedy, as on the map.
    """
    q = agent.q[pairs]
    best = np.maximum.reduceat(q, first)
    knows = (np.maximum.reduceat(agent.visits[pairs], first) > 0) | (best != np.minimum.reduceat(q, first))
    if len(agent.policy):  # Q may be unknown, if the policy may never end
        return agent.policy[pairs] > 0.0, knows
    knows &= ~np.isnan(best)  # unknown for a program without a table
    return q == np.repeat(best, count), knows
