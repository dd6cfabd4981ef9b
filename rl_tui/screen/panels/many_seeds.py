"""The runs on screen under many seeds: each mean ± its standard error, beside this one seed.

With several runs, the paired differences to the run shown are listed too.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import ClassVar, Final, NamedTuple

import numpy as np
from rich.cells import cell_len
from rich.style import Style
from textual.binding import BindingType
from textual.strip import Strip

from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.bandit import true_means
from rl_tui.runs.history import RECENT
from rl_tui.screen.draw import numbers
from rl_tui.screen.draw.canvas import (
    Line,
    Piece,
    first_that_fits,
    kept,
    length,
    shortened,
    spelled,
    strips_of,
    wrapped,
)
from rl_tui.screen.draw.to_ascii import to_ascii
from rl_tui.screen.kit.bindings import binding
from rl_tui.screen.kit.scrolled_panel import ScrolledPanel, scroll_bindings
from rl_tui.screen.kit.snapshot_facts import (
    episodes_reached,
    hides_greedy,
    hides_means,
    keeps_back,
    recent_name,
    shown_lane,
)
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
from rl_tui.worlds.drawing import Arms

# Remarks below the table


ABOVE_BEST: Final = "is above the best arm's mean"


def remarks(study: SeedStudy, snapshot: Snapshot, look: Look, width: int, *, secret: bool) -> Iterator[Line]:
    """Yield the lines; ``secret`` says that a bandit's true means must not show."""
    palette, glyphs = look.palette, look.glyphs
    usual = "" if study.is_outdated else _how_usual(study, shown_lane(study, snapshot), glyphs, secret=secret)
    texts = [
        (_luck_now(snapshot, glyphs, secret=secret), palette.text),
        (usual, palette.text),
        (_luck_of_100(snapshot, glyphs, secret=secret), palette.text),
        (_arms(study, snapshot), palette.dim),
        (_meaning(study), palette.dim),
    ]
    for text, style in texts:
        if text:
            yield from wrapped(text, width, style, look, " ", "   ")


def _how_usual(study: SeedStudy, shown: int, glyphs: Glyphs, *, secret: bool) -> str:
    """Return how far this seed of the lane shown is from the mean, in standard deviations of the seeds."""
    lane, last_100 = study.lanes[shown], last_100_of(study)
    for figure in (last_100, WINNINGS) if secret else (REGRET, last_100, WINNINGS):
        found = deviation(figure, lane)
        if found is None:
            continue
        away, spread = found
        sizes = kept(f"(one is {figure_text(spread, figure_decimals(figure, study), glyphs)})")
        if abs(away) <= 1.0:
            return f"this seed is a usual one: its {figure.name} is within one standard deviation {sizes}"
        way = "above" if away > 0.0 else "below"
        return (
            f"this seed's {figure.name} is {numbers.fixed(abs(away), 1, glyphs)} standard deviations {sizes} "
            f"{way} the mean"
        )
    return ""


def _luck_now(snapshot: Snapshot, glyphs: Glyphs, *, secret: bool) -> str:
    """Return that the mean of the last 100 pulls is above the best arm's, where it is, and why."""
    mdp, recent = snapshot.world.mdp, snapshot.results.return_last_100
    is_bandit = isinstance(snapshot.world.drawing, Arms)
    if not is_bandit or secret or mdp is None or mdp.drift_std > 0.0 or recent is None:
        return ""
    best = float(true_means(mdp).max())
    if recent <= best:
        return ""
    shown, above = (figure_text(each, 2, glyphs) for each in (recent, best))
    pulls = recent_name(snapshot.counters.episodes)
    return f"{pulls}, {shown}, {ABOVE_BEST}, {above}: {_noise(snapshot, glyphs)}"


def _luck_of_100(snapshot: Snapshot, glyphs: Glyphs, *, secret: bool) -> str:
    """Return that it may be, while the means are secret."""
    if not secret or snapshot.results.return_last_100 is None:
        return ""
    pulls = recent_name(snapshot.counters.episodes)
    return f"{pulls}: {_noise(snapshot, glyphs)}, so it can be above the best arm's mean"


def _noise(snapshot: Snapshot, glyphs: Glyphs) -> str:
    """Return how far the mean of the last pulls is off by luck; a number where all arms have one noise."""
    pulls = min(RECENT, snapshot.counters.episodes)
    noise = np.unique([] if snapshot.world.mdp is None else snapshot.world.mdp.reward_std)
    is_known = len(noise) == 1 and float(noise[0]) > 0.0  # or else it would tell which arm is pulled
    off = f" by about {figure_text(float(noise[0]) / math.sqrt(pulls), 2, glyphs)}" if is_known else ""
    return f"a mean of {pulls} noisy rewards is off{off} by luck alone"


