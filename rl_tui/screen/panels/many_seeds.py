"""Means ± standard errors of many seeds, and paired differences."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from typing import ClassVar, Final

import numpy as np
from rich.style import Style
from textual.binding import BindingType

from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.bandit import true_means
from rl_tui.runs.history import RECENT
from rl_tui.screen.draw import numbers
from rl_tui.screen.draw.canvas import Line, Piece, first_that_fits, kept, length, spelled
from rl_tui.screen.kit import snapshot_facts
from rl_tui.screen.kit.bindings import binding
from rl_tui.screen.kit.blocks import BLANK, Block, Column, Columns, Table, Text
from rl_tui.screen.kit.charts import SeedMarks
from rl_tui.screen.kit.panel import key_hints
from rl_tui.screen.kit.scrolling import ScrolledPanel, scroll_bindings
from rl_tui.screen.panels.seed_figures import (
    GREEDY,
    INTERVAL_ERRORS,
    LEAST_SEEDS,
    REGRET,
    WINNINGS,
    StudyFigure,
    deviation,
    error_text,
    estimate_text,
    figure_decimals,
    figure_text,
    in_percent,
    last_100_of,
    may_count_again,
    shown_figures,
    until_of,
    verdict_of,
)
from rl_tui.screen.theme.glyphs import Glyphs
from rl_tui.screen.theme.look import Look
from rl_tui.studies.many_seeds.figures import SeedStudy, StudyState

# Remarks below the table


ABOVE_BEST: Final = "is above the best arm's mean"


def remarks(
    study: SeedStudy, snapshot: Snapshot, look: Look, *, secret: bool, has_marks: bool
) -> Iterator[Block]:
    """Yield the remarks. ``secret`` hides a bandit's true means."""
    yield Text(_luck(snapshot, look.glyphs, secret=secret), look.palette.text, rest="   ")
    yield Text(_meaning(study, snapshot, look, has_marks=has_marks), look.palette.dim, rest="   ")


def how_typical(study: SeedStudy, snapshot: Snapshot, glyphs: Glyphs, *, secret: bool) -> str:
    """Return this seed's distance from the mean, of one figure, in standard deviations."""
    run, last_100 = study.lanes[snapshot_facts.shown_lane(study, snapshot)], last_100_of(study)
    for figure in (last_100, WINNINGS) if secret else (REGRET, last_100, WINNINGS):
        found = deviation(figure, run)
        if found is None:
            continue
        away, spread = found
        size = figure_text(spread, figure_decimals(figure, study), glyphs)
        if abs(away) <= 1.0:
            return f"{figure.in_full}: this seed is typical, within 1 standard deviation ({size}) of the mean"
        way = "above" if away > 0.0 else "below"
        far = f"{numbers.fixed(abs(away), 1, glyphs)} standard deviations of {size}"
        return f"{figure.in_full}: this seed is {far} {way} the mean"
    return ""


def _luck(snapshot: Snapshot, glyphs: Glyphs, *, secret: bool) -> str:
    """Return why recent rewards can exceed the best arm's mean."""
    mdp, recent = snapshot.world.mdp, snapshot.results.return_last_100
    if recent is None or mdp is None or not snapshot.world.is_bandit:
        return ""
    pulls = snapshot_facts.recent_name(snapshot.counters.episodes)
    if secret:
        return f"{pulls}: {_noise(snapshot, glyphs)}, so it can be above the best arm's mean"
    best = float(true_means(mdp).max())
    if mdp.drift_std > 0.0 or recent <= best:
        return ""
    shown, above = (figure_text(each, 2, glyphs) for each in (recent, best))
    return f"{pulls}, {shown}, {ABOVE_BEST}, {above}: {_noise(snapshot, glyphs)}"


def _noise(snapshot: Snapshot, glyphs: Glyphs) -> str:
    """Return how far luck moves the mean of the last pulls."""
    pulls = min(RECENT, snapshot.counters.episodes)
    noise = np.unique([] if snapshot.world.mdp is None else snapshot.world.mdp.reward_std)
    is_known = len(noise) == 1 and float(noise[0]) > 0.0  # otherwise it would reveal which arm is pulled
    off = f" by about {figure_text(float(noise[0]) / math.sqrt(pulls), 2, glyphs)}" if is_known else ""
    return f"a mean of {pulls} noisy rewards is off{off} just by luck"


