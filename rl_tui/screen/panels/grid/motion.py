"""The animation of a step on a map: a moving estimate and a fading frame.

It depends on two snapshots and its tick. A timer counts the ticks. No clock is read.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import inf, isfinite
from typing import TYPE_CHECKING, Final, NamedTuple

from rich.segment import Segment
from rich.style import Style
from textual.strip import Strip
from textual.timer import Timer

from rl_tui.agents.catalogue import algorithm_row
from rl_tui.agents.last_step import NOTHING, LastStep
from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.screen.draw import numbers
from rl_tui.screen.draw.block_signs import Direction
from rl_tui.screen.draw.number_form import NumberForm
from rl_tui.screen.kit.panel import Panel
from rl_tui.screen.kit.snapshot_facts import followed_step
from rl_tui.screen.panels.grid.form import CellForm
from rl_tui.screen.panels.grid.map import PLAIN, CellContent, GridMap, MapPart, with_extra
from rl_tui.screen.panels.grid.marks import value_text
from rl_tui.screen.terminal.linked_app import LinkedApp
from rl_tui.screen.theme.look import Look

if TYPE_CHECKING:
    from rl_tui.worlds.drawing import Grid

# The motion

_PLAIN: Final = Style(underline=False)
_SLOW: Final = 6.0  # steps per second: above, the value does not wait for the chip
_QUICK: Final = 15.0  # steps per second: above, nothing moves
_WHOLE_WAY: Final = (0.0, 0.5, 1.0)
_ON_THE_SEAM: Final = (0.5,)
_TURNED_TICKS: Final = 4
_SHARES: Final = (1.0, 1.0, 0.8, 0.8, 0.6, 0.6, 0.4)  # share of the frame's colour per tick


class Chip(NamedTuple):
    """The number that moves to s: the estimate of s′, or a final ``reward``.

    ``way`` leads from s′ to s: rows down and columns right.
    """

    number: float
    is_reward: bool
    way: Direction

    def text(self, form: NumberForm, look: Look) -> str:
        """Write the number after an arrow head."""
        glyphs = look.glyphs
        if self.is_reward or abs(self.number) < numbers.NEGLIGIBLE:
            number = "+" * (self.number > 0.0) + numbers.brief(self.number, glyphs, decimals=2)
        else:
            number = value_text(self.number, form._replace(leading_zero=False), look)
        down, right = ((each > 0) - (each < 0) for each in self.way)
        if not down:
            return f"{number}{glyphs.head_right}" if right > 0 else f"{glyphs.head_left}{number}"
        if right:
            return f"{glyphs.direction((down, right))}{number}"
        return f"{glyphs.head_down if down > 0 else glyphs.head_up}{number}"

    def style(self, look: Look) -> Style:
        """Return the chip's style."""
        palette = look.palette
        return palette.goal if self.is_reward and self.number > 0.0 else palette.source + _PLAIN

    @property
    def travels(self) -> bool:
        """True if it comes from a neighbour."""
        return max(map(abs, self.way)) == 1