def _arms(study: SeedStudy, snapshot: Snapshot) -> str:
    """Return whether the worlds of the seeds are different ones."""
    if not snapshot.recipe.scenario.section.drawn_from_seed:
        return ""
    what = "arms" if isinstance(snapshot.world.drawing, Arms) else "a world"
    return f"each seed draws {what} of its own"


def _meaning(study: SeedStudy) -> str:
    """Return what stands behind ±, and when a lane is called better."""
    error = "± is the standard error: how far a mean of so many seeds is typically off"
    pairs = (
        f"lanes are compared seed by seed; one is called better, from {LEAST_SEEDS} seeds on, "
        "where 0 is outside the brackets"
    )
    return error if len(study.lanes) == 1 else f"{error}; {pairs}"


# The table


BRACKETS: Final = f"in brackets: the difference ± {INTERVAL_ERRORS:g} standard errors"
_BLANKS: Final = ((1, 2), (1, 1), (0, 1))  # before the first column and between columns
_LEAST_LANE: Final = 8  # cells of the name of a lane, with its number


class _Row(NamedTuple):
    """A row of the table; a heading stands above its figures."""

    name: str
    this: str
    mean: str
    style: Style
    is_head: bool = False


class _Form(NamedTuple):
    """How wide the columns are, and what stands above them. Stacked, each figure has a line of its own."""

    width: int
    name: int
    this: int = 0
    mean: int = 0
    margin: int = 1
    gap: int = 1
    heads: tuple[str, str] = ("", "")
    is_stacked: bool = False


def table_lines(
    study: SeedStudy,
    names: Sequence[str],
    shown: int,
    figures: Sequence[StudyFigure],
    look: Look,
    width: int,
    *,
    until: str,
) -> Iterator[Line]:
    """Yield the lines of ``figures``; ``names`` are those of the lanes, of which ``shown`` is marked.

    ``until`` says at which episode this seed's figures end too, where that is not where the runs are. Below
    the first verdict stands what its brackets are.
    """
    heads = _heads(until)
    for in_full in (True, False):
        tables = [(figure, _table(study, names, shown, figure, look, in_full=in_full)) for figure in figures]
        rows = [row for _, table in tables for row in table]
        form = _form(rows, heads, look, width)
        if form.heads == heads[0]:
            break
    is_alone, explains = len(study.lanes) == 1, True
    for number, (figure, table) in enumerate(tables):
        if number and not is_alone:
            yield []
        for row in table:
            if not (row.is_head and is_alone and number):  # then one heading serves for all figures
                yield from _lines(row, form, look)
        yield from _missing(study, figure, look, width)
        for verdict in _verdicts(study, figure, look):
            yield from wrapped(verdict, width, look.palette.text, look, "   ", "   ")
            if explains and "±" in verdict:
                yield from wrapped(BRACKETS, width, look.palette.dim, look, "   ", "   ")
                explains = False


def _heads(until: str) -> Sequence[tuple[str, str]]:
    """Return what stands above the two columns, the longest form first."""
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


def _table(
    study: SeedStudy, names: Sequence[str], shown: int, figure: StudyFigure, look: Look, *, in_full: bool
) -> list[_Row]:
    """Return a heading and a row for each lane; what is not headed by the figure's name has it itself."""
    decimals, palette = figure_decimals(figure, study), look.palette
    is_alone = len(study.lanes) == 1
    called = figure.in_full if in_full else figure.name
    rows = [_Row("" if is_alone else called, "", "", palette.strong, is_head=True)]
    for number, (lane, name) in enumerate(zip(study.lanes, names, strict=True)):
        mark = look.glyphs.cursor if number == shown else " "
        style = palette.lanes[number % len(palette.lanes)]
        rows.append(
            _Row(
                called if is_alone else f"{mark}{number + 1} {name}",
                figure_text(lane.this_seed.get(figure.id), decimals, look.glyphs),
                estimate_text(lane.estimates.get(figure.id), decimals, look.glyphs),
                palette.text if is_alone else style + Style(bold=number == shown),
            )
        )
    return rows


def _form(rows: Sequence[_Row], heads: Sequence[tuple[str, str]], look: Look, width: int) -> _Form:
    """Return columns that fit into ``width``, with the longest headings that leave names enough room."""
    is_alone = not any(row.is_head and row.name for row in rows)
    wanted = max((_cells(row.name, look) for row in rows), default=0)
    named = [row for row in rows if row.is_head or is_alone]
    least = max((_cells(row.name, look) for row in named), default=0)
    least = least if is_alone else max(least, min(wanted, _LEAST_LANE))
    this = max((_cells(row.this, look) for row in rows), default=0)
    mean = max((_cells(row.mean, look) for row in rows), default=0)
    for enough in (wanted, least):
        for head in heads:
            columns = max(this, _cells(head[0], look)), max(mean, _cells(head[1], look))
            for margin, gap in _BLANKS:
                room = width - margin - sum(columns) - 2 * gap
                if room >= enough:
                    return _Form(width, min(wanted, room), *columns, margin, gap, head)
    return _Form(width, max(1, width - 1), heads=heads[-1], is_stacked=True)


