"""The band of many seeds, and the lines of runs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np

from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.draw import braille
from rl_tui.screen.draw.braille import Steps
from rl_tui.screen.draw.chart_plot import Plot
from rl_tui.screen.kit.snapshot_facts import current_study, episodes_reached
from rl_tui.screen.panels.curve.moving_mean import moving_mean
from rl_tui.screen.panels.seed_figures import LAST_100, decimals_of, estimate_text, last_100_of, until_of
from rl_tui.screen.theme.look import Look
from rl_tui.studies.many_seeds.figures import Estimate
from rl_tui.worlds.mdp.space import BoolArray, IntArray

_ERRORS: Final = 2.0  # standard errors on either side of the mean
_FULL: Final = 0x28FF
_LATE: Final = 0.25  # share of bins after which the axis makes space for the band


@dataclass(frozen=True, slots=True, eq=False)
class SeedBand:
    """One run's mean return ± two standard errors, to the episode ``until`` (empty: the current one)."""

    number: int
    seeds: int
    until: str
    recent: str
    band: Steps
    last_100: Estimate | None

    @property
    def value(self) -> float | None:
        """The band's last value, or None."""
        return None if self.last_100 is None else self.last_100.mean


def seed_bands(snapshot: Snapshot, window: int) -> tuple[SeedBand, ...]:
    """Return each run's band."""
    study = current_study(snapshot)
    if study is None:
        return ()
    reached = episodes_reached(snapshot)
    furthest = max(reached)
    until, recent = until_of(study, reached), last_100_of(study).name
    found = []
    for number, lane in enumerate(study.lanes, 1):
        end = lane.curve.episode.astype(np.float64)
        start = np.concatenate(([0.0], end[:-1])) if len(end) else end
        there = start < furthest
        # the error of such a mean is at most the mean of the errors
        mean, error = (
            moving_mean(lane.curve.episode, each, window).means[there]
            for each in (lane.curve.mean, lane.curve.stderr)
        )
        reach = _ERRORS * error
        band = Steps(start[there], np.minimum(end[there], furthest), mean - reach, mean + reach)
        last_100 = lane.estimates.get(LAST_100.id)
        found.append(SeedBand(number, study.seeds, until, recent, band, last_100))
    return tuple(found)


def with_room_for(known: tuple[float, float], seeds: Sequence[SeedBand]) -> tuple[float, float]:
    """Widen ``known`` to the means over seeds."""
    means = [(each.band.low + each.band.high) / 2.0 for each in seeds]
    values = np.concatenate((*(mean[int(_LATE * len(mean)) :] for mean in means), known))
    values = values[np.isfinite(values)]
    return float(values.min()), float(values.max())


def seed_cells(plot: Plot, seeds: Sequence[SeedBand], look: Look) -> tuple[IntArray, IntArray]:
    """Return characters (0: none) and run numbers, [rows, columns] each."""
    codes = np.zeros((plot.rows, plot.columns), dtype=np.int64)
    whose = np.zeros_like(codes)
    turn = np.arange(plot.columns) // braille.TURN % max(1, len(seeds))  # where bands overlap
    for number, each in enumerate(seeds):
        if look.glyphs.braille:
            columns, rows = plot.columns * braille.DOTS_ACROSS, plot.rows * braille.DOTS_DOWN
            drawn = braille.braille_codes(plot.filled_dots(each.band, columns, rows))
            there = drawn > braille.BLANK
        else:
            there = plot.filled_dots(each.band, plot.columns, plot.rows)
            drawn = np.full_like(codes, ord("="))
        there &= (codes == 0) | (turn == number)
        codes[there], whose[there] = drawn[there], each.number
    return codes, whose


def seed_remark(seeds: Sequence[SeedBand], look: Look) -> tuple[str, ...]:
    """Return forms of a note on the bands."""
    estimates = {each.number: each.last_100 for each in seeds if each.last_100 is not None}
    decimals = decimals_of([*estimates.values()])
    texts = [f"{number}) {estimate_text(each, decimals, look.glyphs)}" for number, each in estimates.items()]
    sign = chr(_FULL) if look.glyphs.braille else "="
    band = f"{sign} {seeds[0].seeds} seeds: mean ± 2 errors"
    if not texts:
        return (band,)
    means, which = ", ".join(texts), f"{sign} {seeds[0].seeds} seeds{seeds[0].until}"
    return (
        f"one seed beside each name; {band}; {seeds[0].recent}{seeds[0].until}: {means}",
        f"{band}; {seeds[0].recent}{seeds[0].until}: {means}",
        f"{which}, {seeds[0].recent}: {means}",
        f"{which}: {means}",
        band,
    )


# Lines of several runs, and of one run over its band


_MARKS_APART: Final = 16  # columns between two numbers on a line


class LaneCells(NamedTuple):
    """Characters (0: none), and lines: −1 none, 0 greedy, n run n."""

    codes: IntArray
    line: IntArray


def lane_cells(plot: Plot, lines: Sequence[Steps], look: Look, *, are_runs: bool) -> LaneCells:
    """Draw the greedy line and all means. Runs get numbers where colours do not distinguish them."""
    if look.glyphs.braille:
        layers = np.stack([plot.braille_line(line) for line in lines])
        layers[layers == braille.BLANK] = 0
    else:
        dots = np.stack([plot.line_dots(line, plot.columns, plot.rows) for line in lines])
        signs = [ord("o"), *(ord(str(number)) for number in range(1, len(lines)))]
        layers = dots * np.array(signs)[:, None, None]
    there = layers > 0
    in_front = there.copy()
    # a greedy line that jumps between policies would cover the runs
    in_front[0] &= ~(there[1:].any(axis=0) & (there[0].sum(axis=0) > 1))
    line = braille.in_turns(in_front)
    codes = np.take_along_axis(layers, np.maximum(line, 0)[None], axis=0)[0]
    codes[line < 0] = 0
    if are_runs and look.glyphs.braille and not look.palette.tells_lanes_apart:
        _mark(codes, line, there)
    return LaneCells(codes, line)


def _mark(codes: IntArray, line: IntArray, there: BoolArray) -> None:
    lanes = len(there) - 1
    for number in range(1, lanes + 1):
        first = (number - 1) * _MARKS_APART // lanes + 1
        for column in range(first, codes.shape[1], _MARKS_APART):
            rows = np.flatnonzero(there[number, :, column])
            if len(rows):
                codes[rows[0], column], line[rows[0], column] = ord(str(number)), number