def _meaning(study: SeedStudy, snapshot: Snapshot, look: Look, *, has_marks: bool) -> str:
    first = snapshot.recipe.seed
    which = "" if study.is_outdated else f" over seeds {first}–{first + study.seeds - 1}"
    meaning = f"± is the standard error{which}"
    if has_marks and any(lane.seeds for lane in study.lanes):
        glyphs = look.glyphs
        signs = f"{glyphs.eighths[2]} other seeds, {glyphs.world_mark} this seed, {glyphs.estimate} mean"
        meaning = f"{signs} ± its standard error{which}"
    if snapshot.recipe.scenario.section.drawn_from_seed:
        what = "arms" if snapshot.world.is_bandit else "world"
        meaning = f"{meaning}; each seed draws its own {what}"
    if len(study.lanes) > 1:
        meaning = f'{meaning}; "better" needs {LEAST_SEEDS} seeds, and 0 outside the brackets'
    return meaning


# The table


BRACKETS: Final = f"in brackets: the difference ± {INTERVAL_ERRORS:g} standard errors"
_BLANKS: Final = ((1, 2), (1, 1), (0, 1))  # before the first column and between columns
_LEAST_CHART: Final = 30  # cells beside the numbers
_LEAST_LANE: Final = 8  # cells of a run's number and name


def seed_table(
    study: SeedStudy, snapshot: Snapshot, figures: Sequence[StudyFigure], look: Look, charted: int
) -> Table:
    """Put this seed beside the mean, with a row per run for each of ``figures``.

    The first ``charted`` show their seeds. The first verdict explains its brackets.
    """
    is_alone, palette = len(study.lanes) == 1, look.palette
    charts: dict[int, Block] = {}
    this: list[str | None] = [None] if is_alone else []
    mean: list[str | None] = [None] if is_alone else []
    below: dict[int, list[Block]] = {}
    explains = True
    for figure in figures:
        decimals = figure_decimals(figure, study)
        heading = [] if is_alone else [None]
        own = (lane.this_seed.get(figure.id) for lane in study.lanes)
        if figure in figures[:charted]:
            spreads = enumerate(_spreads(study, figure, look), len(this) + len(heading))
            charts |= {place: spread for place, spread in spreads if spread is not None}
        this += [*heading, *(figure_text(each, decimals, look.glyphs) for each in own)]
        over = (lane.estimates.get(figure.id) for lane in study.lanes)
        mean += [*heading, *(estimate_text(each, decimals, look.glyphs) for each in over)]
        said = below[len(this) - 1] = [*_missing(study, figure, look)]
        for verdict in _verdicts(study, figure, look):
            said.append(Text(verdict, palette.text, "   ", "   "))
            if explains and "±" in verdict:
                said.append(Text(BRACKETS, palette.dim, "   ", "   "))
                explains = False
        if figure is not figures[-1] and (charts or not is_alone):
            said.append(BLANK)
    heads = _heads(until_of(study, snapshot_facts.episodes_reached(snapshot)))

    def forms() -> Iterator[Columns]:
        # figures are named in full only below the longest heads, and names of runs are shortened last
        for is_least, in_full in product((False, True), (True, False)):
            called = [figure.in_full if in_full else figure.name for figure in figures]
            least = max(_LEAST_LANE, *map(len, called)) if is_least and not is_alone else None
            names = _names(called, study, snapshot, look)
            for (head, mean_head), (margin, gap) in product(heads[: 1 if in_full else None], _BLANKS):
                yield (
                    Column("", names, palette.text, right=False, gap=margin, least=least),
                    Column(head, this, palette.text, gap=gap),
                    Column(mean_head, mean, palette.strong, gap=gap),
                )

    return Table(
        forms(), has_head=False, is_stacked=True, below=below, charts=charts, least_chart=_LEAST_CHART
    )


def _spreads(study: SeedStudy, figure: StudyFigure, look: Look) -> Iterator[SeedMarks | None]:
    seeds = [lane.seeds.get(figure.id, np.empty(0)) for lane in study.lanes]
    every, palette = np.concatenate(seeds), look.palette
    axis = (float(every.min()), float(every.max())) if len(every) else (0.0, 0.0)
    low, high = (figure_text(end, figure_decimals(figure, study), look.glyphs) for end in axis)
    inks = (palette.press,) if len(seeds) == 1 else palette.lanes
    for number, (lane, values) in enumerate(zip(study.lanes, seeds, strict=True)):
        estimate = lane.estimates.get(figure.id)
        if estimate is None or not len(values) or axis[1] - axis[0] < numbers.NEGLIGIBLE:
            yield None
            continue
        own, error = lane.this_seed.get(figure.id), estimate.stderr or 0.0
        yield SeedMarks(values, own, estimate.mean, error, axis, (low, high), inks[number % len(inks)])