def _lines(row: _Row, form: _Form, look: Look) -> Iterator[Line]:
    glyphs, palette = look.glyphs, look.palette
    this, mean = (to_ascii(text, glyphs) for text in (form.heads if row.is_head else (row.this, row.mean)))
    name = shortened(to_ascii(row.name, glyphs), form.name, glyphs.ellipsis)
    own, over = (palette.dim, palette.dim) if row.is_head else (palette.text, palette.strong)
    if not form.is_stacked:
        gap = " " * form.gap
        yield [
            Piece(f"{' ' * form.margin}{name:<{form.name}}", row.style),
            Piece(f"{gap}{this:>{form.this}}", own),
            Piece(f"{gap}{mean:>{form.mean}}", over),
        ]
        return
    if name:
        yield [Piece(f" {name}", row.style)]
    for label, text, style in (
        ((form.heads[0], this, own), (form.heads[1], mean, over)) if not row.is_head else ()
    ):
        labelled: Line = [Piece(f"   {label} ", palette.dim), Piece(text, style)]
        yield first_that_fits((labelled, [Piece(f"  {text}", style)]), form.width, look)


def _cells(text: str, look: Look) -> int:
    return cell_len(to_ascii(text, look.glyphs))


def _missing(study: SeedStudy, figure: StudyFigure, look: Look, width: int) -> Iterator[Line]:
    """Yield of the greedy policies, lane by lane, how many have no return, since they may never end."""
    for number, lane in enumerate(study.lanes, 1):
        estimate = lane.estimates.get(figure.id)
        missing = study.seeds - (0 if estimate is None else estimate.count)
        if figure is GREEDY and missing > 0:
            whose = "the" if len(study.lanes) == 1 else f"lane {number}'s"
            where = f"in {missing} of {study.seeds} seeds"
            text = f"{where} {whose} greedy policy may never end: these are left out"
            yield from wrapped(text, width, look.palette.dim, look, "   ", "   ")


def _verdicts(study: SeedStudy, figure: StudyFigure, look: Look) -> Iterator[str]:
    """Yield for each lane but the one that was shown which of the two is better."""
    for number, lane in enumerate(study.lanes):
        if number != study.shown and figure.id in lane.differences:
            text = _verdict_text(study, figure, number, look)
            if text:
                yield text


def _verdict_text(study: SeedStudy, figure: StudyFigure, other: int, look: Look) -> str:
    """Return ``2 is better: higher by 22.5 ± .6 (20.7 to 24.3), in 64 of 64 seeds``; empty if unknown.

    As long as that is not seen it is ``so far 2 is higher by …``. The numbers are worked out from those that
    are printed.
    """
    difference, glyphs = study.lanes[other].differences[figure.id], look.glyphs
    verdict = verdict_of(figure, difference)
    if verdict is None:
        return ""
    shown, that = study.shown + 1, other + 1
    if verdict.equal == verdict.count:
        return f"{shown} and {that} have the same in every seed"
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


_LEAST_BAR: Final = 8
_MOST_BAR: Final = 32
_UNDER_WAY: Final = (StudyState.STARTING, StudyState.RUNNING)
_SAYS_WHY: Final = (StudyState.FAILED, StudyState.REFUSED)


class ManySeeds(ScrolledPanel):
    """Each figure of this seed beside its mean over many; with lanes, the paired differences too."""

    BINDINGS: ClassVar[list[BindingType]] = [
        *scroll_bindings("many_seeds"),
        binding("enter", "screen.do('seeds.count_again')", "many_seeds.count_again", "Count again"),
    ]
    title = "Many seeds"

    def rows(self, snapshot: Snapshot | None, width: int, height: int) -> list[Strip]:
        """Return all rows of what is known so far."""
        for is_short in (False, True):
            lines = list(study_lines(snapshot, self.look, width, is_short=is_short))
            if len(lines) <= height:
                break
        return strips_of(lines, width, len(lines), self.look)

    def keys(self, snapshot: Snapshot | None) -> Sequence[str]:
        """Return the key that closes it, and enter where there is something to count again."""
        study = None if snapshot is None else snapshot.study
        if not may_count_again(study):
            return ("M: close",)
        return "enter: count again · M: close", "enter: again · M: close"


