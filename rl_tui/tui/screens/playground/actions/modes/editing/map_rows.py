"""The tools for maps, a row each."""

from __future__ import annotations

from functools import partial
from typing import Final

from rl_tui.tui.screens.playground.actions.modes.editing.brushes import BRUSHES
from rl_tui.tui.screens.playground.actions.modes.editing.rules import ask_rules, next_word
from rl_tui.tui.screens.playground.actions.modes.editing.tools import Tool

PICK, ARROW_KEY, MARK, JUMP, PASTE = "comma", "A", "m", "J", "p"
SLIPPERY, LEAVING, MOVES = "slippery", "on leaving", "moves"

MAP_TOOLS: Final = (
    *(
        Tool(
            each.key,
            "V" if each.key == "V" else each.character,
            each.word,
            each.sentence,
            partial(lambda brush, box, hand: box.take(brush, hand), each),
            rank,
            click=partial(lambda brush, box, hand: box.choose(brush, hand), each),
            name=each.name,
        )
        for rank, each in enumerate(BRUSHES)
    ),
    Tool(
        JUMP,
        "J",
        "jump",
        "Let a jump begin here; enter, or a click, says where it leads.",
        lambda box, hand: box.begin_jump(hand),
        20,
    ),
    Tool(
        ARROW_KEY,
        "A",
        "arrow",
        "Let a click move the cursor only, and a drag mark a rectangle.",
        lambda box, hand: box.point(hand),
    ),
    Tool(
        PICK,
        ",",
        "pick up",
        "Take what is under the cursor for the brush.",
        lambda box, hand: box.pick_up(hand),
    ),
    Tool(
        "enter",
        "enter",
        "paint",
        "Paint with the brush.",
        lambda box, hand: box.enter(hand),
        9,
        in_panel=False,
    ),
    Tool("equals_sign", "=", "reward", "Type what the cell pays.", lambda box, hand: box.ask_reward(hand), 6),
    Tool("plus", "+", "1 more", "Let the cell pay 1 more.", lambda box, hand: box.pay(1.0, hand), 16),
    Tool("minus", "−", "1 less", "Let the cell pay 1 less.", lambda box, hand: box.pay(-1.0, hand), 17),
    Tool(
        MARK,
        "m",
        "mark",
        "Begin a rectangle at the cursor, or drop it.",
        lambda box, hand: box.mark(hand),
        18,
    ),
    Tool("y", "y", "copy", "Copy the rectangle.", lambda box, hand: box.copy(hand)),
    Tool(PASTE, "p", "paste", "Put down what was copied.", lambda box, hand: box.paste(hand)),
    Tool(
        "F",
        "F",
        "fill",
        "Fill the rectangle, or the region around the cursor.",
        lambda box, hand: box.fill(hand),
        19,
    ),
    Tool("i", "i", "row +", "Add a row here.", lambda box, hand: box.resize("rows", 1, hand), 12),
    Tool("u", "u", "row −", "Take this row away.", lambda box, hand: box.resize("rows", -1, hand), 13),
    Tool(
        "R",
        "R",
        "row last",
        "Add a row at the bottom.",
        lambda box, hand: box.resize("rows", 1, hand, at_end=True),
    ),
    Tool("I", "I", "column +", "Add a column here.", lambda box, hand: box.resize("columns", 1, hand), 14),
    Tool(
        "U", "U", "column −", "Take this column away.", lambda box, hand: box.resize("columns", -1, hand), 15
    ),
    Tool(
        "N",
        "N",
        "col last",
        "Add a column at the right.",
        lambda box, hand: box.resize("columns", 1, hand, at_end=True),
    ),
    Tool(
        "",
        "",
        SLIPPERY,
        "Let each of three moves be as likely, as on Gymnasium's ice, or not.",
        lambda _, hand: next_word(hand, "slippery"),
    ),
    Tool(
        "",
        "",
        LEAVING,
        "Let cells pay on leaving them, or on entering.",
        lambda _, hand: next_word(hand, "rewards"),
    ),
    Tool(
        "",
        "",
        MOVES,
        "Choose the next kind of moves: four, clockwise, king, king+stay.",
        lambda _, hand: next_word(hand, "moves"),
    ),
    Tool(
        "o",
        "o",
        "rules",
        "The rules of the map: noise, slip, living reward, wind, time limit.",
        ask_rules,
        7,
    ),
)
