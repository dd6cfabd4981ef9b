"""The report of ``evaluate``."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

import numpy as np

from rl_tui.agents.exact.policy_figures import best_pairs
from rl_tui.commands.line.output import can_print, columns, number
from rl_tui.commands.reports.policy_map import is_drawn, policy_map
from rl_tui.common.words import counted
from rl_tui.runs.figures import policy_names, table
from rl_tui.screen.draw.action_order import shown_order
from rl_tui.worlds.mdp.space import FloatArray
from rl_tui.worlds.world import World

CHANCE_TO_END: Final = "chance to end"
MOST_ROWS: Final = 1_000
_EQUAL: Final = 1e-12


def evaluation(title: str, world: World, policy: FloatArray, answer: Mapping[str, Any]) -> str:
    """Return the report on `policy`, [P]. `answer` is the document of ``evaluate --json``."""
    space = world.space
    chosen = best_pairs(space, policy, _EQUAL)
    parts = [_head(title, answer), "", _values(world, policy, answer["V"]), ""]
    if is_drawn(world) and not chosen.all():
        mixed = bool((np.where(chosen, 0.0, policy) > 0.0).any())
        parts += ["likeliest actions"] if mixed else []
        parts += [policy_map(world, policy_names(space, chosen.astype(float))), ""]
    parts.append(columns(_summary(space.time_limit, answer)))
    if answer["not_given"] == np.count_nonzero(np.diff(space.first_pair)):
        parts += ["", "The file has no action for any state: this is the random policy."]
    elif answer["not_given"]:
        states = counted(answer["not_given"], "state")
        parts += ["", f"The file has no action for {states}: the policy is random there."]
    return "\n".join(parts)


def _head(title: str, answer: Mapping[str, Any]) -> str:
    mixed = f", a random action with probability {answer['epsilon']:.12g}" if answer["epsilon"] else ""
    return f"{title}: policy {answer['policy']}{mixed}, exact"


def _values(world: World, policy: FloatArray, values: Mapping[str, float | None]) -> str:
    order, names = shown_order(world), world.space.action_names
    chances = table(world.space, policy)
    pi = "π" if can_print("π") else "pi"
    rows = [("state", "V", *(f"{pi} {names[action]}" for action in order))]
    for row, (state, value) in zip(chances[:MOST_ROWS], values.items(), strict=False):
        shown = ("" if row[action] is None else number(row[action], ".4g") for action in order)
        rows.append((state, number(value, ".5f"), *shown))
    more = f"\n... and {len(chances) - MOST_ROWS:,} more: --json has all" if len(chances) > MOST_ROWS else ""
    return columns(rows, right=range(1, len(rows[0]))) + more


def _summary(limit: int, answer: Mapping[str, Any]) -> list[tuple[str, str, str]]:
    within = f", within {counted(limit, 'step')}" if limit else ""
    ends = number(answer["ends"])
    rows = [
        ("value at the start", number(answer["value_at_start"], ".5f"), f"discounted, γ {answer['gamma']:g}"),
        ("expected return", number(answer["expected_return"], ".5f"), f"undiscounted{within}"),
        ("steps of an episode", number(answer["steps"], ".5f"), f"expected{within}"),
    ]
    if ends != number(1.0):
        rows.append((CHANCE_TO_END, ends, within.removeprefix(", ")))
    return rows
