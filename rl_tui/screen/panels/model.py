"""The model of a scenario, ⟨S, A, P, R, γ⟩, and one pair in full.

The notation follows Sutton & Barto, 2nd ed., section 3.1; a pair's equation is 3.20.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import lru_cache
from typing import ClassVar, Final

import numpy as np
from rich.cells import cell_len
from textual.binding import BindingType

from rl_tui.agents.exact.policy_evaluation import Solution
from rl_tui.common.words import counted
from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.draw import names, numbers
from rl_tui.screen.draw.action_order import shown_order, shown_outcomes, shown_pairs, shown_place
from rl_tui.screen.draw.canvas import KEPT_BLANK as K
from rl_tui.screen.draw.canvas import Piece
from rl_tui.screen.draw.precision import column_figure, in_brackets, leading_zeros
from rl_tui.screen.kit.bindings import binding
from rl_tui.screen.kit.blocks import BLANK, Block, Column, Labelled, Row, Table, Text
from rl_tui.screen.kit.pointing import NOWHERE, Pointed
from rl_tui.screen.kit.scrolling import Scrolled, ScrolledPanel, page_bindings
from rl_tui.screen.kit.snapshot_facts import (
    ANSWER_KEPT,
    BEING_BUILT,
    answer_key,
    has_estimates,
    hides_means,
    is_secret,
    keeps_back,
    reward_range,
)
from rl_tui.screen.panels.last_step.update_text import setting
from rl_tui.screen.theme.look import Look
from rl_tui.worlds.mdp.space import FiniteSpace, IntArray
from rl_tui.worlds.mdp.tabular_mdp import UNKNOWN_ACTION, TabularMDP
from rl_tui.worlds.world import World

# One pair


UNKNOWN: Final = "no transition table (simulated only)"
HIDDEN: Final = "···"
SECRET: Final = "hidden until w h or the end of the budget"
_DECIMALS: Final = 4
_EQUALS: Final = "   = "
_CONTINUED: Final = "     "


def pair_blocks(snapshot: Snapshot, pair: int, look: Look) -> Iterator[Block]:
    """Yield name, outcomes, estimate and equation."""
    world, palette, glyphs = snapshot.world, look.palette, look.glyphs
    state, action = world.space.state_of(pair), int(world.space.pair_action[pair])
    pairs, place = world.space.pairs_of(state), names.place(world, state)
    number = 1 + pairs.start + shown_pairs(world, pairs).index(pair)
    yield Row(
        [
            Piece(" state ", palette.dim),
            Piece(names.with_minus(world.space.state_names[state], glyphs), palette.strong),
            Piece("   action ", palette.dim),
            Piece(action_text(world, action, look), palette.strong),
            Piece(f"   {place}" if place else "", palette.dim),
            Piece(f"   pair {number:,} of {world.space.pairs:,}", palette.dim),
        ]
    )
    if world.mdp is not None:
        yield _outcomes(world, world.mdp, pair, look, secret=hides_means(snapshot))
    elif world.prospects:
        yield from _prospects(world, pair, look)
    else:
        yield Row([Piece(f"   {UNKNOWN}", palette.dim)])
    taken = int(snapshot.agent.visits[pair])
    yield Row(
        [
            Piece(f" learned Q({names.pair_name(world, pair, glyphs)}) = ", palette.dim),
            Piece(_learned(snapshot, pair, taken, look), palette.text),
            Piece(f", taken {counted(taken, 'time')}" if taken else "", palette.dim),
        ]
    )
    yield BLANK
    yield from _bellman_blocks(snapshot, pair, look)


def action_text(world: World, action: int, look: Look) -> str:
    """Return an action's arrow and name."""
    name = world.space.action_names[action]
    arrow = names.action_name(world, action, look.glyphs)
    return f"{arrow} {name}" if names.is_direction(world, action) and arrow != name else name


def _learned(snapshot: Snapshot, pair: int, taken: int, look: Look) -> str:
    if not snapshot.agent.holds(pair):  # the next snapshot of a large world will have it
        return look.glyphs.ellipsis
    if not taken:
        return "not yet visited"
    if not has_estimates(snapshot):
        return "unknown: no table was found in your program"
    x, mdp, exact = float(snapshot.agent.q[pair]), snapshot.world.mdp, snapshot.exact_answer.solution
    if mdp is None or exact is None or is_secret(snapshot) or not math.isfinite(x):
        return numbers.value(x, 7, look.glyphs)
    return column_figure(x, decimals_of(mdp, exact, pair), look.glyphs)


