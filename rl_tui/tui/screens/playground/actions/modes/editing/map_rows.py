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
            partial(lambda brush, box, desk: box.take(brush, desk), each),
            rank,
            click=partial(lambda brush, box, desk: box.choose(brush, desk), each),
            name=each.name,
        )
        for rank, each in enumerate(BRUSHES)
    ),
    Tool(
        JUMP,
        "J",
        "jump",
        "Let a jump begin here; enter, or a click, says where it leads.",
        lambda box, desk: box.begin_jump(desk),
        20,
    ),
    Tool(
        ARROW_KEY,
        "A",
        "arrow",
        "Let a click move the cursor only, and a drag mark a rectangle.",
        lambda box, desk: box.point(desk),
    ),
    Tool(
        PICK,
        ",",
        "pick up",
        "Take what is under the cursor for the brush.",
        lambda box, desk: box.pick_up(desk),
    ),
    Tool(
        "enter",
        "enter",
        "paint",
        "Paint with the brush.",
        lambda box, desk: box.enter(desk),
        9,
        in_panel=False,
    ),
    Tool("equals_sign", "=", "reward", "Type what the cell pays.", lambda box, desk: box.ask_reward(desk), 6),
    Tool("plus", "+", "pays +1", "Let the cell pay 1 more.", lambda box, desk: box.pay(1.0, desk), 16),
    Tool("minus", "−", "pays −1", "Let the cell pay 1 less.", lambda box, desk: box.pay(-1.0, desk), 17),
    Tool(
        MARK,
        "m",
        "mark",
        "Begin a rectangle at the cursor, or drop it.",
        lambda box, desk: box.mark(desk),
        18,
    ),
    Tool("y", "y", "copy", "Copy the rectangle.", lambda box, desk: box.copy(desk)),
    Tool(PASTE, "p", "paste", "Put down what was copied.", lambda box, desk: box.paste(desk)),
    Tool(
        "F",
        "F",
        "fill",
        "Fill the rectangle, or the region around the cursor.",
        lambda box, desk: box.fill(desk),
        19,
    ),
    Tool("i", "i", "row +", "Add a row here.", lambda box, desk: box.resize("rows", 1, desk), 12),
    Tool("u", "u", "row −", "Take this row away.", lambda box, desk: box.resize("rows", -1, desk), 13),
    Tool(
        "R",
        "R",
        "row last",
        "Add a row at the bottom.",
        lambda box, desk: box.resize("rows", 1, desk, at_end=True),
    ),
    Tool("I", "I", "column +", "Add a column here.", lambda box, desk: box.resize("columns", 1, desk), 14),
    Tool(
        "U", "U", "column −", "Take this column away.", lambda box, desk: box.resize("columns", -1, desk), 15
    ),
    Tool(
        "N",
        "N",
        "col last",
        "Add a column at the right.",
        lambda box, desk: box.resize("columns", 1, desk, at_end=True),
    ),
    Tool(
        "",
        "",
        SLIPPERY,
        "Let each of three moves be as likely, as on Gymnasium's ice, or not.",
        lambda _, desk: next_word(desk, "slippery"),
    ),
    Tool(
        "",
        "",
        LEAVING,
        "Let cells pay on leaving them, or on entering.",
        lambda _, desk: next_word(desk, "rewards"),
    ),
    Tool(
        "",
        "",
        MOVES,
        "Choose the next kind of moves: four, clockwise, king, king+stay.",
        lambda _, desk: next_word(desk, "moves"),
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
