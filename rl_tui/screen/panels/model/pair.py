"""One pair of a model, with its Bellman optimality equation in numbers.

The equation is 3.20 of Sutton & Barto, 2nd ed.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Final

from rl_tui.agents.exact.policy_evaluation import Solution
from rl_tui.common.words import counted
from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.draw import names, numbers
from rl_tui.screen.draw.action_order import shown_outcomes, shown_pairs
from rl_tui.screen.draw.canvas import KEPT_BLANK as K
from rl_tui.screen.draw.canvas import Piece
from rl_tui.screen.draw.precision import column_figure, in_brackets, leading_zeros
from rl_tui.screen.kit.blocks import BLANK, Block, Column, Row, Table, Text
from rl_tui.screen.kit.snapshot_facts import (
    ANSWER_KEPT,
    answer_key,
    has_estimates,
    hides_means,
    is_secret,
    keeps_back,
)
from rl_tui.screen.panels.last_step.update_text import setting
from rl_tui.screen.theme.look import Look
from rl_tui.worlds.mdp.tabular_mdp import UNKNOWN_ACTION, TabularMDP
from rl_tui.worlds.world import World

UNKNOWN: Final = "no transition table (simulated only)"
HIDDEN: Final = "···"
SECRET: Final = "hidden until w h or the end of the budget"
_DECIMALS: Final = 4
_EQUALS: Final = "   = "
_CONTINUED: Final = "     "


def pair_blocks(snapshot: Snapshot, pair: int, look: Look) -> Iterator[Block]:
    """Yield the pair's name, outcomes, estimate and equation."""
    world, palette, glyphs = snapshot.world, look.palette, look.glyphs
    state, action = world.space.state_of(pair), int(world.space.pair_action[pair])
    pairs, place = world.space.pairs_of(state), names.place(world, state)
    number = 1 + pairs.start + shown_pairs(world, pairs).index(pair)
    yield Row(
        [
            Piece(" state ", palette.dim),
            Piece(names.with_minus(world.space.state_names[state], glyphs), palette.strong),
            Piece(f" ({place})" if place else "", palette.dim),
            Piece("   action ", palette.dim),
            Piece(action_text(world, action, look), palette.strong),
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
    yield from bellman_blocks(snapshot, pair, look)


def action_text(world: World, action: int, look: Look) -> str:
    """Return arrow and name of ``action``."""
    name = world.space.action_names[action]
    arrow = names.action_name(world, action, look.glyphs)
    return f"{arrow} {name}" if names.is_direction(world, action) and arrow != name else name


def _learned(snapshot: Snapshot, pair: int, taken: int, look: Look) -> str:
    """Return the estimate, with decimals like the exact value."""
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


# The outcomes


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
    """Yield outcomes that depend on the history, as far as known."""
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


def bellman_blocks(snapshot: Snapshot, pair: int, look: Look) -> Iterator[Block]:
    """Yield Q*(s,a) = Σ p [r + γ max Q*(s′,·)] in symbols and numbers."""
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
        why = exact.refused or "the exact answer is being computed"
        yield Text(why, palette.dim, _CONTINUED, _CONTINUED)
    else:
        decimals = decimals_of(mdp, exact.solution, pair)
        terms = _terms(mdp, exact.solution, shown_outcomes(snapshot.world, mdp, pair), look, decimals)
        text = "the current means" if mdp.drift_std else " + ".join(terms)
        yield Text(text, palette.text, _EQUALS, _CONTINUED)
        result = column_figure(float(exact.solution.q[pair]), decimals, look.glyphs)
        yield Row([Piece(_EQUALS, palette.text), Piece(result, palette.strong)])


def means_key(snapshot: Snapshot) -> tuple[str, ...]:
    """Return forms of a text in place of hidden means."""
    if not hides_means(snapshot):
        return ()
    return (ANSWER_KEPT,) if keeps_back(snapshot, "answer") else (SECRET, "hidden until w h")


def decimals_of(mdp: TabularMDP, exact: Solution, pair: int) -> int:
    """Return four decimals, or more for small values."""
    values = [float(exact.v[mdp.next_state[outcome]]) for outcome in mdp.outcomes_of(pair)]
    return _DECIMALS + max(0, leading_zeros(float(exact.q[pair]), *values) - 1)


def _terms(mdp: TabularMDP, exact: Solution, outcomes: list[int], look: Look, decimals: int) -> list[str]:
    """Return ``1/3·[0 + .99·.5420]`` for each of ``outcomes``."""
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