def _outcomes(world: World, mdp: TabularMDP, pair: int, look: Look, *, secret: bool) -> Table:
    glyphs, outcomes = look.glyphs, shown_outcomes(world, mdp, pair)
    happened = [int(mdp.outcome_action[each]) for each in outcomes]
    slips = any(each not in (UNKNOWN_ACTION, int(mdp.pair_action[pair])) for each in happened)
    went = ["?" if each == UNKNOWN_ACTION else names.action_name(world, each, glyphs) for each in happened]
    rewards = [numbers.brief(float(mdp.reward[each]), glyphs, decimals=4) for each in outcomes]
    landings = [
        ": ".join(filter(None, (names.state_name(world, each, glyphs), names.landmark(world, each))))
        for each in map(int, mdp.next_state[outcomes])
    ]
    noise = float(mdp.reward_std[mdp.first_outcome[pair]])
    said = f"r ± {numbers.brief(noise, glyphs, decimals=3)} (normal)" if noise else ""
    columns = {
        "p": [names.chance(float(mdp.probability[each]), glyphs) for each in outcomes],
        "went": went if slips else [],
        "r at the start" if mdp.drift_std else "r": [HIDDEN] * len(outcomes) if secret else rewards,
        "s′": landings,
    }
    return _table(columns, [bool(mdp.terminated[each]) for each in outcomes], look, said)


def _prospects(world: World, pair: int, look: Look) -> Iterator[Block]:
    glyphs, prospects = look.glyphs, world.prospects[pair]
    known = [" or ".join(numbers.brief(r, glyphs, decimals=4) for r in each.rewards) for each in prospects]
    depends = [f" {names.DEPENDS}" if len(each.rewards) > 1 else "" for each in prospects]
    columns = {
        "p": [
            names.DEPENDS if each.probability is None else names.chance(each.probability, glyphs)
            for each in prospects
        ],
        "r": [reward + remark for reward, remark in zip(known, depends, strict=True)],
        "s′": [names.state_name(world, each.next_state, glyphs) for each in prospects],
    }
    yield _table(columns, [not world.space.pairs_of(each.next_state) for each in prospects], look)
    if any(depends) or any(each.probability is None for each in prospects):
        yield Row([Piece(f"   {names.DEPENDS} {names.DEPENDS_IN_FULL}", look.palette.dim)])


def _table(columns: Mapping[str, Sequence[str]], ends: Sequence[bool], look: Look, remark: str = "") -> Table:
    text, ended = look.palette.text, Piece("ends", look.palette.strong)
    parts = [Column(head, cells, text, head[0] in "pr", 3) for head, cells in columns.items() if cells]
    if any(ends):
        parts.append(Column("", [ended if each else "" for each in ends], text, right=False, gap=3))
    if remark:
        parts.append(Column("", [remark] * len(ends), look.palette.dim, right=False, gap=3))
    return Table([parts])


# The Bellman optimality equation


def _bellman_blocks(snapshot: Snapshot, pair: int, look: Look) -> Iterator[Block]:
    palette = look.palette
    name = names.pair_name(snapshot.world, pair, look.glyphs)
    total = "sum of" if look.glyphs.name == "ascii" else "Σ"
    symbols = f"Q*({name}) = {total} p · [r{K}+{K}γ{K}·{K}max{K}Q*(s′,·)]"
    yield Text(symbols, palette.strong, rest=_CONTINUED)
    mdp, exact = snapshot.world.mdp, snapshot.exact_answer
    if is_secret(snapshot):
        hidden = means_key(snapshot)[0] if hides_means(snapshot) else answer_key(snapshot)
        yield Text(hidden, palette.dim, f"{_EQUALS}··· ", _CONTINUED)
    elif exact.solution is None or mdp is None:
        why = exact.refused or "the exact values are being computed"
        yield Text(why, palette.dim, _CONTINUED, _CONTINUED)
    else:
        decimals = decimals_of(mdp, exact.solution, pair)
        terms = _terms(mdp, exact.solution, shown_outcomes(snapshot.world, mdp, pair), look, decimals)
        text = "the current means" if mdp.drift_std else " + ".join(terms)
        yield Text(text, palette.text, _EQUALS, _CONTINUED)
        result = column_figure(float(exact.solution.q[pair]), decimals, look.glyphs)
        yield Row([Piece(_EQUALS, palette.text), Piece(result, palette.strong)])


def means_key(snapshot: Snapshot) -> tuple[str, ...]:
    """Return a text in place of hidden means."""
    if not hides_means(snapshot):
        return ()
    return (ANSWER_KEPT,) if keeps_back(snapshot, "answer") else (SECRET, "hidden until w h")


def decimals_of(mdp: TabularMDP, exact: Solution, pair: int) -> int:
    """Return at least four decimals."""
    values = [float(exact.v[mdp.next_state[outcome]]) for outcome in mdp.outcomes_of(pair)]
    return _DECIMALS + max(0, leading_zeros(float(exact.q[pair]), *values) - 1)