def study_lines(snapshot: Snapshot | None, look: Look, width: int, *, is_short: bool) -> Iterator[Line]:
    """Yield the lines; of a bandit what the agent cannot know only where it is not hidden.

    Where room ``is_short`` there are no blank lines, and the figures stand above what was counted for them.
    """
    study = None if snapshot is None else snapshot.study
    if snapshot is None or study is None:
        yield from wrapped("the first seeds are being counted", width, look.palette.dim, look, " ", " ")
        return
    study = in_percent(study)
    yield from _how_far(study, snapshot, look, width)
    what = _what_is_counted(study, snapshot, look, width)
    if not study.lanes or not study.seeds:
        yield from what
        return
    if not is_short:
        yield from what
        yield []
    secret = hides_greedy(snapshot)
    figures = shown_figures(study, secret=secret)
    until = until_of(study, episodes_reached(snapshot))
    lanes = _names(study, snapshot), shown_lane(study, snapshot)
    table = table_lines(study, *lanes, figures, look, width, until=until)
    yield from (line for line in table if line or not is_short)
    if hides_means(snapshot) and not keeps_back(snapshot, "answer"):
        yield from wrapped("h shows regret and best arm", width, look.palette.dim, look, " ", "   ")
    if is_short:
        yield from what
    else:
        yield []
    yield from remarks(study, snapshot, look, width, secret=secret)


def _names(study: SeedStudy, snapshot: Snapshot) -> Sequence[str]:
    """Return the names of the lanes when the study began, or none where they may be others now."""
    names = [lane.name for lane in snapshot.run_group.lanes]
    return names if len(names) == len(study.lanes) and not study.is_outdated else [""] * len(study.lanes)


def _how_far(study: SeedStudy, snapshot: Snapshot, look: Look, width: int) -> Iterator[Line]:
    """Yield how far it has come, and whether it is out of date or out of time."""
    palette = look.palette
    if study.most:
        yield _progress(study, _span(study, snapshot), look, width)
    elif study.state is StudyState.STARTING:
        yield [Piece(" starting", palette.dim)]
    if study.state in _UNDER_WAY and not study.seeds:
        yield from wrapped("the first figures come after 8 seeds", width, palette.dim, look, " ", " ")
    if study.how_long and study.state in _UNDER_WAY:
        yield from wrapped(study.how_long, width, palette.dim, look, " ", " ")
    if study.is_outdated:
        text = "the run has been changed since: enter counts again"
        yield from wrapped(text, width, palette.strong, look, " ", " ")
    if study.state is StudyState.OUT_OF_TIME:
        text = "it has used up the processor time that it may take"
        yield from wrapped(text, width, palette.strong, look, " ", " ")


def _progress(study: SeedStudy, span: str, look: Look, width: int) -> Line:
    """Return ``64 of 256 seeds · episodes 1–500`` and a bar, or what is left of that."""
    palette, glyphs = look.palette, look.glyphs
    is_whole = study.seeds >= study.most
    count = f"{study.seeds}" if is_whole else f"{study.seeds} of {study.most}"
    said = Piece(f" {count} seeds", palette.strong)
    spans = [[Piece(f" · {form}", palette.dim)] for form in (span, span.partition(" ")[2]) if form]
    forms: list[Line] = [*([said, *form] for form in spans), [said], [Piece(f" {count}", palette.strong)]]
    fitting = first_that_fits(forms, width, look)
    whole = [*forms[0], Piece(" · low priority", palette.dim)]
    if study.state in _UNDER_WAY and length(spelled(whole, look)) + _LEAST_BAR + 2 <= width:
        fitting = whole
    room = min(_MOST_BAR, width - length(spelled(fitting, look)) - 2)
    if is_whole or room < _LEAST_BAR:
        return fitting
    done = max(1, room * study.seeds // study.most) if study.seeds else 0
    return [
        *fitting,
        Piece(f" {glyphs.track_done * done}", palette.slider_done),
        Piece(glyphs.track_rest * (room - done), palette.slider_rest),
    ]


def _what_is_counted(study: SeedStudy, snapshot: Snapshot, look: Look, width: int) -> Iterator[Line]:
    """Yield why it is bounded as it is or has failed, and which seeds there are so far."""
    palette = look.palette
    if study.message:
        style = palette.strong if study.state in _SAYS_WHY else palette.text
        yield from wrapped(study.message, width, style, look, " ", " ")
    if study.seeds and not study.is_outdated:
        first = snapshot.recipe.seed
        yield from wrapped(f"seeds {first} to {first + study.seeds - 1}", width, palette.dim, look, " ", " ")


def _span(study: SeedStudy, snapshot: Snapshot) -> str:
    """Return how long the run of each seed is, empty where that is not bounded or not known."""
    pulls = isinstance(snapshot.world.drawing, Arms)
    unit, last = ("pull" if pulls else "episode", study.episodes) if study.episodes else ("step", study.steps)
    if not last:
        return ""
    return f"{unit}s 1–{last:,}" if last > 1 else f"{unit} 1"
