"""Pictures of results: learning curves, or a metric of a sweep."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from rl_tui.agents.hyperparameters import PARAMETERS
from rl_tui.common.errors import UserError
from rl_tui.common.findings import one_line
from rl_tui.common.words import counted
from rl_tui.studies.pictures.picture import (
    AtlasChart,
    Chart,
    ChartAxis,
    ChartCurve,
    Picture,
    axis_with_cut,
    close_axis,
    kept_range,
    number_text,
    round_axis,
    word_axis,
    words_of_cut,
)
from rl_tui.studies.pictures.reading import EPISODE
from rl_tui.studies.pictures.tables import CurveTable, SweepCell, SweepTable, Value
from rl_tui.studies.statistics.intervals import SHARE_BELOW, student_quantile

# Learning curves: one chart, a line with a band for each file


TITLES: Final = {
    "return_mean": "Return per episode",
    "length_mean": "Steps per episode",
    "optimal_action_rate": "Optimal action, share of pulls",
}
"""Drawable columns with their titles."""
_ERRORS: Final = {
    "return_mean": "return_stderr",
    "length_mean": "length_stderr",
    "optimal_action_rate": "optimal_action_stderr",
}
_NORMAL: Final = 1.96
_BAND: Final = "Bands: the 95 % interval of the mean"


def curve_picture(tables: Sequence[CurveTable], measure: str | None = None) -> Picture:
    """Return a chart of one column (default the return), with a curve for each table.

    Bands are 95 % intervals of the mean: by Student's t if the number of runs is known, else ± 1.96 standard
    errors. Raises UserError if a table lacks the column.
    """
    column = measure or "return_mean"
    if column not in TITLES:
        raise UserError(f"a curve has no {column}: choose --measure {' or '.join(TITLES)}")
    for table in tables:
        if column not in table.columns:
            raise UserError(f"{table.name} has no {column}: choose another --measure")
    names = _names(tables)
    curves = tuple(
        _curves_curve(name if len(tables) > 1 else "", table, column, place)
        for place, (name, table) in enumerate(zip(names, tables, strict=True))
    )
    y, cut = axis_with_cut("", curves)
    episodes = [x for curve in curves for x in curve.x]
    runs = [
        f"{name}: {counted(table.runs, 'run')}"
        for name, table in zip(names, tables, strict=True)
        if table.runs
    ]
    heading = TITLES[column] if len(tables) == 1 else ""  # otherwise it is the title
    has_bands = any(value is not None for curve in curves for value in curve.low)
    return Picture(
        title=names[0] if len(tables) == 1 else TITLES[column],
        summary=_curves_summary(TITLES[column], curves),
        panels=(Chart(heading, close_axis("episodes", episodes), y, curves),),
        notes=tuple(filter(None, (f"Means over runs. {'; '.join(runs)}." if runs else "", cut))),
        band=f"{_BAND}{_method(tables)}." if has_bands else "",
    )


def _names(tables: Sequence[CurveTable]) -> list[str]:
    names = [table.name for table in tables]
    return [
        name if names.count(name) == 1 else f"{name} ({place})" for place, name in enumerate(names, start=1)
    ]


def _curves_curve(name: str, table: CurveTable, column: str, place: int) -> ChartCurve:
    means = table.columns[column]
    errors = table.columns.get(_ERRORS[column], [None] * len(means))
    width = _half_width(table.runs)

    def edge(sign: float) -> tuple[float | None, ...]:
        return tuple(
            None if mean is None or error is None else mean + sign * width * error
            for mean, error in zip(means, errors, strict=True)
        )

    x = tuple(float(value) for value in table.columns[EPISODE] if value is not None)
    return ChartCurve(name, x, tuple(means), low=edge(-1.0), high=edge(1.0), colour=place)


def _half_width(runs: int | None) -> float:
    if runs is None or runs < 2:
        return _NORMAL
    return student_quantile(SHARE_BELOW, runs - 1)


def _method(tables: Sequence[CurveTable]) -> str:
    return (
        ", by Student's t" if all(table.runs for table in tables) else ", 1.96 standard errors to either side"
    )


def _curves_summary(title: str, curves: Sequence[ChartCurve]) -> str:
    last = [number_text(next(value for value in reversed(curve.y) if value is not None)) for curve in curves]
    if len(curves) == 1:
        return f"{title} over episodes. The last value is {last[0]}."
    ends = "; ".join(f"{curve.name} ends at {value}" for curve, value in zip(curves, last, strict=True))
    return f"{title} over episodes, a line for each of {len(curves)} results. {ends}."


# Pictures of a sweep


MOST_LINES: Final = 14
MOST_PANELS: Final = 12
_NAME_DIGITS: Final = 3
_LONGEST_WORD: Final = 40  # characters of a word on an axis or in the name of a line
_APART: Final = 0.3  # of the distance between words, from the first to the last point of a word
_INTERVAL: Final = "the interval of the mean that the sweep gives."
_RESTRICTED: Final = "Runs that had not arrived when training ended count with all their episodes."
_PARTIAL: Final = "Some means leave out runs without a value: see count in the results."
Settings = tuple[Value, ...]


@dataclass(frozen=True, slots=True)
class _Wanted:
    table: SweepTable
    measure: str
    x: str
    y: str | None

    @property
    def others(self) -> tuple[str, ...]:
        """The settings other than `x` and `y`."""
        return tuple(name for name in self.table.names if name not in (self.x, self.y))

    @property
    def title(self) -> str:
        return f"{self.table.scenario}: {self.table.measures[self.measure]}".removeprefix(": ")

    def groups(self) -> dict[Settings, list[SweepCell]]:
        groups: dict[Settings, list[SweepCell]] = {}
        for cell in self.table.cells:
            groups.setdefault(tuple(cell.settings[name] for name in self.others), []).append(cell)
        return groups

    def mean(self, cell: SweepCell) -> float | None:
        return cell.spreads[self.measure].mean

    def notes(self, cut: str) -> tuple[str, ...]:
        there = [cell.spreads[self.measure] for cell in self.table.cells]
        is_partial = any(each.mean is not None and not each.is_of_all for each in there)
        is_restricted = any(each.is_restricted for each in there)
        said = cut, _PARTIAL if is_partial else "", _RESTRICTED if is_restricted else ""
        return tuple(filter(None, said))

    def means(self) -> list[float]:
        means = [mean for cell in self.table.cells if (mean := self.mean(cell)) is not None]
        if not means:
            raise UserError(f"no cell has a value of {self.measure}: choose another --measure")
        return means


def sweep_picture(
    table: SweepTable, measure: str | None = None, x: str | None = None, y: str | None = None
) -> Picture:
    """Return a chart of a metric against `x`, or a heat map with `y`. Raises UserError.

    Defaults are the metric that ranks the sweep, and the first two numeric settings.
    """
    named = (("--measure", measure, tuple(table.measures)), ("--x", x, table.names), ("--y", y, table.names))
    for option, name, names in named:
        if name is not None and name not in names:
            raise UserError(f"{option} {name} is not in these results: choose {' or '.join(names)}")
    if x is not None and x == y:
        raise UserError(f"--x and --y are both {x}: choose two settings")
    numbers = [name for name in table.names if _is_numeric(table, name) and name != y]
    chosen = x or next(iter(numbers), next(name for name in table.names if name != y))
    if x is None and y is None and len(numbers) > 1:
        y = numbers[1]
    wanted = _Wanted(table, measure or table.judged_by, chosen, y)
    return _chart(wanted) if y is None else _atlases(wanted)


def _is_numeric(table: SweepTable, name: str) -> bool:
    values = {cell.settings[name] for cell in table.cells}
    return len(values) > 1 and not any(isinstance(value, bool | str) for value in values)


def _values(table: SweepTable, name: str) -> list[Value]:
    """Return the values of a setting: numbers ascending, words as swept."""
    values = list(dict.fromkeys(cell.settings[name] for cell in table.cells))
    if any(isinstance(value, bool | str) for value in values):
        return values
    return sorted(values, key=float)


def value_text(value: Value, digits: int = 4) -> str:
    """Format a value of a setting with at most `digits` digits."""
    return number_text(value, digits) if not isinstance(value, bool | str) else _word(value)


def _word(value: bool | str) -> str:
    return one_line(str(value).lower(), _LONGEST_WORD)


def setting_label(name: str) -> str:
    """Return the label of a setting: symbol and name."""
    parameter = PARAMETERS.get(name)
    if parameter is None or parameter.symbol == name:
        return one_line(name.replace("_", " "), _LONGEST_WORD)
    return f"{parameter.symbol} ({name.replace('_', ' ')})"


def _said(names: Sequence[str], values: Settings) -> str:
    return ", ".join(
        one_line(value, _LONGEST_WORD) if isinstance(value, str) else f"{_sign(name)} = {value_text(value)}"
        for name, value in zip(names, values, strict=True)
    )


def _sign(name: str) -> str:
    return PARAMETERS[name].symbol if name in PARAMETERS else one_line(name, _LONGEST_WORD)


def _chart(wanted: _Wanted) -> Picture:
    table, groups = wanted.table, wanted.groups()
    if len(groups) > MOST_LINES:
        others = " or ".join(f"--y {name}" for name in wanted.others)
        raise UserError(f"{len(groups)} lines are too many for one chart: draw a map with {others}")
    means = wanted.means()
    values = _values(table, wanted.x)
    if _is_numeric(table, wanted.x):
        numbers = [float(value) for value in values]
        axis = close_axis(setting_label(wanted.x), numbers, logarithmic=wanted.x in table.logarithmic)
        places = dict(zip(values, numbers, strict=True))
    else:
        axis = word_axis(setting_label(wanted.x), [value_text(value) for value in values])
        places = {value: float(place) for place, value in enumerate(values)}
    is_line = _is_numeric(table, wanted.x)
    # words and the points of one word are spread out
    apart = 0.0 if is_line else _APART / max(1, len(groups) - 1)
    curves = tuple(
        _curve(
            wanted,
            _said(wanted.others, key),
            cells,
            places,
            place,
            place * apart,
        )
        for place, (key, cells) in enumerate(groups.items())
    )
    y, cut = axis_with_cut("", curves)
    has_bands = any(value is not None for curve in curves for value in curve.low)
    return Picture(
        title=wanted.title,
        summary=_summary(wanted, means, f"against {wanted.x}, {counted(len(curves), 'line')}"),
        panels=(Chart("", axis, y, curves, connected=is_line),),
        notes=wanted.notes(cut),
        band=f"{'Bands' if is_line else 'Bars'}: {_INTERVAL}" if has_bands else "",
    )


def _curve(
    wanted: _Wanted,
    name: str,
    cells: Iterable[SweepCell],
    places: Mapping[Value, float],
    colour: int,
    moved: float,
) -> ChartCurve:
    ordered = sorted(cells, key=lambda cell: places[cell.settings[wanted.x]])
    spreads = [cell.spreads[wanted.measure] for cell in ordered]
    return ChartCurve(
        name,
        tuple(places[cell.settings[wanted.x]] + moved for cell in ordered),
        tuple(spread.mean for spread in spreads),
        low=tuple(spread.low for spread in spreads),
        high=tuple(spread.high for spread in spreads),
        colour=colour,
    )


def _atlases(wanted: _Wanted) -> Picture:
    groups, means = wanted.groups(), wanted.means()
    if len(groups) > MOST_PANELS:
        raise UserError(
            f"{len(groups)} maps are too many for one picture: "
            f"vary fewer values of {' and '.join(wanted.others)}"
        )
    scale = round_axis("", kept_range(means))
    cut = words_of_cut(means, scale).replace("is cut", "has the colour of that end")
    return Picture(
        title=wanted.title,
        summary=_summary(wanted, means, f"over {wanted.x} and {wanted.y}, {counted(len(groups), 'panel')}"),
        panels=tuple(_atlas(wanted, key, cells, scale) for key, cells in groups.items()),
        notes=wanted.notes(cut),
    )


def _atlas(wanted: _Wanted, key: Settings, cells: Sequence[SweepCell], scale: ChartAxis) -> AtlasChart:
    table, y_name = wanted.table, wanted.y or ""
    columns, rows = _values(table, wanted.x), _values(table, y_name)
    there = {(cell.settings[y_name], cell.settings[wanted.x]): cell for cell in cells}
    is_judged = wanted.measure == table.judged_by
    grid = [[there.get((row, column)) for column in columns] for row in rows]
    bests = table.bests if is_judged else ()
    return AtlasChart(
        title=_said(wanted.others, key),
        x_label=setting_label(wanted.x),
        y_label=setting_label(y_name),
        columns=tuple(value_text(value, _NAME_DIGITS) for value in columns),
        rows=tuple(value_text(value, _NAME_DIGITS) for value in rows),
        values=tuple(tuple(None if cell is None else wanted.mean(cell) for cell in row) for row in grid),
        scale=scale,
        alike=tuple(
            tuple(is_judged and cell is not None and bool(cell.like_best) for cell in row) for row in grid
        ),
        best=next(
            (
                (place, column)
                for place, row in enumerate(grid)
                for column, cell in enumerate(row)
                if cell is not None and cell.settings in bests
            ),
            None,
        ),
    )


def _summary(wanted: _Wanted, means: Sequence[float], how: str) -> str:
    names, bests = wanted.table.names, wanted.table.bests
    found = f" Best: {_said(names, tuple(bests[0].values()))}." if len(bests) == 1 else ""
    return (
        f"{wanted.table.measures[wanted.measure]} {how}; means from {number_text(min(means))} to "
        f"{number_text(max(means))}.{found}"
    )


# Pictures of any results


def picture_of(
    tables: Sequence[CurveTable | SweepTable],
    measure: str | None = None,
    x: str | None = None,
    y: str | None = None,
) -> Picture:
    """Return a picture of curves or of one sweep. Raises UserError."""
    curves = [table for table in tables if isinstance(table, CurveTable)]
    if len(curves) == len(tables):
        if x is not None or y is not None:
            raise UserError("--x and --y are for sweeps: a curve is drawn over its episodes")
        if len(curves) > MOST_LINES:
            raise UserError(f"{len(curves)} curves are too many for one chart: give {MOST_LINES} or fewer")
        return curve_picture(curves, measure)
    sweeps = [table for table in tables if isinstance(table, SweepTable)]
    if len(tables) > 1:
        raise UserError("a sweep cannot share a chart; give one file, or several files of curves")
    return sweep_picture(sweeps[0], measure, x, y)