def _terms(mdp: TabularMDP, exact: Solution, outcomes: list[int], look: Look, decimals: int) -> list[str]:
    glyphs = look.glyphs
    terms = []
    for outcome in outcomes:
        reward = numbers.brief(float(mdp.reward[outcome]), glyphs, decimals=_DECIMALS)
        target = reward
        if not mdp.terminated[outcome]:
            value = column_figure(float(exact.v[mdp.next_state[outcome]]), decimals, glyphs)
            target = f"{reward} + {setting(exact.gamma, glyphs)}{glyphs.times}{in_brackets(value, glyphs)}"
        chance = names.chance(float(mdp.probability[outcome]), glyphs)
        terms.append(f"{chance}{glyphs.times}[{target}]".replace(" ", K))
    return terms


# The model in words


ALIKE: Final = "none: the agent cannot tell some states apart (not Markov)"
_MOST_STARTS: Final = 20
_MANY_NAMES: Final = 100  # two lines never hold more
_LABEL: Final = 7


def model_blocks(snapshot: Snapshot, look: Look, *, is_brief: bool = False) -> Iterator[Block]:
    """Yield the model. ``is_brief``: states and actions without names."""
    world, space, mdp = snapshot.world, snapshot.world.space, snapshot.world.mdp
    others = _without_pairs(space)
    actors = f"; {space.states - len(others):,} with actions" if len(others) else ""
    actions = [action_text(world, action, look) for action in shown_order(world)]
    pairs = counted(space.pairs, "pair" if is_brief else "state–action pair")
    reason = ALIKE if world.prospects else UNKNOWN

    def listed(noun: str, items: Sequence[str], room: int) -> str:
        return counted(len(items), noun) + ("" if is_brief else f": {_listed(items, room, look)}")

    parts: dict[str, str | Callable[[int], str]] = {
        "S": lambda room: listed("state", space.state_names, room) + actors,
        "A": lambda room: listed("action", actions, room),
        "P": f"{reason}; {pairs}" if mdp is None else f"{pairs}, {counted(len(mdp.next_state), 'outcome')}",
        "R": reason if mdp is None else _rewards(snapshot, mdp, look),
        "γ": setting(snapshot.agent.hyperparameters.gamma, look.glyphs),
        "start": "drawn by the environment" if mdp is None else lambda room: _start(world, mdp, look, room),
        "end": f"where the environment says so{_time_limit(space)}"
        if mdp is None
        else lambda room: _end(world, mdp, look, room),
    }
    for label, text in parts.items():
        yield Labelled(label, look.palette.strong, _LABEL, Text(text, look.palette.text, "", ""))


# Questions about every state are answered once per world, not in every frame
@lru_cache(maxsize=1)
def _without_pairs(space: FiniteSpace) -> IntArray:
    return np.flatnonzero(np.diff(space.first_pair) == 0)


@lru_cache(maxsize=1)
def _terminal(mdp: TabularMDP) -> IntArray:
    return np.intersect1d(mdp.next_state[mdp.terminated], _without_pairs(mdp))


def _rewards(snapshot: Snapshot, mdp: TabularMDP, look: Look) -> str:
    glyphs = look.glyphs
    rewards, drift = reward_range(mdp), mdp.drift_std
    known = ""
    if rewards.noise:
        deviation = numbers.brief(rewards.noise, glyphs)
        known = f", normally distributed around their mean (standard deviation {deviation})"
    if drift:
        known += f"; after every step each mean moves by a random step of standard deviation {drift:g}"
    if hides_means(snapshot):
        return means_key(snapshot)[0] + known
    low, high = (numbers.brief(each, glyphs, decimals=3) for each in (rewards.low, rewards.high))
    text = f"always {low}" if low == high else f"from {low} to {high}"
    return f"{text}{' at the start' if drift else ''}{known}"


def _start(world: World, mdp: TabularMDP, look: Look, room: int) -> str:
    if len(mdp.start_state) == 1:
        state = int(mdp.start_state[0])
        name, place = names.with_minus(mdp.state_names[state], look.glyphs), names.place(world, state)
        return f"{name} ({place})" if place and len(f"{name} ({place})") <= room else name
    chances = [
        f"{names.state_name(world, int(state), look.glyphs)} with {names.chance(float(p), look.glyphs)}"
        for state, p in zip(mdp.start_state[:_MOST_STARTS], mdp.start_probability[:_MOST_STARTS], strict=True)
    ]
    return _listed(chances, room, look, has_more=len(mdp.start_state) > _MOST_STARTS)


def _end(world: World, mdp: TabularMDP, look: Look, room: int) -> str:
    if world.is_bandit:
        return "every pull is an episode of its own"
    reached = _terminal(mdp)
    listed = [*reached[:_MANY_NAMES], *reached[_MANY_NAMES:][-1:]]
    terminal = [names.state_name(world, int(state), look.glyphs) for state in listed]
    text = f"terminal {_listed(terminal, room, look)}, of value 0" if terminal else "no state is terminal"
    return text + _time_limit(mdp)


