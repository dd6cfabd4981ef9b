"""The tools for graphs, a row each."""

from __future__ import annotations

from typing import Final

from rl_tui.tui.screens.playground.actions.modes.editing.rules import ask_rules
from rl_tui.tui.screens.playground.actions.modes.editing.tools import Tool

NEEDS_OUTCOME: Final = frozenset({"plus", "minus", "equals_sign", "delete"})
"""Tools that are about the outcome chosen."""

GRAPH_TOOLS: Final = (
    Tool(
        "enter",
        "enter",
        "actions",
        "What can be done in the state, and what comes of it; a new action too.",
        lambda box, desk: box.choose_action(desk),
        0,
    ),
    Tool(
        "plus",
        "+",
        "likelier",
        "Let the outcome chosen be likelier by .05; the others share the rest.",
        lambda box, desk: box.shift(desk, 0.05),
        2,
    ),
    Tool(
        "minus",
        "−",
        "less likely",
        "Let the outcome chosen be less likely by .05; the others share the rest.",
        lambda box, desk: box.shift(desk, -0.05),
        3,
    ),
    Tool(
        "equals_sign",
        "=",
        "reward",
        "Type what the action chosen pays.",
        lambda box, desk: box.ask_reward(desk),
        9,
    ),
    Tool(
        "delete",
        "del",
        "action −",
        "Take the action chosen away.",
        lambda box, desk: box.take_action_away(desk),
        10,
    ),
    Tool("S", "S", "start", "Let every episode start here.", lambda box, desk: box.begin_here(desk), 1),
    Tool(
        "i",
        "i",
        "state +",
        "Add a state, and an action that leads there from this one.",
        lambda box, desk: box.add_state(desk),
        5,
    ),
    Tool(
        "u",
        "u",
        "state −",
        "Take this state away, and what leads there.",
        lambda box, desk: box.remove_state(desk),
        6,
    ),
    Tool(
        "comma",
        ",",
        "next state",
        "Go to the next state: to one that no arrow key leads to as well.",
        lambda box, desk: box.go_on(desk),
        15,
    ),
    Tool(
        "less_than_sign",
        "<",
        "move left",
        "Draw the state one place to the left.",
        lambda box, desk: box.move(desk, -1, 0),
        11,
    ),
    Tool(
        "greater_than_sign",
        ">",
        "move right",
        "Draw the state one place to the right.",
        lambda box, desk: box.move(desk, 1, 0),
        12,
    ),
    Tool(
        "circumflex_accent",
        "^",
        "move up",
        "Draw the state one place higher.",
        lambda box, desk: box.move(desk, 0, -1),
        13,
    ),
    Tool(
        "V",
        "V",
        "move down",
        "Draw the state one place lower.",
        lambda box, desk: box.move(desk, 0, 1),
        14,
    ),
    Tool("o", "o", "rules", "The rules of the graph: start and time limit.", ask_rules, 4),
)
