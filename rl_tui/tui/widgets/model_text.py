"""The model in words: ⟨S, A, P, R, γ⟩ (Sutton & Barto, 2nd ed., section 3.1) and one pair in full."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from rich.cells import cell_len

from rl_tui.lab.snapshot import Snapshot
from rl_tui.tui import numbers
from rl_tui.tui.theme.look import Look
from rl_tui.tui.widgets import names
from rl_tui.tui.widgets.bellman import SECRET, bellman_lines
from rl_tui.tui.widgets.pieces import Line, Piece, wrapped
from rl_tui.tui.widgets.update_text import setting
from rl_tui.tui.written import written
from rl_tui.worlds.drawing import Arms
from rl_tui.worlds.mdp import UNKNOWN_ACTION

HIDDEN: Final = "···"
_LABEL: Final = 8


def is_secret(snapshot: Snapshot, *, revealed: bool) -> bool:
    """Tell whether true rewards must not be told: a bandit's, until ``revealed``."""
    return isinstance(snapshot.world.drawing, Arms) and not revealed


def model_lines(snapshot: Snapshot, look: Look, width: int, *, revealed: bool) -> list[Line]:
    """Return the five parts, the start and the end of episodes."""
    mdp, glyphs = snapshot.world.space, look.glyphs
    others = np.flatnonzero(np.diff(mdp.first_pair) == 0).tolist()
    actors = f", {mdp.states - len(others)} with actions" if others else ""
    room = width - _LABEL - 1
    parts = [
        ("S", f"{_count(mdp.states, 'state')}{actors}: {_listed(mdp.state_names, room, look)}"),
        ("A", f"{_count(len(mdp.action_names), 'action')}: {_listed(_actions(snapshot, look), room, look)}"),
        ("P", f"{_count(mdp.pairs, 'legal pair')} (s, a), {_count(len(mdp.next_state), 'outcome')}"),
        ("R", _rewards(snapshot, look, revealed=revealed)),
        ("γ", setting(snapshot.hyperparameters.gamma, glyphs)),
        ("start", _start(snapshot, look, room)),
        ("end", _end(snapshot, others, look, room)),
    ]
    lines: list[Line] = []
    for label, text in parts:
        lines += _labelled(label, text, look, width)
    return lines


def pair_lines(snapshot: Snapshot, pair: int, look: Look, width: int, *, revealed: bool) -> list[Line]:
    """Return the outcomes of ``pair`` and its Bellman optimality equation with numbers put in."""
    world, mdp, palette, glyphs = snapshot.world, snapshot.world.space, look.palette, look.glyphs
    state, action = int(mdp.pair_state[pair]), int(mdp.pair_action[pair])
    secret = is_secret(snapshot, revealed=revealed)
    head: list[Piece] = [
        Piece(" state ", palette.dim),
        Piece(mdp.state_names[state], palette.strong),
        *([Piece(f" ({place})", palette.dim)] if (place := names.place(world, state)) else []),
        Piece("   action ", palette.dim),
        Piece(_action(snapshot, action, look), palette.strong),
        Piece(f"   pair {pair + 1:,} of {mdp.pairs:,}", palette.dim),
    ]
    taken = int(snapshot.visits[pair])
    learned = numbers.value(float(snapshot.q[pair]), 7, glyphs) if taken else "not yet visited"
    estimate: Line = [
        Piece(f" learned Q({names.pair_name(world, pair, glyphs)}) = ", palette.dim),
        Piece(learned, palette.text),
        Piece(f", taken {taken:,} time{'' if taken == 1 else 's'}" if taken else "", palette.dim),
    ]
    return [
        head,
        *_outcomes(snapshot, pair, look, secret=secret),
        estimate,
        [Piece("", palette.text)],
        *bellman_lines(snapshot, pair, look, width, secret=secret),
    ]