def _time_limit(space: FiniteSpace) -> str:
    truncated = f"; truncated after {space.time_limit:,} steps: the last one still bootstraps"
    return truncated if space.time_limit else ""


def _listed(items: Sequence[str], room: int, look: Look, *, has_more: bool = False) -> str:
    """List items in two lines, with the first and, unless it ``has_more``, the last.

    Semicolons separate names that contain commas.
    """
    between = "; " if any("," in item for item in items[:1]) else ", "
    shown: list[str] = []
    taken = 0
    for number, item in enumerate(items):
        taken += cell_len(look.glyphs.spelled(item)) + 2
        if taken > 2 * room - 30 and number < len(items) - 1:
            return between.join([*shown, look.glyphs.ellipsis, *([] if has_more else items[-1:])])
        shown.append(item)
    return between.join([*shown, *([look.glyphs.ellipsis] if has_more else [])])


class ModelPanel(ScrolledPanel):
    """⟨S, A, P, R, γ⟩ above one pair."""

    BINDINGS: ClassVar[list[BindingType]] = [
        *page_bindings("model"),
        binding("up", "move_state(-1)", "model.up", "Previous state"),
        binding("down", "move_state(1)", "model.down", "Next state"),
        binding("left", "move_action(-1)", "model.left", "Previous action"),
        binding("right", "move_action(1)", "model.right", "Next action"),
    ]
    title = "Model"
    pair: int | None = None
    """The displayed pair, None before the first picture."""

    def show(self, snapshot: Snapshot) -> None:
        """Draw ``snapshot``, at first with the last step's pair."""
        if self.pair is None or self.pair >= snapshot.world.space.pairs:
            self.pair = _last_pair(snapshot)
        super().show(snapshot)

    def show_pair(self, pair: int | None) -> None:
        """Show ``pair``, or later the last step's."""
        self.pair = pair
        if pair is None or self.snapshot is None:
            return
        self.redraw()
        if self.is_attached:
            self.post_message(Pointed(self, range(pair, pair + 1)))
            if not self.snapshot.agent.holds(pair):
                self.post_message(Scrolled())

    def point_at(self, pairs: range) -> None:
        """Show the first of ``pairs``."""
        if pairs and self.pair not in pairs and self.display:
            self.show_pair(pairs.start)

    def subject_in(self, snapshot: Snapshot) -> range:
        """Return the shown pair."""
        return NOWHERE if self.pair is None else range(self.pair, self.pair + 1)

    def blocks(self, snapshot: Snapshot | None, left_out: int) -> Iterator[Block]:
        """Yield pair and model, without lists if short of space."""
        if snapshot is None or self.pair is None:
            yield Text(BEING_BUILT, self.look.palette.dim)
            return
        yield from pair_blocks(snapshot, self.pair, self.look)
        yield BLANK
        yield from model_blocks(snapshot, self.look, is_brief=bool(left_out))

    def hints(self, snapshot: Snapshot | None, *, is_scrolled: bool) -> Sequence[str]:
        """Return forms of the keys."""
        pair, close = "↑ ↓: state   ← →: action", "esc: close"
        rest = f"pgup pgdn: scroll   {close}" if is_scrolled else close
        return f"{pair}   {rest}", rest, close

    def action_move_state(self, step: int) -> None:
        """Go to the next state, with the same action if possible."""
        if self.snapshot is None or self.pair is None:
            return
        world, space = self.snapshot.world, self.snapshot.world.space
        place = shown_place(world, int(space.pair_action[self.pair]))
        state = space.state_of(self.pair) + step
        while 0 <= state < space.states and not len(space.pairs_of(state)):
            state += step
        if 0 <= state < space.states:
            pairs = shown_pairs(world, space.pairs_of(state))
            self.show_pair(
                min(pairs, key=lambda pair: abs(shown_place(world, int(space.pair_action[pair])) - place))
            )

    def action_move_action(self, step: int) -> None:
        """Go to another action of the state."""
        if self.snapshot is None or self.pair is None:
            return
        space = self.snapshot.world.space
        pairs = shown_pairs(self.snapshot.world, space.pairs_of(space.state_of(self.pair)))
        place = pairs.index(self.pair) + step
        if 0 <= place < len(pairs):
            self.show_pair(pairs[place])


def _last_pair(snapshot: Snapshot) -> int:
    last, world = snapshot.counters.last_step, snapshot.world
    if last is not None and (last.learned or not last.planned):
        return last.updated_pair if last.planned else last.pair
    start = snapshot.counters.state if world.mdp is None else int(world.mdp.start_state[0])
    pairs = world.space.pairs_of(start)
    return shown_pairs(world, pairs)[0] if pairs else world.space.pairs - 1
