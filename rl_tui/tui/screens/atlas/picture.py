"""The map itself: a number and a colour for each combination of two settings."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from rich.cells import cell_len
from rich.style import Style

from rl_tui.agents.hyperparameters import PARAMETERS
from rl_tui.lab.atlas.cells import CellGrid
from rl_tui.lab.atlas.figures import Atlas, AtlasStandings
from rl_tui.lab.sweeps.measures import SweepMeasure
from rl_tui.lab.sweeps.variation import Variation
from rl_tui.tui.draw import numbers
from rl_tui.tui.draw.canvas import Canvas, centred
from rl_tui.tui.draw.to_ascii import to_ascii
from rl_tui.tui.theme.look import Look

MOST_FIELD: Final = 11
LEAST_FIELD: Final = 5
_MARKS: Final = 1
_TALL: Final = 3
_BRACKETS: Final = ("[", "]")
BEST, ALIKE, NOT_DONE, IMPOSSIBLE, FAILED = "*", "'", "·", "×", "fails"


@dataclass(frozen=True, slots=True)
class AtlasScene:
    """What is drawn: the ``atlas`` of ``cells`` by ``measure``, with the cursor at cell ``cursor``.

    ``in_force`` is the cell whose settings the run on screen has.
    """

    look: Look
    cells: CellGrid
    atlas: Atlas
    measure: SweepMeasure
    cursor: int
    in_force: int

    @property
    def columns(self) -> Variation:
        """The setting that varies from left to right."""
        return self.cells.variations[-1]

    @property
    def rows(self) -> Variation | None:
        """The setting that varies upwards; None where one setting is all there is."""
        return self.cells.variations[0] if len(self.cells.variations) > 1 else None

    @property
    def standings(self) -> AtlasStandings | None:
        """How the cells compare by the measure, None while that is not known."""
        return self.atlas.standings.get(self.measure.id)

    def value(self, index: int) -> float | None:
        """Return the mean of the measure in a cell; None where there is none yet."""
        cell = self.atlas.cells.get(index)
        return None if cell is None else cell.value(self.measure)

    @property
    def ends(self) -> tuple[float, float] | None:
        """The worst and the best mean, or the least and the greatest of what is neither; None without any."""
        found = [each for each in map(self.value, range(self.cells.count)) if each is not None]
        if not found:
            return None
        low, high = min(found), max(found)
        return (high, low) if self.measure.larger_is_better is False else (low, high)

    def style(self, index: int) -> Style:
        """Return the style of a cell: from worst to best by its mean."""
        palette, value, ends = self.look.palette, self.value(index), self.ends
        if value is None or ends is None:
            return palette.unvisited if index not in self.atlas.impossible else palette.dim
        worst, best = ends
        return palette.value(1.0 if worst == best else (value - worst) / (best - worst))

    def text(self, index: int, width: int) -> str:
        """Return what stands in a cell, in at most ``width`` cells of the screen."""
        value, cell = self.value(index), self.atlas.cells.get(index)
        if value is not None:
            return numbers.value(value, width, self.look.glyphs)
        if index in self.atlas.impossible:
            return to_ascii(IMPOSSIBLE, self.look.glyphs)
        has_failed = cell is not None and cell.failed == cell.runs > 0
        return FAILED[:width] if has_failed else to_ascii(NOT_DONE, self.look.glyphs)

    def mark(self, index: int) -> str:
        """Return the mark behind a number: the best, or what cannot be told from it."""
        if self.standings is None or index not in self.standings.alike:
            return " "
        return BEST if index == self.standings.best else ALIKE


@dataclass(frozen=True, slots=True)
class MapPlan:
    """Where the cells of a map stand: ``label`` cells of names at the left, ``field`` by ``tall`` each."""

    scene: AtlasScene
    width: int
    height: int
    label: int
    field: int
    tall: int

    @property
    def column_count(self) -> int:
        """How many cells stand in a row."""
        return self.scene.columns.count

    @property
    def row_count(self) -> int:
        """How many rows there are."""
        return 1 if self.scene.rows is None else self.scene.rows.count

    def row_of(self, index: int) -> int:
        """Return the row of a cell from the top: high values of its setting stand above."""
        return self.row_count - 1 - index // self.column_count

    def cell_at(self, x: int, y: int) -> int | None:
        """Return the cell that is drawn at ``x``, ``y``."""
        column, row = (x - self.label) // self.field, (y - 1) // self.tall
        if x < self.label or y < 1 or column >= self.column_count or row >= self.row_count:
            return None
        return (self.row_count - 1 - row) * self.column_count + column


def plan_of(scene: AtlasScene, width: int, height: int) -> MapPlan:
    """Return where the cells of ``scene`` stand in so much room; a line above and one below are for names."""
    names = [] if scene.rows is None else [value_name(scene.rows, row) for row in range(scene.rows.count)]
    label = max(map(cell_len, names), default=0) + 1
    rows = 1 if scene.rows is None else scene.rows.count
    field = max(LEAST_FIELD, min(MOST_FIELD, (width - label) // scene.columns.count))
    tall = max(1, min(_TALL, (height - 2) // rows))
    return MapPlan(scene, width, height, label, field, tall)


def draw_map(plan: MapPlan) -> Canvas:
    """Return the map: the settings' names and values around it, a cell for each combination."""
    scene, look = plan.scene, plan.scene.look
    palette = look.palette
    canvas = Canvas(plan.width, plan.height, palette.text)
    upwards = "" if scene.rows is None else f"{setting_name(scene.rows)} ↑  "
    names = to_ascii(f"{upwards}{setting_name(scene.columns)} →", look.glyphs)
    canvas.put(0, 0, names, palette.dim)
    bottom = 1 + plan.row_count * plan.tall
    in_force = scene.cells.places(scene.in_force)
    for index in range(scene.cells.count):
        _draw_cell(canvas, plan, index)
    for row in range(plan.row_count):
        if scene.rows is not None:
            y = 1 + (plan.row_count - 1 - row) * plan.tall + (plan.tall - 1) // 2
            style = palette.strong if row == in_force[0] else palette.dim
            canvas.put(0, y, f"{value_name(scene.rows, row):>{plan.label - 1}}", style)
    for column in range(plan.column_count):
        style = palette.strong if column == in_force[-1] else palette.dim
        text = centred(value_name(scene.columns, column), plan.field)
        canvas.put(plan.label + column * plan.field, bottom, text, style)
    return canvas


