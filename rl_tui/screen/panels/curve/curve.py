"""The return curve: an area for one run, lines for several.

All cell arrays are [rows, columns].
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache
from typing import Final

import numpy as np
from rich.cells import cell_len
from rich.style import Style
from textual.strip import Strip

from rl_tui.agents.catalogue import algorithm_row
from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.runs.answers.policy_kind import PolicyKind
from rl_tui.runs.recipe import Recipe
from rl_tui.screen.draw import braille
from rl_tui.screen.draw.axes import apart
from rl_tui.screen.draw.braille import Steps
from rl_tui.screen.draw.canvas import Canvas, Line, Piece, shortened, strips_of, wrapped
from rl_tui.screen.draw.chart_plot import Plot
from rl_tui.screen.draw.scale import Scale, settled
from rl_tui.screen.kit import snapshot_facts
from rl_tui.screen.kit.panel import Panel
from rl_tui.screen.panels.curve import area as areas
from rl_tui.screen.panels.curve.data import CurveData, curve_data, episode_axis, is_decided, is_over, unit_of
from rl_tui.screen.panels.curve.seed_band import lane_cells, seed_cells, seed_remark, with_room_for
from rl_tui.screen.panels.curve.text import (
    AGENT,
    BEST_ARM,
    GREEDY,
    LEFT,
    OPTIMAL,
    TITLES,
    LineLabel,
    PlotColumns,
    amount,
    barren_words,
    decimals_of_labels,
    gap_note,
    heads,
    labels,
    lane_heads,
    lane_labels,
    lane_remark,
    nothing_yet,
    off_axis_note,
    plot_columns,
    remark,
    steps_note,
)
from rl_tui.screen.panels.policies.studied import policy_ink
from rl_tui.screen.panels.timeline import event_notes
from rl_tui.screen.theme.look import Look, Palette
from rl_tui.worlds.mdp.space import IntArray

# The chart


LEAST_WIDTH: Final = 14
LEAST_HEIGHT: Final = 2
LEAST_WITH_LINES: Final = 3  # rows of a plot with lines over the area of one run
LEAST_IN_FULL: Final = 7  # rows of a plot with three numbers at the left
_LEAST_WITH_NAMES: Final = 60  # columns of the curve in one row
_LEAST_LEFT: Final = 0.2  # share of the columns. Less looks like a mistake
_EXACT: Final = 1e-6  # share of the axis: largest rounding error of a number at the left
_ARROWS_APART: Final = 8  # columns between the arrows of a line below the axis
_CHANGES_APART: Final = 8  # columns: with denser changes of the world, their lines would hide the curve
# Contents of a cell. From _CELLS on: the area, a cell of the band, or the line or band of a run
_NOTHING, _CHANGE, _OPTIMUM, _STUDIED, _OUTLIER, _GREEDY, _CELLS = range(7)


def _draw_chart(
    data: CurveData, plot: Plot, columns: PlotColumns, look: Look, size: tuple[int, int], *, has_band: bool
) -> list[Strip]:
    width, height = size
    canvas = Canvas(width, height, look.palette.text)
    decimals = decimals_of_labels(plot.scale)
    names = (lane_labels if data.lanes else labels)(data, look, decimals, columns.labels)
    if width < LEAST_WIDTH or height < LEAST_HEIGHT:
        for y, label in enumerate(names[:height]):
            canvas.put(0, y, shortened(label.text, width, look.glyphs.ellipsis), label.style)
        return canvas.strips()
    if data.furthest:
        _draw_numbers(canvas, plot, look)
        if data.lanes or (data.seeds and plot.rows >= LEAST_WITH_LINES):
            _draw_lines(canvas, plot, data, look)
        else:
            _draw_area(canvas, plot, data, look, has_band=has_band)
    else:
        _put_message(canvas, plot, nothing_yet(data), look)
    for label, row in _rows_of(names[: plot.rows], plot):
        canvas.put(width - columns.labels + label.gap, row, label.text, label.style)
    if (data.barren or data.unlearned or data.cut_at) and not data.lanes:
        _put_message(canvas, plot, barren_words(data, look.glyphs), look, at_top=True)
    return canvas.strips()


def _draw_numbers(canvas: Canvas, plot: Plot, look: Look) -> None:
    low, high = plot.scale.low, plot.scale.high
    values = (high, (low + high) / 2.0, low) if plot.rows >= LEAST_IN_FULL else (high, low)
    exact = [all(abs(round(each, n) - each) < _EXACT * (high - low) for each in values) for n in range(5)]
    decimals = exact.index(True) if any(exact) else decimals_of_labels(plot.scale)
    for value in values:
        text = amount(value, decimals, look.glyphs, LEFT)
        canvas.put(max(0, LEFT - 1 - len(text)), plot.row(value), text, look.palette.dim)


def _draw_area(canvas: Canvas, plot: Plot, data: CurveData, look: Look, *, has_band: bool) -> None:
    area, palette = areas.area_of(plot, data.mean), look.palette
    if has_band:
        codes, pixels = areas.band_cells(plot, areas.middle_half(plot, data.curve, data.mean), data.mean)
        kind = np.where(codes > 0, _CELLS + pixels, _NOTHING)
    else:
        codes = np.array([ord(each) for each in look.glyphs.eighths])[area.eighths]
        kind = np.where(area.eighths > 0, _CELLS, _NOTHING)
    has_lines = plot.rows >= LEAST_WITH_LINES or not len(data.mean.means)
    if has_lines:
        _put_behind(codes, kind, plot, data, look)
        _put_greedy(codes, kind, plot, data.greedy, look)
        _drop_remnants(codes, kind, plot, data)
    for row, columns, sign in zip((-1, 0), (area.below, area.above), look.glyphs.off_axis, strict=True):
        codes[row, columns], kind[row, columns] = ord(sign), _OUTLIER
    if has_lines:
        _put_outliers(codes, kind, plot, data.greedy, _GREEDY, look)
    if has_band:
        ground = pixels % 4
        bands = ([each] * 4 for each in areas.band_styles(palette))
        styles = [*_styles(data, palette, areas.pixel_styles(palette)), *bands]
    else:
        shades = (
            areas.area_styles(palette, plot.rows) if look.glyphs.braille else (palette.episodes,) * plot.rows
        )
        is_covered = (kind == _CELLS) | ((area.eighths == areas.FULL) & look.glyphs.braille)
        ground = is_covered * np.arange(1, plot.rows + 1)[:, None]
        styles = [*_styles(data, palette, shades), [palette.episodes, *shades]]
    _put_cells(canvas, plot, codes, kind, ground, styles)


def _draw_lines(canvas: Canvas, plot: Plot, data: CurveData, look: Look) -> None:
    codes, kind = np.zeros((2, plot.rows, plot.columns), dtype=np.int64)
    _put_behind(codes, kind, plot, data, look)
    palette, runs = look.palette, len(data.lines) - 1
    first = _CELLS - 1  # runs are counted from 1
    bands, whose = seed_cells(plot, data.seeds, look)
    codes[bands > 0], kind[bands > 0] = bands[bands > 0], first + runs + whose[bands > 0]
    cells = lane_cells(plot, data.lines, look, are_runs=bool(data.lanes))
    there = cells.line >= 0
    codes[there] = cells.codes[there]
    kind[there] = np.where(cells.line[there] == 0, _GREEDY, first + cells.line[there])
    _drop_remnants(codes, kind, plot, data)
    for number, line in enumerate(data.lines):
        _put_outliers(codes, kind, plot, line, first + number if number else _GREEDY, look)
    inks = palette.lanes[:runs] if data.lanes else (palette.episodes,)
    dimmed = [style + Style(dim=True) for style in inks] if data.lanes else [palette.dim]
    styles = [*_styles(data, palette, ()), *([each] for each in (*inks, *dimmed))]
    _put_cells(canvas, plot, codes, kind, np.zeros_like(kind), styles)


def _put_behind(codes: IntArray, kind: IntArray, plot: Plot, data: CurveData, look: Look) -> None:
    if data.optimum is not None:
        row, along = _level(plot, data, data.optimum)
        free = np.flatnonzero(kind[row] == _NOTHING)
        free = free[(free >= along.start) & (free < along.stop) & (free % 2 == 0)]
        # in dots like the greedy line, so that equal values have equal heights
        sign = plot.level_code(data.optimum) if look.glyphs.braille else ord(look.glyphs.dashes)
        codes[row, free], kind[row, free] = sign, _OPTIMUM
    changes = {min(plot.column(each.episodes), plot.columns - 1) for each in data.world_changes}
    if len(changes) * _CHANGES_APART <= plot.columns:
        for column in changes:
            nothing = kind[:, column] == _NOTHING
            codes[nothing, column], kind[nothing, column] = ord(look.glyphs.zero_line), _CHANGE
    if data.studied is not None and data.studied.value >= plot.scale.low:
        row, along = _level(plot, data, data.studied.value)
        codes[row, along], kind[row, along] = ord(look.glyphs.dashes), _STUDIED


def _put_greedy(codes: IntArray, kind: IntArray, plot: Plot, greedy: Steps, look: Look) -> None:
    if look.glyphs.braille:
        dots = plot.braille_line(greedy)
        there = dots > braille.BLANK
    else:
        there = plot.line_dots(greedy, plot.columns, plot.rows)
        dots = np.full_like(codes, ord("o"))
    codes[there], kind[there] = dots[there], _GREEDY


def _drop_remnants(codes: IntArray, kind: IntArray, plot: Plot, data: CurveData) -> None:
    """Erase the optimal level if other lines leave too little of it."""
    left = kind == _OPTIMUM
    columns = (
        0 if data.optimum is None else len(range(*_level(plot, data, data.optimum)[1].indices(plot.columns)))
    )
    if left.sum() < _LEAST_LEFT * columns:
        codes[left], kind[left] = 0, _NOTHING


def _level(plot: Plot, data: CurveData, value: float) -> tuple[int, slice]:
    end = min(plot.column(data.furthest) + 1, plot.columns)
    return plot.row(value), slice(plot.column(data.world_since), end)


def _put_outliers(codes: IntArray, kind: IntArray, plot: Plot, line: Steps, own: int, look: Look) -> None:
    sign = ord(look.glyphs.off_axis[0])
    is_taken = (codes[-1] == sign) & (kind[-1] != _OUTLIER)  # by another line
    away = plot.below(line) & ~is_taken
    if not away.any():
        return
    places = np.arange(plot.columns)
    begins = away & ~np.concatenate(([False], away[:-1]))
    since = places - np.maximum.accumulate(np.where(begins, places, 0))
    there = away & (since % _ARROWS_APART == 0)
    codes[-1, there], kind[-1, there] = sign, own


def _styles(data: CurveData, palette: Palette, grounds: tuple[Style, ...]) -> list[list[Style]]:
    studied = palette.text if data.studied is None else policy_ink(data.studied.kind, palette)
    return _styles_on(palette, studied, grounds)


@lru_cache(64)
def _styles_on(palette: Palette, studied: Style, grounds: tuple[Style, ...]) -> list[list[Style]]:
    over = [Style(bgcolor=ground.color) for ground in grounds]
    inks = (palette.text, palette.dim, palette.dim, studied, palette.dim, palette.greedy_line)
    return [[ink, *(ink + ground for ground in over)] for ink in inks]


def _put_cells(
    canvas: Canvas,
    plot: Plot,
    codes: IntArray,
    kind: IntArray,
    ground: IntArray,
    styles: Sequence[Sequence[Style]],
) -> None:
    text = np.where(codes > 0, codes, ord(" ")).astype("<u4").tobytes().decode("utf-32-le")
    for row, (kinds, grounds) in enumerate(zip(kind.tolist(), ground.tolist(), strict=True)):
        line = text[row * plot.columns : (row + 1) * plot.columns]
        cells = [styles[own][under] for own, under in zip(kinds, grounds, strict=True)]
        canvas.put_cells(plot.left, row, line, cells)


def _put_message(
    canvas: Canvas, plot: Plot, words: Sequence[str], look: Look, *, at_top: bool = False
) -> None:
    words = [look.glyphs.separated(each) for each in words]
    whole = " ".join(words)
    lines = _wrapped_parts((whole,) if len(whole) <= plot.columns else words, plot, look)
    if len(lines) > plot.rows:
        lines = _wrapped_parts((words[0].rstrip(":"),), plot, look)
    first = 0 if at_top else max(0, (plot.rows - len(lines)) // 2)
    for row, line in enumerate(lines[: plot.rows], first):
        canvas.put(plot.left, row, " " * plot.columns, look.palette.text)
        for piece in line:
            text = f" {piece.text} " if cell_len(piece.text) + 2 <= plot.columns else piece.text
            canvas.put(plot.left + (plot.columns - cell_len(text)) // 2, row, text, piece.style)


def _wrapped_parts(parts: Sequence[str], plot: Plot, look: Look) -> list[Line]:
    return [line for part in parts for line in wrapped(part, plot.columns, look.palette.text, look)]


def _rows_of(names: Sequence[LineLabel], plot: Plot) -> list[tuple[LineLabel, int]]:
    downwards = [label for _, label in sorted(enumerate(names), key=lambda each: (-each[1].value, -each[0]))]
    with_value = [label for label in downwards if label.value > -math.inf]
    rows = apart([plot.row(label.value) for label in with_value], plot.rows)
    free = [row for row in reversed(range(plot.rows)) if row not in rows]
    return [*zip(with_value, rows, strict=True), *zip(downwards[len(with_value) :], free, strict=False)]


def _spark_line(data: CurveData, scale: Scale, look: Look, width: int, words: str) -> Line:
    columns = width - cell_len(words) - 2
    if columns < 1 or not len(data.mean.means):
        return [Piece(words, look.palette.dim)]
    marks = look.glyphs.eighths
    area = areas.area_of(Plot(0, columns, 1, data.mean.finished, scale), data.mean)
    signs = "".join(marks[max(1, each)] for each in area.eighths[0].tolist())
    return [Piece(signs, look.palette.episodes), Piece(f"  {words}", look.palette.dim)]


Words = tuple[str, ...]


class ReturnCurve(Panel, can_focus=True):
    """The curve, whose vertical axis changes in steps."""

    scale: Scale | None = None
    _shows = False, False  # steps, errors of V
    _band: tuple[object, bool] = (None, False)
    _hints: Words = ()
    _unit = "episode"

    def begin_with(self, recipe: Recipe) -> None:
        """Set the title before the first snapshot."""
        plans = algorithm_row(recipe.algorithm).planner
        self._unit = unit_of(plans=plans, is_bandit=recipe.scenario.is_bandit)

    @property
    def hints(self) -> Words:
        """The keys that replace the caption."""
        return self._hints

    @hints.setter
    def hints(self, hints: Words) -> None:
        if hints != self._hints:
            self._hints = hints
            self.redraw()

    def depends_on(self, snapshot: Snapshot) -> object:
        """Return results, exact values and exploration."""
        values, episodes = snapshot.agent.hyperparameters, snapshot.counters.episodes
        answers, playback, lanes = snapshot.answers, snapshot.playback, snapshot.run_group.lanes
        return (
            *(
                snapshot.world,
                snapshot.world_changes,
                snapshot.results,
                snapshot.study,
                snapshot.value_errors,
            ),
            *(snapshot.agent.algorithm, values.policy, values.epsilon_at(episodes), is_decided(snapshot)),
            *(episodes, snapshot.program is None, is_over(snapshot), snapshot_facts.has_estimates(snapshot)),
            *(snapshot.timeline.in_past, snapshot.timeline.furthest, snapshot.counters.episode_step > 0),
            episode_axis(snapshot).right,
            *(snapshot.exact_answer.expected_return, snapshot.exact_answer.refused),
            *(answers.is_hidden, answers.kept_back, answers.first_update, answers.studied),
            *(answers.policies.get(PolicyKind.BEHAVIOUR), snapshot_facts.studied_answer(snapshot)),
            *(playback.phase is Phase.SPENT, _runs(snapshot), snapshot_facts.passes_too_fast(snapshot)),
            snapshot.run_group.shown,
            *((each.name, each.algorithm, each.episodes, each.results) for each in lanes),
        )

    def show(self, snapshot: Snapshot) -> None:
        """Draw ``snapshot``. The past keeps the present's axis."""
        if snapshot_facts.is_new_run(self.snapshot, snapshot):
            self.scale = self.drawn_from = None
        super().show(snapshot)

    def picture(self, snapshot: Snapshot | None, width: int, height: int) -> list[Strip]:
        """Draw the curve."""
        if snapshot is None:
            self.heading = self.fitting([TITLES[self._unit]], width)
            return strips_of(
                [[Piece(f" {snapshot_facts.BEING_BUILT}", self.look.palette.dim)]], width, height, self.look
            )
        data = curve_data(snapshot)
        scale = self._settled(data, snapshot)
        if height == 1:
            return strips_of([self._row(data, scale, width)], width, 1, self.look)
        columns = plot_columns(snapshot, self.look, width)
        plot = Plot(columns.left, columns.columns, max(1, height), data.axis.right, scale)
        key = plot, bool(data.lanes), data.seeds, data.is_of_steps, data.is_of_errors
        if self._band[0] != key or not _runs(snapshot):
            is_plain = data.lanes or data.seeds or data.is_bandit or not data.furthest
            is_plain = is_plain or data.is_of_steps or data.is_of_errors
            has_band = not is_plain and areas.says_something(plot, data.curve, data.mean, self.look)
            self._band = key, has_band
        drawn = replace(data, greedy=plot.stepped(data.greedy))
        self.heading = self._headed(snapshot, data, drawn, plot, columns, width)
        return _draw_chart(drawn, plot, columns, self.look, (width, height), has_band=self._band[1])

    def _settled(self, data: CurveData, snapshot: Snapshot) -> Scale:
        if (shows := (data.is_of_steps, data.is_of_errors)) != self._shows:
            self.scale, self._shows = None, shows
        if snapshot.timeline.in_past and self.scale is not None:
            return self.scale
        low, high = with_room_for(data.range, data.seeds)
        scale = settled(self.scale if _runs(snapshot) else None, low, high)
        if low or high:
            # before any episode nothing uses the scale, and it must not depend on when exact values arrive
            self.scale = scale
        return scale

    def _headed(
        self,
        snapshot: Snapshot,
        data: CurveData,
        drawn: CurveData,
        plot: Plot,
        columns: PlotColumns,
        width: int,
    ) -> str:
        glyphs, decimals = self.look.glyphs, decimals_of_labels(plot.scale)
        titles = heads(data, has_band=self._band[1])
        if self.hints:
            return self.fitting([*(f"{titles[-1]} · {each}" for each in self.hints), titles[-1]], width)
        # at full speed, numbers would change in every frame
        is_calm = not snapshot_facts.passes_too_fast(snapshot)
        notes: list[Words] = [remark(snapshot, data, glyphs, decimals, with_figures=is_calm)]
        if data.lanes:
            titles = lane_heads(data, titles, glyphs)
            notes = [lane_remark(data, self.look, counts_seeds=snapshot.program is None), steps_note(data)]
        elif not columns.labels and is_calm and (brief := self._brief(data, decimals)):
            titles = f"{titles[-1]} · {brief}", titles[-1]
        elif data.seeds:
            notes.insert(0, seed_remark(data.seeds, self.look))
        has_figures = is_calm and snapshot.program is None
        notes.append(off_axis_note(drawn, plot, glyphs, decimals, with_figures=has_figures))
        notes.append(gap_note(data, plot))
        if self.is_explained and is_calm:
            notes.append(event_notes(snapshot, self.look, width))
        notes = [each for each in notes if each]
        head = self.fitting(titles[1:] if notes and len(titles) > 2 else titles, width)
        for note in notes:
            head = self.fitting([f"{head} · {form}" for form in note], width) or head
        return head

    def _row(self, data: CurveData, scale: Scale, width: int) -> Line:
        decimals, look = decimals_of_labels(scale), self.look
        if width < _LEAST_WITH_NAMES:
            return _spark_line(data, scale, look, width, self._brief(data, decimals))
        title = f"{heads(data, has_band=False)[-1]}  "
        words = self._brief(data, decimals, with_optimum=True) or " ".join(nothing_yet(data))
        line = _spark_line(data, scale, look, width - len(title), words)
        return [Piece(title, look.palette.strong), *line]

    def _brief(self, data: CurveData, decimals: int, *, with_optimum: bool = False) -> str:
        numbered = [(f"{lane.number} ", lane.value) for lane in data.lanes]
        best = (f"{BEST_ARM[1] if data.is_bandit else OPTIMAL} ", data.optimum if with_optimum else None)
        numbered = numbered or [(f"{AGENT} ", data.mean_now), (f"{GREEDY} ", data.greedy_now), best]
        glyphs = self.look.glyphs
        return "  ".join(f"{name}{amount(x, decimals, glyphs)}" for name, x in numbered if x is not None)


def _runs(snapshot: Snapshot) -> bool:
    return snapshot.playback.phase is Phase.RUNNING
