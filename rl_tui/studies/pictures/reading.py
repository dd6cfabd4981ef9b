"""Results read from files: JSON of `train --runs` and `sweep`, stores, CSV of `train --curve`."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterable, Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any, Final, NoReturn

from rl_tui.common.errors import Fault, UserError
from rl_tui.common.findings import one_line, printable
from rl_tui.common.limits import LARGEST_DRAWN, LARGEST_RESULTS
from rl_tui.common.text_file import UnreadableError, open_plain, read_text
from rl_tui.studies.pictures.tables import CellSpread, CurveTable, SweepCell, SweepTable, Value
from rl_tui.studies.sweeps.cell import MEASURES
from rl_tui.studies.sweeps.document import best_documents, json_pieces
from rl_tui.studies.sweeps.plan import read_plan
from rl_tui.studies.sweeps.ranking import standings_of
from rl_tui.studies.sweeps.store import Store

# Results in a store


_HEAD: Final = b"SQLite format 3\0"


def is_store(path: Path) -> bool:
    """Return True if the file is an SQLite database."""
    try:
        with open_plain(path, "a store") as file:
            return file.read(len(_HEAD)) == _HEAD
    except (OSError, UnreadableError):
        return False


def document_of(path: Path, measure: str | None) -> Any:
    """Return the document of the last sweep in a store. Raises UserError."""
    with Store.to_read(path) as store:
        plans = store.plans()
        if not plans:
            raise UserError(f"{path}: this store is empty; fill it with rl-tui sweep --store {path}")
        plan = read_plan(plans[-1])
        standings = standings_of(plan, store, MEASURES.get(measure or ""))
        bests = best_documents(standings, plan, store, again=False)
        return json.loads("".join(json_pieces(plan, store, standings, bests)))


# Results in JSON and CSV


EPISODE: Final = "episode"
CSV: Final = ".csv"
_NOT_SETTINGS: Final = ("runs", "failed", "like_best")
_LONGEST: Final = 60
_RESTRICTED: Final = "restricted_"  # prefix of numbers about arrivals if some runs never arrived
_FEWEST_FOR_A_RATIO: Final = 3
_LONGEST_TITLE: Final = 200
_DRAWABLE: Final = f"numbers within ±{LARGEST_DRAWN:g}"
_WANTED: Final = "the JSON of train --runs or of sweep, a store of sweeps, or the CSV of train --curve"


def read_results(path: Path, measure: str | None = None) -> CurveTable | SweepTable:
    """Read the results in a file, comparing cells of a store by `measure`. Raises UserError."""
    if is_store(path):
        return results_of(document_of(path, measure), str(path))
    try:
        text = read_text(path, _WANTED, LARGEST_RESULTS)
    except UnreadableError as reason:
        raise UserError(
            str(Fault(printable(str(path)), reason.place, reason.found, reason.expected))
        ) from reason
    if path.suffix.lower() == CSV:
        return _curve_of_csv(path, text)
    try:
        document = json.loads(text, parse_constant=_refuse_constant)
    except (json.JSONDecodeError, RecursionError) as error:
        raise UserError(f"{path}: not a file of results; expected {_WANTED}") from error
    except ValueError as error:
        raise UserError(f"{path}: {one_line(str(error), _LONGEST)}; expected {_WANTED}") from error
    return results_of(document, str(path))


def results_of(document: object, source: str) -> CurveTable | SweepTable:
    """Return the results in the JSON `document`. Raises UserError."""
    if not isinstance(document, dict):
        raise _fault(source, "not a JSON object")
    if isinstance(document.get("cells"), list):
        return _sweep(document, source)
    if isinstance(document.get("curve"), dict):
        return _curve(document, source)
    if "q" in document and "policy" in document:
        raise _fault(
            source, "a single run has no curve", "the result of train --runs N --json, or train --curve F.csv"
        )
    raise _fault(source, "contains neither a curve nor a sweep")


def _fault(source: str, wrong: str, wanted: str = _WANTED) -> UserError:
    return UserError(f"{source}: {wrong}; give {wanted}")


def _refuse_constant(name: str) -> NoReturn:
    raise ValueError(f"{name} is not a number")


def _curve_of_csv(path: Path, text: str) -> CurveTable:
    try:
        head, *rows = list(csv.reader(io.StringIO(text), strict=True)) or [[]]
        columns = {
            name: [float(row[place]) if row[place] else None for row in rows if row]
            for place, name in enumerate(head)
        }
    except (csv.Error, ValueError, IndexError) as error:
        raise _fault(str(path), f"not a table of numbers ({one_line(str(error), _LONGEST)})") from error
    return _checked(CurveTable(path.stem, columns, None), str(path))


def _curve(document: Mapping[str, Any], source: str) -> CurveTable:
    columns = document["curve"]
    if not all(isinstance(values, list) and all(map(_is_number, values)) for values in columns.values()):
        raise _fault(source, "the curve has no lists of numbers", _DRAWABLE)
    runs = document.get("runs")
    words = [document[name] for name in ("scenario", "algorithm") if isinstance(document.get(name), str)]
    return _checked(
        CurveTable(
            one_line(", ".join(words) or Path(source).stem, _LONGEST_TITLE),
            columns,
            len(runs) if isinstance(runs, list) else None,
        ),
        source,
    )


def _checked(table: CurveTable, source: str) -> CurveTable:
    lengths = {len(values) for values in table.columns.values()}
    episodes = table.columns.get(EPISODE, ())
    if len(lengths) != 1 or None in episodes or EPISODE not in table.columns:
        raise _fault(source, "has no curve over episodes")
    if not episodes:
        raise _fault(source, "the curve has no episode", "runs with finished episodes")
    if not all(_is_number(value) for row in table.columns.values() for value in row):
        raise _fault(source, "the curve has a number that cannot be drawn", _DRAWABLE)
    return table


def _is_number(value: object) -> bool:
    return value is None or (
        isinstance(value, int | float) and not isinstance(value, bool) and abs(value) <= LARGEST_DRAWN
    )


def _sweep(document: Mapping[str, Any], source: str) -> SweepTable:
    measures = _measures(document.get("measures"), source)
    cells = document["cells"]
    if not cells:
        raise _fault(source, "the sweep has no trained cell", "a sweep with finished runs")
    if not all(isinstance(cell, dict) for cell in cells):
        raise _fault(source, "a cell is not a JSON object")
    spreads = {name for name in measures if any(isinstance(cell.get(name), dict) for cell in cells)}
    if not spreads:
        raise _fault(source, "no cell has a metric")
    kept = {name: title for name, title in measures.items() if name in spreads}
    names = tuple(name for name in cells[0] if name not in (*_NOT_SETTINGS, *measures))
    if not names or any(not _is_setting(cell.get(name)) for cell in cells for name in names):
        raise _fault(source, "a cell lacks a setting that varies")
    judged_by = document.get("measure")
    return SweepTable(
        scenario="" if "scenario" in names else one_line(str(document.get("scenario", "")), _LONGEST_TITLE),
        names=names,
        logarithmic=frozenset(
            name
            for name in names
            if _is_logarithmic(name, document.get("vary"), [cell[name] for cell in cells])
        ),
        measures=kept,
        judged_by=judged_by if judged_by in kept else next(iter(kept)),
        cells=[_cell(cell, names, kept, source) for cell in cells],
        bests=[
            found
            for each in _listed(document.get("bests")) or [document.get("best")]
            if (found := _settings_in(each, names)) is not None
        ],
    )


def _measures(found: object, source: str) -> dict[str, str]:
    measures: dict[str, str] = {}
    for each in found if isinstance(found, list) else ():
        if isinstance(each, str):
            measures[each] = one_line(each.replace("_", " "), _LONGEST_TITLE)
        elif isinstance(each, dict) and isinstance(each.get("id"), str):
            measures[each["id"]] = one_line(str(each.get("title", each["id"])), _LONGEST_TITLE)
    if not measures:
        raise _fault(source, "the sweep has no metric")
    return measures


def _cell(cell: Mapping[str, Any], names: Iterable[str], measures: Iterable[str], source: str) -> SweepCell:
    like_best = cell.get("like_best")
    return SweepCell(
        {name: cell[name] for name in names},
        {name: _spread(cell.get(name), cell.get("runs"), source) for name in measures},
        like_best if isinstance(like_best, bool) else None,
    )


def _spread(figures: object, runs: object, source: str) -> CellSpread:
    if not isinstance(figures, dict):
        return CellSpread(None, None, None)
    is_restricted = figures.get("mean") is None and figures.get(f"{_RESTRICTED}mean") is not None
    of = _RESTRICTED if is_restricted else ""
    mean, low, high = (figures.get(f"{of}{name}") for name in ("mean", "low", "high"))
    if not all(map(_is_number, (mean, low, high))):
        raise _fault(source, "a metric is not a number", _DRAWABLE)
    return CellSpread(mean, low, high, figures.get("count", runs) == runs, is_restricted)


def _is_setting(value: object) -> bool:
    return isinstance(value, bool | str) or (value is not None and _is_number(value))


def _settings_in(found: object, names: Iterable[str]) -> dict[str, Value] | None:
    if not isinstance(found, dict) or not all(_is_setting(found.get(name)) for name in names):
        return None
    return {name: found[name] for name in names}


def _is_logarithmic(name: str, vary: object, values: Sequence[Value]) -> bool:
    numbers = sorted({value for value in values if not isinstance(value, bool | str)})
    if len(numbers) < len(set(values)) or not numbers or numbers[0] <= 0:
        return False
    if any(str(each).startswith(f"{name}=") and ":log" in str(each) for each in _listed(vary)):
        return True
    ratios = [later / earlier for earlier, later in pairwise(numbers)]
    return len(numbers) >= _FEWEST_FOR_A_RATIO and max(ratios) < 1.05 * min(ratios)


def _listed(found: object) -> list[object]:
    return found if isinstance(found, list) else []
