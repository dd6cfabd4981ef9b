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
        lambda box, hand: box.choose_action(hand),
        0,
    ),
    Tool(
        "plus",
        "+",
        "likelier",
        "Let the outcome chosen be likelier by .05; the others share the rest.",
        lambda box, hand: box.shift(hand, 0.05),
        2,
    ),
    Tool(
        "minus",
        "−",
        "less likely",
        "Let the outcome chosen be less likely by .05; the others share the rest.",
        lambda box, hand: box.shift(hand, -0.05),
        3,
    ),
    Tool(
        "equals_sign",
        "=",
        "reward",
        "Type what the action chosen pays.",
        lambda box, hand: box.ask_reward(hand),
        9,
    ),
    Tool(
        "delete",
        "del",
        "action −",
        "Take the action chosen away.",
        lambda box, hand: box.take_action_away(hand),
        10,
    ),
    Tool("S", "S", "start", "Let every episode start here.", lambda box, hand: box.begin_here(hand), 1),
    Tool(
        "i",
        "i",
        "state +",
        "Add a state, and an action that leads there from this one.",
        lambda box, hand: box.add_state(hand),
        5,
    ),
    Tool(
        "u",
        "u",
        "state −",
        "Take this state away, and what leads there.",
        lambda box, hand: box.remove_state(hand),
        6,
    ),
    Tool(
        "comma",
        ",",
        "next state",
        "Go to the next state: to one that no arrow key leads to as well.",
        lambda box, hand: box.go_on(hand),
        15,
    ),
    Tool(
        "less_than_sign",
        "<",
        "move left",
        "Draw the state one place to the left.",
        lambda box, hand: box.move(hand, -1, 0),
        11,
    ),
    Tool(
        "greater_than_sign",
        ">",
        "move right",
        "Draw the state one place to the right.",
        lambda box, hand: box.move(hand, 1, 0),
        12,
    ),
    Tool(
        "circumflex_accent",
        "^",
        "move up",
        "Draw the state one place higher.",
        lambda box, hand: box.move(hand, 0, -1),
        13,
    ),
    Tool(
        "V",
        "V",
        "move down",
        "Draw the state one place lower.",
        lambda box, hand: box.move(hand, 0, 1),
        14,
    ),
    Tool("o", "o", "rules", "The rules of the graph: start and time limit.", ask_rules, 4),
)
