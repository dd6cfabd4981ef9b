"""A chain of states in boxes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from typing import TYPE_CHECKING, Final

import numpy as np
from rich.style import Style

from rl_tui.screen.draw.block_signs import SignName, block_numbers, block_sign, sign_size
from rl_tui.screen.draw.canvas import Canvas, centred
from rl_tui.screen.kit.snapshot_facts import is_secret
from rl_tui.screen.panels.graph.layout import GraphLayout
from rl_tui.screen.panels.graph.routing import Box
from rl_tui.screen.panels.graph.shape import GraphScene, GraphShape, reward_text
from rl_tui.screen.panels.world.edit_marks import marks_of

if TYPE_CHECKING:
    from rl_tui.agents.last_step import LastStep
    from rl_tui.live.snapshot import Snapshot
    from rl_tui.screen.theme.look import Look
    from rl_tui.worlds.mdp.space import FiniteSpace
    from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

# Boxes

_LEAST_STEP: Final = 2  # columns from one box to the next: a box and a line
_MOST_WIDTH: Final = 33
_PARTS: Final = 6  # parts of a step: one is the line between two boxes
_LEAST_HEIGHT: Final = 5  # rows of a box: a wide one has two thirds of its columns
_BLOCK_NUMBER: Final = 7  # rows of a box with a number in blocks: arrows need more
_ARROW_ROWS: Final = 2
_AROUND: Final = 2  # rows: the agent above, exact values below
_LEAST_BLOCK: Final = 9  # columns of a box with block arrows
_LEAST_NUMBER: Final = 3  # columns: shorter numbers say less than the colour
_EXACT: Final = "exact"


def chain_rows(states: int, width: int) -> int:
    """Return a chain's rows with agent and exact values."""
    return _box_size(width // states)[1] + _AROUND


def _box_size(step: int) -> tuple[int, int]:
    wide = min(_MOST_WIDTH, step - max(1, step // _PARTS))
    return wide, max(_LEAST_HEIGHT, 2 * wide // 3 | 1)


@lru_cache(maxsize=32)
def chain_layout(chain: tuple[int, ...], width: int, height: int) -> GraphLayout | None:
    """Lay out ``chain`` if it fits."""
    step = width // len(chain)
    if step < _LEAST_STEP or height < 1:
        return None
    wide, high = _box_size(step)
    high = max(1, min(high, height - _AROUND))
    top = max(0, (height - high - _AROUND) // 2) + (height > 1)
    left = (width - step * (len(chain) - 1) - wide) // 2
    boxes = {state: Box(left + place * step, top, wide, high) for place, state in enumerate(chain)}
    return GraphLayout(tuple(boxes[state] for state in range(len(chain))), (), (), (), ())


# Ends


def end_rewards(mdp: TabularMDP) -> Mapping[int, float | None]:
    """Return each terminal state's reward, if unique."""
    ends = np.flatnonzero(np.diff(mdp.first_pair) == 0)
    rewards = {int(end): np.unique(mdp.reward[mdp.next_state == end]) for end in ends}
    return {end: float(own[0]) if len(own) == 1 else None for end, own in rewards.items()}


# The picture


def exact_v(space: FiniteSpace, snapshot: Snapshot) -> tuple[float, ...] | None:
    """Return the exact V, [S], or None."""
    solution = snapshot.exact_answer.solution
    if solution is None or is_secret(snapshot):
        return None
    q, pairs = solution.q.tolist(), map(space.pairs_of, range(space.states))
    return tuple(max(q[own.start : own.stop], default=0.0) for own in pairs)


@dataclass
class ChainPicture:
    """Draws a chain."""

    canvas: Canvas
    shape: GraphShape
    boxes: tuple[Box, ...]
    scene: GraphScene
    look: Look
    rewards: Mapping[int, float | None]  # from end_rewards
    exact: tuple[float, ...] | None
    last: LastStep | None  # None if steps pass too fast

    def draw(self) -> None:
        """Draw links, boxes, agent and exact values."""
        self._put_links()
        for state, box in enumerate(self.boxes):
            self._fill(box, self._ground(state))
            if self.shape.nodes[state].terminal:
                self._put_end(state, box)
            else:
                self._put_state(state, box)
            self._put_marks(state, box)
        self._put_agent()
        self._put_exact()

    def _put_links(self) -> None:
        glyphs, palette = self.look.glyphs, self.look.palette
        row = sorted(enumerate(self.boxes), key=lambda each: each[1].x)
        way = (self.last.state, self.last.next_state) if self.last and not self.last.planned else None
        for (state, box), (after, following) in pairwise(row):
            x, y = box.x + box.width, box.y + box.height // 2
            gap = following.x - x
            line, style = glyphs.thin * gap, palette.dim
            if way == (state, after):
                line, style = glyphs.track_done * (gap - 1) + glyphs.head_right, palette.agent
            elif way == (after, state):
                line, style = glyphs.head_left + glyphs.track_done * (gap - 1), palette.agent
            self.canvas.put(x, y, line, style)

    def _ground(self, state: int) -> Style:
        palette, reward = self.look.palette, self.rewards.get(state)
        if not self.shape.nodes[state].terminal:
            return self.scene.values.style(state, self.look)
        return palette.goal if reward is not None and reward > 0.0 else palette.hole

    def _fill(self, box: Box, style: Style) -> None:
        for y in range(box.y, box.y + box.height):
            self.canvas.put(box.x, y, " " * box.width, style)

    def _put(self, box: Box, row: int, text: str, style: Style) -> bool:
        if fits := 0 < len(text) <= box.width and row < box.height:
            self.canvas.put(box.x, box.y + row, centred(text, box.width), style)
        return fits

    def _put_end(self, state: int, box: Box) -> None:
        glyphs, style, reward = self.look.glyphs, self._ground(state), self.rewards.get(state)
        sign = glyphs.goal if reward is not None and reward > 0.0 else glyphs.hole
        paid = "" if reward is None else reward_text(reward, glyphs)
        name, edge = self.shape.nodes[state].name, int(box.height >= 5)
        bold, rows = style + Style(bold=True), min(box.height - 6, box.width // 2 - 1)
        if rows >= _ARROW_ROWS and glyphs.braille:
            shape: SignName = "star" if sign == glyphs.goal else "ring"
            for y, line in enumerate(block_sign(shape, 2 * rows, rows), start=edge + 2):
                self._put(box, y, line, bold)
            self._put(box, box.height - 1 - edge, paid, bold)
        elif box.height < 3 or not paid or len(f"{sign} {paid}") <= box.width:
            self._put(box, box.height // 2, f"{sign} {paid}".rstrip(), bold) or self._put(
                box, box.height // 2, sign, bold
            )
        else:
            self._put(box, edge + 1, sign, bold)
            self._put(box, box.height - 1 - edge, paid, bold)
        if box.height >= 3:
            self._put(box, edge if box.height > 3 else 0, name, style)

    def _put_state(self, state: int, box: Box) -> None:
        scene, look, style = self.scene, self.look, self._ground(state)
        edge = int(box.height >= 5)
        name = self.shape.nodes[state].name
        flag = scene.values.flag(state, scene.signs.differing, look)
        if box.height > 1 and self._put(box, edge, name, style + Style(bold=True)) and flag:
            x = box.x + min(box.width - 1, (box.width + len(name)) // 2 + 1)
            self.canvas.put(x, box.y + edge, flag, scene.values.flag_style(state, look.palette.text, look))
        text = scene.values.text(state, scene.form, look)
        number = self._numbers(box).get(text, ())
        if box.height > 2:
            self._put_arrows(state, box, edge + 1, box.height - 2 * edge - (4 if number else 2))
        is_new = state not in scene.values.known
        ink = look.palette.focus if state == scene.signs.cursor else style + Style(bold=not is_new)
        if number:
            top = box.height - edge - 3 if self._has_choice else (box.height - 2) // 2
            for y, line in enumerate(number, start=top):
                self._put(box, y, line, ink)
        elif box.width >= _LEAST_NUMBER:
            self._put(box, box.height - 1 - edge, text, ink)

    @property
    def _has_choice(self) -> bool:
        return len({each.name for each in self.shape.actions}) > 1

    def _numbers(self, box: Box) -> Mapping[str, tuple[str, ...]]:
        if box.height < _BLOCK_NUMBER + _ARROW_ROWS * self._has_choice or not self.look.glyphs.braille:
            return {}
        texts = (
            self.scene.values.text(state, self.scene.form, self.look) for state in range(len(self.boxes))
        )
        return block_numbers(filter(None, texts), box.width - 2)

    def _put_arrows(self, state: int, box: Box, top: int, rows: int) -> None:
        ways = [
            -1 if action.name == "left" else 1
            for action in self.shape.actions
            if action.source == state and action.pair in self.scene.values.greedy
        ]
        glyphs, style = self.look.glyphs, self._ground(state) + Style(bold=True)
        size = sign_size(box.width, max(3, 2 * rows - 1))[0], rows
        if len(ways) == 1 and rows > 1 and box.width >= _LEAST_BLOCK and glyphs.braille:
            for y, line in enumerate(block_sign("arrow", *size, (0, ways[0])), start=top):
                self._put(box, y, line, style)
        else:
            text = "".join(glyphs.right if way > 0 else glyphs.left for way in ways)
            self._put(box, top + rows // 2, text, style)

    def _put_marks(self, state: int, box: Box) -> None:
        scene, glyphs, palette = self.scene, self.look.glyphs, self.look.palette
        right, last = box.x + box.width - 1, box.y + box.height - 1
        is_next, last_step = state in scene.signs.next_states, None if scene.signs.subject else self.last
        is_updated = last_step is not None and last_step.updated_pair in self.shape.pairs_of(state)
        if (is_next or is_updated) and box.width >= 3:
            colour = palette.source_line if last_step is None else palette.error(last_step.error_sign)
            if not glyphs.braille:
                low = last - int(box.height >= 5)
                self.canvas.restyle(box.x, low, box.width, Style(reverse=True))
            for y in range(box.y, last + 1 if glyphs.braille else box.y):
                for x, sign in ((box.x, glyphs.frame[0]), (right, glyphs.frame[1])):
                    if self.canvas.is_blank(x, y, 1):
                        self.canvas.put_over(x, y, sign, colour)
        if state in scene.signs.breakpoints.states:
            self.canvas.put(right, box.y, glyphs.breakpoint, palette.breakpoint)
        for y, mark in zip((box.y, last), marks_of(scene.signs.editor, state).signs(self.look), strict=False):
            self.canvas.put(box.x, y, *mark)

    def _put_agent(self) -> None:
        box, sign = self.boxes[self.scene.signs.agent], self.look.glyphs.agent
        text = f" {sign} " if box.width >= 3 else sign
        x = box.x + (box.width - 1) // 2 - len(text) // 2
        self.canvas.put(x, max(0, box.y - 1), text, self.look.palette.agent)

    def _put_exact(self) -> None:
        scene, look = self.scene, self.look
        row = sorted(enumerate(self.boxes), key=lambda each: each[1].x)
        first, y = row[0][1], row[0][1].y + row[0][1].height
        is_end = self.shape.nodes[row[0][0]].terminal
        start, room = (first.x, first.width) if is_end else (0, first.x - 1)
        if self.exact is None or y >= self.canvas.height or room < len(_EXACT):
            return
        self.canvas.put(start, y, _EXACT, look.palette.dim)
        for state, box in row:
            text = scene.form.text(self.exact[state], look.glyphs)
            if not self.shape.nodes[state].terminal and len(text) <= box.width:
                self.canvas.put(box.x, y, centred(text, box.width), look.palette.dim)
