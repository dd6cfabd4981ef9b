"""The figures of a study as a table: this seed beside the mean of all, a row a lane, and who is better."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final, NamedTuple

from rich.cells import cell_len
from rich.style import Style

from rl_tui.lab.many_seeds.figures import SeedStudy
from rl_tui.tui.draw.canvas import shortened
from rl_tui.tui.draw.pieces import Line, Piece, first_that_fits, kept, wrapped
from rl_tui.tui.draw.to_ascii import to_ascii
from rl_tui.tui.panels.many_seeds.figures import (
    GREEDY,
    INTERVAL_ERRORS,
    StudyFigure,
    error_text,
    estimate_text,
    figure_decimals,
    figure_text,
    verdict_of,
)
from rl_tui.tui.theme.look import Look

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
    rows = [_Row("" if is_alone else called, "", "", palette.accent, is_head=True)]
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
