"""The actions of an MDP as lines of text, for panels in which its graph has no room."""

from __future__ import annotations

from typing import Final

from rich.style import Style
from textual.strip import Strip

from rl_tui.tui.draw.canvas import Canvas
from rl_tui.tui.draw.number_form import NumberForm
from rl_tui.tui.panels.world.edit_marks import marks_of
from rl_tui.tui.panels.world.graph.shape import GraphAction, GraphShape, Signs
from rl_tui.tui.panels.world.state_values import StateValues
from rl_tui.tui.theme.look import Look

_VALUE_WIDTH: Final = 6
_LEAST_TEXT: Final = 20  # of an edge, below which names and values are left out


def draw_edge_list(
    shape: GraphShape,
    values: StateValues,
    form: NumberForm,
    signs: Signs,
    look: Look,
    width: int,
    height: int,
    top: int,
) -> list[Strip]:
    """Return one line an action from number ``top`` on: state, V, action with its reward, where it may lead.

    In narrow panels V is left out, then the names of the states.
    """
    canvas = Canvas(width, height, look.palette.text)
    names = max((len(shape.nodes[action.source].name) for action in shape.actions), default=0)
    with_values = width >= names + _VALUE_WIDTH + 3 + _LEAST_TEXT
    with_names = width >= names + 2 + _LEAST_TEXT
    x = 1 + (names + 1) * with_names + (_VALUE_WIDTH + 1) * with_values
    shown = shape.actions[top : top + height]
    for y, action in enumerate(shown):
        if y == 0 or shown[y - 1].source != action.source:
            state = action.source
            _put_mark(canvas, y, state, signs, look)
            if with_names:
                style = look.palette.focus if state == signs.cursor else look.palette.text + Style(bold=True)
                canvas.put(1, y, shape.nodes[state].name, style)
                flag = values.flag(state, signs.differing, look)
                style = values.flag_style(state, look.palette.accent, look)
                after = 1 + len(shape.nodes[state].name) + len(flag)
                canvas.put(after - len(flag), y, flag, style)
                # beside the longest name one cell is free
                marks = list(marks_of(signs.editor, state).signs(look))[: names + 2 - after]
                for place, mark in enumerate(marks, start=after):
                    canvas.put(place, y, *mark)
            if with_values:
                text = values.text(state, form, look)
                canvas.put(2 + names, y, text.rjust(_VALUE_WIDTH), values.style(state, look))
        greedy = action.pair in values.greedy
        style = look.palette.greedy if greedy else look.palette.text
        text = edge_text(shape, action, greedy, look)
        if len(text) > width - x >= len(tight := edge_text(shape, action, greedy, look, is_tight=True)):
            text = tight
        canvas.put(x, y, whole_words(text, width - x, look), style)
        if action.pair in signs.breakpoints.pairs:
            canvas.put(x, y, look.glyphs.breakpoint, look.palette.breakpoint)
    return canvas.strips()


def _put_mark(canvas: Canvas, y: int, state: int, signs: Signs, look: Look) -> None:
    """Put the agent, a breakpoint or the cursor before a state; the agent has the colour of what it is on."""
    here, palette = state == signs.agent, look.palette
    if state in signs.breakpoints.states:
        canvas.put(0, y, look.glyphs.agent if here else look.glyphs.breakpoint, palette.breakpoint)
    elif state == signs.cursor:
        canvas.put(0, y, look.glyphs.agent if here else look.glyphs.cursor, palette.focus)
    elif here:
        canvas.put(0, y, look.glyphs.agent, palette.agent)


def edge_text(
    shape: GraphShape, action: GraphAction, greedy: bool, look: Look, *, is_tight: bool = False
) -> str:
    """Return ``─study −2─▶ Pass .8 / Class .2``, with a bold line where the action is greedy.

    Where it ``is_tight``, without the cells that tell nothing: ``─study −2▶Pass .8/Class .2``.
    """
    line = look.glyphs.bold if greedy else look.glyphs.thin
    targets = (f"{shape.nodes[branch.target].name} {branch.label}".strip() for branch in action.branches)
    if is_tight:
        return f"{line}{action.label}{look.glyphs.head_right}{'/'.join(targets)}"
    return f"{line}{action.label}{line}{look.glyphs.head_right} {' / '.join(targets)}"


def whole_words(text: str, width: int, look: Look) -> str:
    """Return ``text``, cut between words so that no number loses digits, and ended by an ellipsis if cut."""
    if len(text) <= width:
        return text
    ellipsis = look.glyphs.ellipsis
    words = text.split(" ")
    while words and len(" ".join(words)) + 1 + len(ellipsis) > width:
        words.pop()
    return " ".join([*words, ellipsis]) if words else ellipsis[: max(0, width)]