def _draw_cell(canvas: Canvas, plan: MapPlan, index: int) -> None:
    scene = plan.scene
    left = plan.label + (index % plan.column_count) * plan.field
    top = 1 + plan.row_of(index) * plan.tall
    style = scene.style(index)
    for line in range(plan.tall):
        canvas.put(left, top + line, " " * plan.field, style)
    brackets = _BRACKETS if index == scene.in_force else ("", "")
    room = plan.field - _MARKS - (sum(map(len, brackets)) or _MARKS)
    text = f"{brackets[0]}{scene.text(index, room)}{scene.mark(index)}{brackets[1]}"
    middle = top + (plan.tall - 1) // 2
    canvas.put(left, middle, centred(text, plan.field), style)
    if index == scene.cursor:
        for line in range(plan.tall):
            canvas.restyle(left, top + line, plan.field, scene.look.palette.agent)


def setting_name(variation: Variation) -> str:
    """Return the symbol of a setting, or its name where it has none."""
    parameter = PARAMETERS.get(variation.name)
    return variation.name if parameter is None else parameter.symbol


def value_name(variation: Variation, place: int) -> str:
    """Return a value of a setting as people write it: ``0.1``."""
    value = variation.value(place)
    return value if isinstance(value, str) else f"{value:.4g}"