class Motion(NamedTuple):
    """One step's effect on a map, at one ``tick``.

    ``path``: the chip's fractions of its way. Over a whole way, the cell shows ``before`` until it arrives.
    Then its frame fades.
    """

    cell: int
    before: CellContent
    chip: Chip | None = None
    path: tuple[float, ...] = ()
    tick: int = 0

    @property
    def is_over(self) -> bool:
        """True if nothing changes any more."""
        return self._since >= len(_SHARES) - 1

    @property
    def at_rest(self) -> Motion:
        """The end of the motion."""
        return self._replace(tick=self._changes + len(_SHARES) - 1)

    @property
    def scene(self) -> object:
        """A key of the picture."""
        since, chip_at = self._since, min(self.tick, len(self.path))
        return chip_at, since < 0 or (_SHARES[min(since, len(_SHARES) - 1)], since < _TURNED_TICKS)

    @property
    def _since(self) -> int:
        return self.tick - self._changes

    @property
    def _changes(self) -> int:
        return len(self.path) if self.path == _WHOLE_WAY else 0

    def contents(self, cells: Sequence[CellContent]) -> list[CellContent]:
        """Return ``cells`` at this tick."""
        moved, now, before = list(cells), cells[self.cell], self.before
        trace, since = (now.extra or PLAIN).trace, self._since
        if since < 0:
            now = now._replace(value=before.value, known=before.known, greedy=before.greedy, lead=before.lead)
            moved[self.cell] = with_extra(now, trace=trace._replace(error=None))
        else:
            has_turned = since < _TURNED_TICKS and bool(now.greedy) and now.greedy != before.greedy
            share = _SHARES[min(since, len(_SHARES) - 1)]
            moved[self.cell] = with_extra(now, trace=trace._replace(share=share), has_turned=has_turned)
        return moved

    def laid_over(
        self, strips: list[Strip], form: CellForm, columns: int, number_form: NumberForm, look: Look
    ) -> list[Strip]:
        """Lay the chip over a map."""
        if self.chip is None or self.tick >= len(self.path):
            return strips
        text = self.chip.text(number_form, look)
        if len(text) > form.inner:
            return strips
        (row, column), (down, right) = divmod(self.cell, columns), self.chip.way
        left = 1.0 - self.path[self.tick] if self.chip.travels else 0.0  # remaining fraction of the way
        x = round((column - left * right) * form.width) + (form.inner - len(text)) // 2
        above_number = min(form.height - 2, (form.height + 1) // 2)  # and below the agent
        y = round((row - left * down) * form.height) + above_number
        laid, strip = Strip([Segment(text, self.chip.style(look))]), strips[y]
        over = Strip.join([strip.crop(0, x), laid, strip.crop(x + len(text))])
        return [*strips[:y], over, *strips[y + 1 :]]


def motion_between(before: Snapshot, now: Snapshot, grid_map: GridMap, pace: float) -> Motion | None:
    """Return the motion of the run's next step, if any. ``pace``: steps a second, above 15 none travels."""
    last, lanes = followed_step(now), (before.run_group.shown, now.run_group.shown)
    if last is None or not last.learned or now.world is not before.world or lanes[0] != lanes[1]:
        return None
    if now.counters.step != before.counters.step + 1 or before.recipe != now.recipe:
        return None
    if before.answers.studied is not None or now.answers.studied is not None:
        return None
    cell, was = _updated_cell(last, before, grid_map)
    chip = _chip_of(now, last, grid_map.grid) if pace <= _QUICK else None
    if chip is None:
        return Motion(cell, was)
    return Motion(cell, was, chip, _WHOLE_WAY if pace <= _SLOW else _ON_THE_SEAM)


def resting(now: Snapshot, grid_map: GridMap) -> Motion | None:
    """Return the last step's finished motion."""
    last = followed_step(now)
    if last is None or not last.learned or last.updated_pair < 0 or now.answers.studied is not None:
        return None
    return Motion(*_updated_cell(last, now, grid_map)).at_rest


def _updated_cell(last: LastStep, shown: Snapshot, grid_map: GridMap) -> tuple[int, CellContent]:
    grid = grid_map.grid
    cell = int(grid.cell_of_state[shown.world.space.state_of(last.updated_pair)])
    (content,) = grid_map.contents(MapPart(*divmod(cell, grid.columns), 1, 1), shown)
    return cell, content


def _is_same_step(before: Snapshot, now: Snapshot) -> bool:
    return now.world is before.world and now.counters.last_step == before.counters.last_step


def _chip_of(snapshot: Snapshot, last: LastStep, grid: Grid) -> Chip | None:
    is_one_step = algorithm_row(snapshot.agent.learned_by[0]).updates_own_pair
    if not is_one_step or last.planned or last.others or last.updated_pair != last.pair:
        return None
    bootstraps = last.bootstrap_state != NOTHING
    number = last.bootstrap if bootstraps else last.reward
    if not isfinite(number) or not (bootstraps or last.terminated):
        return None
    start, end = (
        divmod(int(grid.cell_of_state[each]), grid.columns) for each in (last.next_state, last.state)
    )
    return Chip(number, not bootstraps, (end[0] - start[0], end[1] - start[1]))


class Mover:
    """A map's motion, driven by a timer of the app."""

    def __init__(self, panel: Panel) -> None:
        self.motion: Motion | None = None
        """The current or last motion."""
        self._panel = panel
        self._timer: Timer | None = None

    @property
    def is_running(self) -> bool:
        """True if more ticks follow."""
        return self._timer is not None

    def follow(
        self, before: Snapshot | None, now: Snapshot, grid_map: GridMap, form: CellForm | None
    ) -> None:
        """Start the motion, in cells of ``form``.

        Cells need a frame. Other jumps are at rest, so that a moment looks the same however it was reached.
        """
        if before is not None and form is not None and _is_same_step(before, now):
            return
        motion, ticks = None, self._ticks
        if form is not None and form.has_seam and ticks:
            pace = self._pace(now, ticks) if form.has_blocks else inf
            motion = None if before is None else motion_between(before, now, grid_map, pace)
            motion = motion or resting(now, grid_map)
        self._stop()
        self.motion = motion
        if motion is None or motion.is_over or not self._panel.is_attached:
            return
        if isinstance(app := self._panel.app, LinkedApp):
            self._timer = app.start_timer(1.0 / ticks, self.tick, repeats=True)

    def tick(self) -> None:
        """Draw the next tick, or the end on slow terminals."""
        before = self.motion
        if before is None:
            return
        self.motion = before._replace(tick=before.tick + 1) if self._ticks else before.at_rest
        if self.motion.is_over:
            self._stop()
        if self.motion.scene != before.scene:
            self._panel.redraw()

    def _pace(self, now: Snapshot, ticks: float) -> float:
        """Return steps per second, of a run or of key presses."""
        if now.playback.phase is Phase.RUNNING:
            return now.playback.speed or inf
        if self.motion is None or not self.is_running:
            return 0.0
        return ticks / self.motion.tick if self.motion.tick else inf

    @property
    def _ticks(self) -> float:
        panel, look = self._panel, self._panel.look
        app = panel.app if panel.is_attached else None
        if not isinstance(app, LinkedApp) or not (look.glyphs.braille and look.palette.tints):
            return 0.0
        return app.ticks if app.ticks and app.keeps_up else 0.0

    def _stop(self) -> None:
        if self._timer is not None:
            self._timer.stop()
            self._timer = None
