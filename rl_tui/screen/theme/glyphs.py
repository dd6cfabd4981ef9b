"""The two sets of characters for drawing."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from typing import Any, Final

# Pairs: a character, then its spelling
_SPELLINGS: Final = """
α alpha   γ gamma   ε epsilon   δ delta   θ theta   λ lambda   τ tau   π pi   σ sigma   μ mu   Σ sum
− -   – -   — -   … ...   · *   × x   ′ '   ’ '   ‘ '   “ "   ” "
← <-   → ->   ↑ ^   ↓ v   ↖ ^<   ↗ ^>   ↙ v<   ↘ v>
₀ 0   ₁ 1   ₂ 2   ₃ 3   ₙ n   ₜ t   ₊ +   ⁿ ^n   ᵀ ^T
⁰ 0   ¹ ^1   ² ^2   ³ ^3   ⁵ ^5   ⁶ ^6   ⁷ ^7   ⁺ +   ⁻ -
√ sqrt   ≤ <=   ≥ >=   ≈ ~   ≠ !=   ± +/-   ∞ inf   ⟨ <   ⟩ >
◤ x   ▫ .   ✓ v   ✗ x   ★ G   ● O   ◉ @   ▸ >   ◆ +   ▾ v   ▴ ^   ↻ T   ╱ %
○ o   ‹ <   ▐ {   ┃ |   ╍ :   ┆ Y   █ #   ┈ .   ░ :   • "   ◦ '
¼ 1/4   ½ 1/2   ¾ 3/4   ⅓ 1/3   ⅔ 2/3   é e   ö o   ü u   ä a
"""
_WORDS: Final = _SPELLINGS.split()
_SPELLED: Final = dict(zip(_WORDS[::2], _WORDS[1::2], strict=True)) | {"\u0304": "bar"}

# · alone is a product sign, but after a comma it means any action, as in max Q(s',a)
_ANY_ACTION: Final = (",·)", ",a)")
# A spelled-out letter needs a blank before its factor: gamma V, delta e
_FACTOR: Final = re.compile(r"([αγεδθλτπσμΣ])(?=[A-Za-zα-ω])")


def _in(unicode: Any, ascii: Any) -> Any:  # noqa: A002
    return field(default=unicode, metadata={"ascii": ascii})


@dataclass(frozen=True, slots=True)
class Glyphs:
    """Special characters, one column wide unless a comment says otherwise."""

    name: str = _in("unicode", "ascii")
    left: str = _in("←", "<")
    down: str = _in("↓", "v")
    right: str = _in("→", ">")
    up: str = _in("↑", "^")
    # up left, up right, down left, down right; two columns in ASCII
    diagonals: tuple[str, str, str, str] = _in(("↖", "↗", "↙", "↘"), ("^<", "^>", "v<", "v>"))
    stay: str = _in("▫", ".")
    untried: str = _in("·", ".")  # in place of a number or an arrow: unknown, or all actions equal
    agent: str = _in("◉", "@")
    hole: str = _in("●", "O")
    cliff: str = _in("╱", "%")
    goal: str = _in("★", "G")
    best_arm: str = _in("★", "<")
    wall: str = _in("█", "#")
    mark_left: str = _in("▌", "[")  # frames the greedy cell of a table
    mark_right: str = _in("▐", "]")
    mark_after: str = _in("▌", "]")  # after the greedy number, in place of a frame
    lit: str = _in("▐", "{")  # before the cell of a table that was just updated
    moved: str = _in("▾▴", "v^")  # after its number: it fell, it rose
    cursor: str = _in("▸", ">")
    breakpoint: str = _in("!", "!")
    trail: str = _in("•", "=")  # on a map: recent and older steps
    trail_old: str = _in("◦", ",")
    seam: str = _in("▕", "|")  # between the cells of a map
    edges: str = _in("▏▕", "||")  # walls between the cells of a map: at the left, at the right
    frame: str = _in("▌▐▔▁", "[]--")  # around a cell: left, right, above, below
    lit_edge: str = _in("▔", "#")  # of a wall
    unreached: str = _in("░", ":")  # fills an unreachable cell
    one_way: str = _in("«»∧∨", "<>^v")  # cells with one way out: left, right, up, down
    no_room: str = _in("▪", "#")  # in place of a number that does not fit
    cut: str = _in("‹", "<")  # the end of a bar to the left that is too long
    differs: str = _in("◤", "x")  # greedy actions that differ between two runs
    turned: str = _in("↻", "T")  # the last edit changed the best actions of a state
    endless: str = _in("∞", "&")  # a state from which the episode may never end
    drafted: str = _in("╱", "/")  # fills a cell that is edited but not active
    track_done: str = _in("━", "=")  # slider
    track_rest: str = _in("─", "-")
    thumb: str = _in("●", "o")
    flip: str = _in("┃", "|")  # on a slider: a flip point from the start, or of other states only
    side_flip: str = _in("│", ":")
    change_mark: str = _in("◆", "+")  # on a chart: one of many changes
    policy_mark: str = _in("┃", "|")  # timeline: the greedy policy changed, the world, a setting
    world_mark: str = _in("◆", "+")
    setting_mark: str = _in("▾", "v")
    progress: str = _in("◔◑●", ".o*")  # a world in the list: opened, run, with an optimal greedy policy
    manual_mark: str = _in("╍", ":")  # timeline: steps by hand, start of the branch
    fork_mark: str = _in("┆", "Y")
    running: str = _in("▶", ">")  # status
    paused: str = _in("❚❚", "||")
    past: str = _in("◀", "<")
    stopped: str = _in("■", "#")
    bar: str = _in("█", "#")
    half_bar: str = _in("▌▐", "##")  # the end of a bar to the right, to the left
    eighths: str = _in(" ▁▂▃▄▅▆▇█", " ..::||##")  # of a cell, from below
    axis_vertical: str = _in("│", "|")
    axis_horizontal: str = _in("─", "-")
    axis_corner: str = _in("└", "+")
    axis_tick: str = _in("┤", "+")
    off_axis: str = _in("▾▴", "v^")  # values below or above an axis
    level: str = _in("┈", ".")  # the horizontal line of an optimum
    dashes: str = _in("╌", "-")  # the line of a policy
    whisker: str = _in("━", "-")  # error bars
    bar_end: str = _in("┃", "|")  # end of a bar, on its error bar
    estimate: str = _in("●", "o")
    zero_line: str = _in("┊", ":")
    thin: str = _in("─", "-")  # graph edges: horizontal, vertical, then the four corners of rounded boxes
    thin_vertical: str = _in("│", "|")
    bold: str = _in("━", "=")
    bold_vertical: str = _in("┃", "#")
    round_corners: str = _in("╭╮╰╯", "++++")  # ╭╮╰╯
    double_box: str = _in("═║╔╗╚╝", "=|++++")  # ═║╔╗╚╝
    head_left: str = _in("◀", "<")
    head_right: str = _in("▶", ">")
    head_up: str = _in("▲", "^")
    head_down: str = _in("▼", "v")
    ellipsis: str = _in("…", "~")
    holds: str = _in("✓", "v")  # a condition holds, does not hold yet; an answer is wrong
    open: str = _in("○", "o")
    fails: str = _in("✗", "x")
    arrow_update: str = _in("←", "<-")  # assignment
    times: str = _in("·", "*")
    minus: str = _in("−", "-")
    state_node: str = _in("○", "o")  # backup diagrams: a state, an action, and a fork of lines
    action_node: str = _in("●", "x")
    fork: str = _in("├", "+")
    braille: bool = _in(True, False)  # curves in braille dots; otherwise in . : ' and *

    def spelled(self, text: str) -> str:
        """Write ``text`` in these characters. Unknown ones become ``?`` in ASCII."""
        if self.name != "ascii":
            return text
        apart = _FACTOR.sub(r"\1 ", text.replace(*_ANY_ACTION))
        spelled = "".join(_SPELLED.get(character, character) for character in apart)
        return spelled.encode("ascii", "replace").decode("ascii")

    def separated(self, text: str) -> str:
        """Return :meth:`spelled`, with dots as separators."""
        return self.spelled(text.replace(" · ", " – ")) if self.name == "ascii" else text

    def direction(self, step: tuple[int, int]) -> str:
        """Return the sign of a step (rows down, columns right) or stay."""
        rows, columns = step
        if rows and columns:
            return self.diagonals[2 * (rows > 0) + (columns > 0)]
        if not rows and not columns:
            return self.stay
        if rows:
            return self.down if rows > 0 else self.up
        return self.right if columns > 0 else self.left


UNICODE: Final = Glyphs()
ASCII: Final = Glyphs(**{each.name: each.metadata["ascii"] for each in fields(Glyphs)})


_PLAIN: Final = ("C", "POSIX")
_PUT_THERE_BY_PYTHON: Final = "C.UTF-8"


def encoding_of(environ: Mapping[str, str], encoding: str | None, *, utf8_mode: bool) -> str | None:
    """Return the locale's encoding, else ``encoding``, that of Python's output.

    In the locales C and POSIX the answer is ASCII, although Python writes UTF-8 there (``utf8_mode``).
    """
    character_type = environ.get("LC_CTYPE", "")
    if utf8_mode and character_type == _PUT_THERE_BY_PYTHON:
        character_type = ""
    name = environ.get("LC_ALL") or character_type or environ.get("LANG") or ""
    if name in _PLAIN:
        return "ascii"
    _, _, named = name.partition("@")[0].partition(".")
    return named or encoding