def _names(called: Sequence[str], study: SeedStudy, snapshot: Snapshot, look: Look) -> list[Piece | str]:
    if len(study.lanes) == 1:
        return [Piece("", look.palette.strong), *called]
    names = [lane.name for lane in snapshot.run_group.lanes]
    if len(names) != len(study.lanes) or study.is_outdated:
        names = [""] * len(study.lanes)
    shown, styles = snapshot_facts.shown_lane(study, snapshot), look.palette.lanes
    lanes = [
        Piece(
            f"{look.glyphs.cursor if number == shown else ' '}{number + 1} {name}",
            styles[number % len(styles)] + Style(bold=number == shown),
        )
        for number, name in enumerate(names)
    ]
    return [each for figure in called for each in (Piece(figure, look.palette.strong), *lanes)]


def _heads(until: str) -> Sequence[tuple[str, str]]:
    whole, short, least = "this seed", "this", "this"
    if until:
        whole, short, least = f"this seed,{until}", f"this,{until}", until.strip()
    return (
        (whole, "mean ± error"),
        (whole, "mean ± se"),
        (short, "mean ± se"),
        (least, "mean ± se"),
        (least, "mean"),
    )


def _missing(study: SeedStudy, figure: StudyFigure, look: Look) -> Iterator[Block]:
    for number, lane in enumerate(study.lanes, 1):
        estimate = lane.estimates.get(figure.id)
        missing = study.seeds - (0 if estimate is None else estimate.count)
        if figure is GREEDY and missing > 0:
            whose = "the" if len(study.lanes) == 1 else f"run {number}'s"
            text = f"left out: {missing} of {study.seeds} seeds, where {whose} greedy policy may never end"
            yield Text(text, look.palette.dim, "   ", "   ")


def _verdicts(study: SeedStudy, figure: StudyFigure, look: Look) -> Iterator[str]:
    for number, lane in enumerate(study.lanes):
        if number != study.shown and figure.id in lane.differences:
            text = _verdict_text(study, figure, number, look)
            if text:
                yield text


def _verdict_text(study: SeedStudy, figure: StudyFigure, other: int, look: Look) -> str:
    """Return ``2 is better: higher by 22.5 ± .6 (20.7 to 24.3), in 64 of 64 seeds`` from printed numbers.

    Without enough evidence: ``so far 2 is higher by …``.
    """
    difference, glyphs = study.lanes[other].differences[figure.id], look.glyphs
    verdict = verdict_of(figure, difference)
    if verdict is None:
        return ""
    shown, that = study.shown + 1, other + 1
    if verdict.equal == verdict.count:
        return f"{shown} and {that} are equal in every seed"
    decimals = figure_decimals(figure, study)
    means = [study.lanes[number].estimates[figure.id] for number in (study.shown, other)]
    by, stderr = round(verdict.by, decimals), round(verdict.stderr, decimals) or verdict.stderr
    if all(each.count == verdict.count for each in means):
        by = abs(round(means[0].mean, decimals) - round(means[1].mean, decimals))
    ends = (by - INTERVAL_ERRORS * stderr, by + INTERVAL_ERRORS * stderr)
    low, high = (figure_text(end, decimals, glyphs) for end in ends)
    said = kept(f"{figure_text(by, decimals, glyphs)} ± {error_text(stderr, decimals, glyphs)}")
    seeds = f"in {kept(f'{verdict.better_in} of {verdict.count}')} seeds"
    equal = f", equal in {verdict.equal}" if verdict.equal else ""
    better, worse = (shown, that) if verdict.is_shown_better else (that, shown)
    than = f" than {worse}" if len(study.lanes) > 2 else ""
    way = "lower" if figure.lower_is_better else "higher"
    claim = f"{better} is better{than}: {way}" if verdict.is_seen else f"so far {better} is {way}{than}"
    return f"{claim} by {said} {kept(f'({low} to {high})')}, {seeds}{equal}"


# The panel


FIRST_SEEDS: Final = "training: the first numbers come after 8 seeds"
_LEAST_BAR: Final = 8
_MOST_BAR: Final = 32
_UNDER_WAY: Final = (StudyState.STARTING, StudyState.RUNNING)
_SAYS_WHY: Final = (StudyState.FAILED, StudyState.REFUSED)


