"""The two sets of characters the screens are drawn with, and which of them a terminal takes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final


@dataclass(frozen=True, slots=True)
class Glyphs:
    """Every special character that a widget may draw. Each is one column wide unless said otherwise."""

    name: str
    left: str
    down: str
    right: str
    up: str
    diagonals: tuple[str, str, str, str]  # up left, up right, down left, down right; two columns in ASCII
    stay: str
    untried: str  # in place of a number or an arrow where nothing is known, or all is as good
    agent: str
    hole: str
    cliff: str
    goal: str
    best_arm: str
    wall: str
    mark_left: str  # frames the greedy cell of a table
    mark_right: str
    mark_after: str  # follows the greedy number where there is no room for a frame
    lit: str  # before the cell of a table that was just updated
    moved: str  # behind its number: it fell, it rose
    cursor: str
    breakpoint: str
    trail: str  # on a map: left not long ago, left long ago
    trail_old: str
    seams: str  # between the cells of a map: at the right, below
    frame: str  # around a cell: left, right, above, below
    lit_edge: str  # of a wall
    unreached: str  # fills a cell that no way leads to
    one_way: str  # cells that are left in one direction only: left, right, up, down
    no_room: str  # in place of a number that does not fit
    beyond: str  # a value below the scale, above it
    differs: str  # greedy actions that are others in the lane beside
    turned: str  # the last edit turned the best actions of a state
    endless: str  # no way leads from a state to an end
    drafted: str  # fills a cell that is drawn and not in force
    track_done: str  # slider
    track_rest: str
    thumb: str
    flip: str  # on a track: the way from the start turns, only other states do
    side_flip: str
    change_mark: str  # on a chart: one of many changes
    policy_mark: str  # timeline: the greedy policy changed, the world, a setting
    world_mark: str
    setting_mark: str
    progress: str  # a world in the list: opened, run on, its greedy policy is optimal
    manual_mark: str  # steps were taken by hand, the branch begins
    fork_mark: str
    running: str  # status
    paused: str
    past: str
    stopped: str
    bar: str
    axis_vertical: str
    axis_horizontal: str
    axis_corner: str
    axis_tick: str
    off_axis: str  # what is below an axis, above it
    level: str  # the horizontal line of an optimum
    dashes: str  # that of a policy
    whisker: str  # error bars
    bar_end: str  # where a bar ends, on its error bar
    estimate: str
    zero_line: str
    thin: str  # graph edges: horizontal, vertical, then the four corners of rounded boxes
    thin_vertical: str
    bold: str
    bold_vertical: str
    round_corners: str  # ╭╮╰╯
    double_box: str  # ═║╔╗╚╝
    head_left: str
    head_right: str
    head_up: str
    head_down: str
    ellipsis: str
    holds: str  # a condition does, does not
    fails: str
    arrow_update: str  # ← of an assignment
    times: str
    minus: str
    state_node: str  # backup diagrams: a state, an action taken in it, and where lines part
    action_node: str
    fork: str
    braille: bool  # curves in braille dots; otherwise in . : ' and *

    def direction(self, step: tuple[int, int]) -> str:
        """Return the arrow for a step (rows down, columns right), one of a king's moves or none."""
        rows, columns = step
        if rows and columns:
            return self.diagonals[2 * (rows > 0) + (columns > 0)]
        if not rows and not columns:
            return self.stay
        if rows:
            return self.down if rows > 0 else self.up
        return self.right if columns > 0 else self.left