def _outcomes(snapshot: Snapshot, pair: int, look: Look, *, secret: bool) -> list[Line]:
    """Return a table: probability, what happened where the world slips, reward, next state."""
    world, mdp, palette, glyphs = snapshot.world, snapshot.world.space, look.palette, look.glyphs
    meant = int(mdp.pair_action[pair])
    slips = any(mdp.outcome_action[each] not in (UNKNOWN_ACTION, meant) for each in mdp.outcomes_of(pair))
    rows = []
    for outcome in mdp.outcomes_of(pair):
        next_state = int(mdp.next_state[outcome])
        happened = int(mdp.outcome_action[outcome])
        landing = names.state_name(world, next_state, glyphs)
        if landmark := names.landmark(world, next_state):
            landing += f": {landmark}"
        rows.append(
            (
                names.chance(float(mdp.probability[outcome]), glyphs),
                (names.action_name(world, happened, glyphs) if happened != UNKNOWN_ACTION else "?")
                if slips
                else "",
                HIDDEN if secret else numbers.brief(float(mdp.reward[outcome]), glyphs, decimals=4),
                landing,
                "ends" if mdp.terminated[outcome] else "",
            )
        )
    noise = float(mdp.reward_std[mdp.first_outcome[pair]])
    heads = ("p", "went" if slips else "", "r", "s′", "")
    spelled = [tuple(written(cell, glyphs) for cell in row) for row in (heads, *rows)]
    widths = [max(cell_len(row[column]) for row in spelled) for column in range(len(heads))]
    lines: list[Line] = []
    for number, row in enumerate(spelled):
        style = palette.text if number else palette.dim
        cells = [
            Piece(f"   {cell}{' ' * (columns - cell_len(cell))}", palette.accent if cell == "ends" else style)
            for cell, columns in zip(row, widths, strict=True)
            if columns
        ]
        if number and noise > 0.0:
            cells.append(Piece(f"   r ± {numbers.brief(noise, glyphs, decimals=3)} (normal)", palette.dim))
        lines.append(cells)
    return lines


def _rewards(snapshot: Snapshot, look: Look, *, revealed: bool) -> str:
    mdp, glyphs = snapshot.world.space, look.glyphs
    noise = float(mdp.reward_std.max())
    noisy = f", normally distributed around their mean (standard deviation {numbers.brief(noise, glyphs)})"
    if is_secret(snapshot, revealed=revealed):
        return f"{SECRET}{noisy if noise else ''}"
    low, high = (
        numbers.brief(float(each), glyphs, decimals=3) for each in (mdp.reward.min(), mdp.reward.max())
    )
    text = f"always {low}" if low == high else f"from {low} to {high}"
    return text + (noisy if noise else "")


def _start(snapshot: Snapshot, look: Look, room: int) -> str:
    mdp, glyphs = snapshot.world.space, look.glyphs
    if len(mdp.start_state) == 1:
        state = int(mdp.start_state[0])
        place = names.place(snapshot.world, state)
        return mdp.state_names[state] + (f" ({place})" if place else "")
    chances = [
        f"{names.state_name(snapshot.world, int(state), glyphs)} with {names.chance(float(p), glyphs)}"
        for state, p in zip(mdp.start_state[:20], mdp.start_probability[:20], strict=True)
    ]
    more = ["…"] if len(mdp.start_state) > 20 else []
    return _listed([*chances, *more], room, look)


def _end(snapshot: Snapshot, others: Sequence[int], look: Look, room: int) -> str:
    mdp, glyphs = snapshot.world.space, look.glyphs
    if isinstance(snapshot.world.drawing, Arms):
        return "every pull is an episode of its own"
    reached = set(mdp.next_state[mdp.terminated].tolist())
    terminal = [names.state_name(snapshot.world, state, glyphs) for state in others if state in reached]
    text = (
        f"terminal {_listed(terminal, room, look)}: nothing follows an outcome that ends there, worth 0"
        if terminal
        else "no state is terminal"
    )
    if mdp.time_limit:
        text += (
            f"; after {mdp.time_limit:,} steps the time limit cuts the episode off, which is no end: "
            "the last step still bootstraps"
        )
    return text


def _actions(snapshot: Snapshot, look: Look) -> list[str]:
    return [_action(snapshot, action, look) for action in range(len(snapshot.world.space.action_names))]


def _action(snapshot: Snapshot, action: int, look: Look) -> str:
    """Return the arrow and the name of ``action``, or its name alone."""
    name = snapshot.world.space.action_names[action]
    arrow = names.action_name(snapshot.world, action, look.glyphs)
    return f"{arrow} {name}" if len(arrow) == 1 and arrow != name else name


def _listed(items: Sequence[str], room: int, look: Look) -> str:
    """Return ``items`` separated by commas; the first ones and the last if they take more than two lines."""
    shown: list[str] = []
    taken = 0
    for number, item in enumerate(items):
        taken += cell_len(written(item, look.glyphs)) + 2
        if taken > 2 * room - 30 and number < len(items) - 1:
            return ", ".join([*shown, look.glyphs.ellipsis, items[-1]])
        shown.append(item)
    return ", ".join(shown)


def _labelled(label: str, text: str, look: Look, width: int) -> list[Line]:
    palette = look.palette
    spelled = written(label, look.glyphs)
    lines: list[Line] = []
    for number, line in enumerate(wrapped(text, max(1, width - _LABEL - 1), palette.text, look)):
        lines.append([Piece(f" {spelled if number == 0 else '':<{_LABEL}}", palette.accent), *line])
    return lines


def _count(number: int, noun: str) -> str:
    return f"{number:,} {noun}{'' if number == 1 else 's'}"