class ManySeeds(ScrolledPanel):
    """One seed beside the mean of many."""

    BINDINGS: ClassVar[list[BindingType]] = [
        *scroll_bindings("many_seeds"),
        binding("enter", "screen.do('seeds.count_again')", "many_seeds.count_again", "Count again"),
    ]
    title = "Many seeds"

    def blocks(self, snapshot: Snapshot | None, left_out: int) -> Iterator[Block]:
        """Yield the results so far."""
        study, look = None if snapshot is None else snapshot.study, self.look
        if snapshot is None or study is None:
            yield Text(FIRST_SEEDS, look.palette.dim)
            return
        study = in_percent(study)
        yield from _how_far(study, snapshot, look)
        if not study.lanes or not study.seeds:
            return
        secret, gap = snapshot_facts.hides_greedy(snapshot), (BLANK,) if left_out < 2 else ()
        if not study.is_outdated:
            typical = how_typical(study, snapshot, look.glyphs, secret=secret)
            yield Text(typical, look.palette.strong, rest="   ")
        yield from gap
        figures = shown_figures(study, secret=secret)
        charted = (len(figures), 1, 0)[left_out]
        yield seed_table(study, snapshot, figures, look, charted)
        if snapshot_facts.hides_means(snapshot) and not snapshot_facts.keeps_back(snapshot, "answer"):
            yield Text("w h shows regret and best arm", look.palette.dim, rest="   ")
        yield from gap
        yield from remarks(study, snapshot, look, secret=secret, has_marks=charted > 0)

    def keys(self, snapshot: Snapshot | None) -> Sequence[str]:
        """Return the keys to close and train again."""
        is_over = may_count_again(None if snapshot is None else snapshot.study)
        return [*key_hints(("enter: train again", "enter: again") if is_over else (), ("esc: close",))]


def _how_far(study: SeedStudy, snapshot: Snapshot, look: Look) -> Iterator[Block]:
    palette = look.palette
    if study.most:
        yield _Progress(study, _span(study, snapshot))
    elif study.state is StudyState.STARTING:
        yield Text("starting", palette.dim)
    if study.state in _UNDER_WAY:
        yield Text("" if study.seeds else FIRST_SEEDS, palette.dim)
        yield Text(study.how_long, palette.dim)
    if study.is_outdated:
        yield Text("outdated, the run has changed: enter repeats the study", palette.strong)
    if study.state is StudyState.OUT_OF_TIME:
        yield Text("stopped: CPU-time limit reached", palette.strong)
    yield Text(study.message, palette.strong if study.state in _SAYS_WHY else palette.text)


@dataclass(frozen=True, slots=True)
class _Progress:
    study: SeedStudy
    span: str

    def lines(self, width: int, look: Look) -> Sequence[Line]:
        palette, glyphs, study = look.palette, look.glyphs, self.study
        is_whole = study.seeds >= study.most
        count = f"{study.seeds}" if is_whole else f"{study.seeds} of {study.most}"
        said = Piece(f" {count} seeds", palette.strong)
        spans = [
            Piece(glyphs.separated(f" · {form}"), palette.dim)
            for form in (self.span, self.span.partition(" ")[2])
            if form
        ]
        forms: list[Line] = [*([said, form] for form in spans), [said], [Piece(f" {count}", palette.strong)]]
        fitting = first_that_fits(forms, width, look)
        whole = [*forms[0], Piece(glyphs.separated(" · low priority"), palette.dim)]
        if study.state in _UNDER_WAY and length(spelled(whole, look)) + _LEAST_BAR + 2 <= width:
            fitting = whole
        room = min(_MOST_BAR, width - length(spelled(fitting, look)) - 2)
        if is_whole or room < _LEAST_BAR:
            return [fitting]
        done = max(1, room * study.seeds // study.most) if study.seeds else 0
        bar = Piece(f" {glyphs.track_done * done}", palette.press)
        return [[*fitting, bar, Piece(glyphs.track_rest * (room - done), palette.slider_rest)]]


def _span(study: SeedStudy, snapshot: Snapshot) -> str:
    pulls = snapshot.world.is_bandit
    unit, last = ("pull" if pulls else "episode", study.episodes) if study.episodes else ("step", study.steps)
    if not last:
        return ""
    return f"{unit}s 1–{last:,}" if last > 1 else f"{unit} 1"