_ROWS: Final[Mapping[str, tuple[Any, Any]]] = {
    "name": ("unicode", "ascii"),
    "left": ("←", "<"),
    "down": ("↓", "v"),
    "right": ("→", ">"),
    "up": ("↑", "^"),
    "diagonals": (("↖", "↗", "↙", "↘"), ("^<", "^>", "v<", "v>")),
    "stay": ("▫", "."),
    "untried": ("·", "."),
    "agent": ("◉", "@"),
    "hole": ("●", "O"),
    "cliff": ("╱", "%"),
    "goal": ("★", "G"),
    "best_arm": ("★", "<"),
    "wall": ("█", "#"),
    "mark_left": ("▌", "["),
    "mark_right": ("▐", "]"),
    "mark_after": ("▌", "]"),
    "lit": ("▐", "{"),
    "moved": ("▾▴", "-+"),
    "cursor": ("▸", ">"),
    "breakpoint": ("!", "!"),
    "trail": ("•", "="),
    "trail_old": ("◦", ","),
    "seams": ("▕▁", "|_"),
    "frame": ("▌▐▔▁", "[]--"),
    "lit_edge": ("▔", "#"),
    "unreached": ("░", ":"),
    "one_way": ("«»∧∨", "<>^v"),
    "no_room": ("▪", "#"),
    "beyond": ("‹›", "<>"),
    "differs": ("◤", "x"),
    "turned": ("↻", "T"),
    "endless": ("∞", "&"),
    "drafted": ("╱", "/"),
    "track_done": ("━", "="),
    "track_rest": ("─", "-"),
    "thumb": ("●", "o"),
    "flip": ("┃", "|"),
    "side_flip": ("│", ":"),
    "change_mark": ("◆", "+"),
    "policy_mark": ("┃", "|"),
    "world_mark": ("◆", "+"),
    "setting_mark": ("▾", "v"),
    "progress": ("◔◑●", ".o*"),
    "manual_mark": ("╍", ":"),
    "fork_mark": ("┆", "Y"),
    "running": ("▶", ">"),
    "paused": ("❚❚", "||"),
    "past": ("◀", "<"),
    "stopped": ("■", "#"),
    "bar": ("█", "#"),
    "axis_vertical": ("│", "|"),
    "axis_horizontal": ("─", "-"),
    "axis_corner": ("└", "+"),
    "axis_tick": ("┤", "+"),
    "off_axis": ("▾▴", "v^"),
    "level": ("┈", "."),
    "dashes": ("╌", "-"),
    "whisker": ("━", "-"),
    "bar_end": ("┃", "|"),
    "estimate": ("●", "o"),
    "zero_line": ("┊", ":"),
    "thin": ("─", "-"),
    "thin_vertical": ("│", "|"),
    "bold": ("━", "="),
    "bold_vertical": ("┃", "H"),
    "round_corners": ("╭╮╰╯", "++++"),
    "double_box": ("═║╔╗╚╝", "=|++++"),
    "head_left": ("◀", "<"),
    "head_right": ("▶", ">"),
    "head_up": ("▲", "^"),
    "head_down": ("▼", "v"),
    "ellipsis": ("…", "~"),
    "holds": ("✓", "v"),
    "fails": ("✗", "x"),
    "arrow_update": ("←", "<-"),
    "times": ("·", "*"),
    "minus": ("−", "-"),
    "state_node": ("○", "o"),
    "action_node": ("●", "x"),
    "fork": ("├", "+"),
    "braille": (True, False),
}
"""Of every field the character of Unicode, and what stands in its place in ASCII."""

UNICODE: Final = Glyphs(**{name: row[0] for name, row in _ROWS.items()})
ASCII: Final = Glyphs(**{name: row[1] for name, row in _ROWS.items()})


_PLAIN: Final = ("C", "POSIX")
_PUT_THERE_BY_PYTHON: Final = "C.UTF-8"


def encoding_of(environ: Mapping[str, str], encoding: str | None, *, utf8_mode: bool) -> str | None:
    """Return the encoding that the locale names, or ``encoding``, that of Python's output, if it names none.

    Python writes UTF-8 in the locales C and POSIX whatever the terminal takes (``utf8_mode``), and sets
    LC_CTYPE to say so: PEP 538 and 540. A person who asks for C asks for ASCII.
    """
    character_type = environ.get("LC_CTYPE", "")
    if utf8_mode and character_type == _PUT_THERE_BY_PYTHON:
        character_type = ""
    name = environ.get("LC_ALL") or character_type or environ.get("LANG") or ""
    if name in _PLAIN:
        return "ascii"
    _, _, named = name.partition("@")[0].partition(".")
    return named or encoding
