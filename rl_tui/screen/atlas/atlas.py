"""A metric for combinations of two settings."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import ClassVar, Final

from rich.cells import cell_len
from rich.style import Style
from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.events import Click
from textual.geometry import Size
from textual.strip import Strip
from textual.widget import Widget
from textual.widgets import Static

from rl_tui.agents.hyperparameters import PARAMETERS
from rl_tui.common.words import counted
from rl_tui.runs.background.background import Background
from rl_tui.runs.measures import Measure
from rl_tui.runs.recipe import Recipe
from rl_tui.screen.dialogs.dialog import Dialog
from rl_tui.screen.draw import numbers
from rl_tui.screen.draw.canvas import Canvas, centred
from rl_tui.screen.theme.look import Look
from rl_tui.studies.atlas.cells import CellGrid
from rl_tui.studies.atlas.figures import Atlas, AtlasState
from rl_tui.studies.atlas.request import WORK, AtlasRequest
from rl_tui.studies.sweeps.cell import JUDGED_BY, MEASURES
from rl_tui.studies.sweeps.cells.variation import Variation

# The picture


MOST_FIELD: Final = 11
LEAST_FIELD: Final = 5
_ROOM: Final = 6
_LEAST_ROOM: Final = 4
_TALL: Final = 3
_NAMES: Final = 2  # rows for names
_AROUND: Final = 7  # rows for the texts above and below the map
BEST, NOT_DONE, IMPOSSIBLE, FAILED = "*", "·", "×", "fails"


@dataclass(frozen=True, slots=True)
class AtlasScene:
    """Everything to draw. ``in_force``: the cell of the run on screen."""

    look: Look
    cells: CellGrid
    atlas: Atlas
    measure: Measure
    cursor: int
    in_force: int

    @property
    def axes(self) -> tuple[Variation | None, Variation]:
        """The setting that varies upwards, if any, and the one to the right."""
        *upwards, across = self.cells.variations
        return upwards[0] if upwards else None, across

    def value(self, index: int) -> float | None:
        """Return a cell's mean, if any."""
        cell = self.atlas.cells.get(index)
        return None if cell is None else cell.value(self.measure)

    @property
    def ends(self) -> tuple[float, float] | None:
        """The worst and best, or least and greatest mean."""
        found = [each for each in map(self.value, range(self.cells.count)) if each is not None]
        if not found:
            return None
        low, high = min(found), max(found)
        return (high, low) if self.measure.larger_is_better is False else (low, high)

    def style(self, index: int) -> Style:
        """Return a style from worst to best, bold if tied with the best."""
        palette, value, ends = self.look.palette, self.value(index), self.ends
        if value is None or ends is None:
            return palette.unvisited if index not in self.atlas.impossible else palette.dim
        worst, best = ends
        style = palette.value(1.0 if worst == best else (value - worst) / (best - worst))
        return style + Style(bold=True) if index in self._alike else style

    @property
    def _alike(self) -> frozenset[int]:
        standings = self.atlas.standings.get(self.measure.id)
        return frozenset() if standings is None else standings.alike

    def text(self, index: int, width: int) -> str:
        """Write a cell in ``width`` characters."""
        value, cell = self.value(index), self.atlas.cells.get(index)
        if value is not None:
            return numbers.value(value, width, self.look.glyphs).strip()
        if index in self.atlas.impossible:
            return self.look.glyphs.spelled(IMPOSSIBLE)
        has_failed = cell is not None and cell.failed == cell.runs > 0
        return FAILED[:width] if has_failed else self.look.glyphs.spelled(NOT_DONE)

    def mark(self, index: int) -> str:
        """Mark the best."""
        standings = self.atlas.standings.get(self.measure.id)
        return BEST if standings is not None and index == standings.best else ""


class MapPicture:
    """The map of ``scene``. ``label`` columns of names, ``field`` × ``tall`` per cell."""

    def __init__(self, scene: AtlasScene, width: int, height: int) -> None:
        self.scene, self.width, self.height = scene, width, height
        upwards, across = scene.axes
        self.rows, self.columns = 1 if upwards is None else upwards.count, across.count
        names = [] if upwards is None else [_value_name(upwards, row) for row in range(self.rows)]
        self.label = max(map(cell_len, names), default=0) + 1
        self.field = max(LEAST_FIELD, min(MOST_FIELD, (width - self.label) // across.count))
        self.tall = max(1, min(_TALL, (height - _NAMES) // self.rows))

    def place(self, index: int) -> tuple[int, int]:
        """Return x and y, with high values above."""
        row, column = divmod(index, self.columns)
        return self.label + column * self.field, 1 + (self.rows - 1 - row) * self.tall

    def cell_at(self, x: int, y: int) -> int | None:
        """Return the cell here, or None."""
        column, row = (x - self.label) // self.field, (y - 1) // self.tall
        if x < self.label or y < 1 or column >= self.columns or row >= self.rows:
            return None
        return (self.rows - 1 - row) * self.columns + column

    @property
    def _room(self) -> int:
        return min(_ROOM, max(self.field - 2, _LEAST_ROOM))

    def drawn(self) -> Canvas:
        """Draw the map."""
        scene, palette = self.scene, self.scene.look.palette
        canvas = Canvas(self.width, self.height, palette.text)
        upwards, across = scene.axes
        current, names = scene.cells.places(scene.in_force), f"{_setting_name(across)} →"
        for index in range(scene.cells.count):
            self._draw_cell(canvas, index)
        if upwards is not None:
            names = f"{_setting_name(upwards)} ↑  {names}"
            for row in range(self.rows):
                y = self.place(row * self.columns)[1] + (self.tall - 1) // 2
                style = palette.strong if row == current[0] else palette.dim
                canvas.put(0, y, f"{_value_name(upwards, row):>{self.label - 1}}", style)
        canvas.put(0, 0, scene.look.glyphs.spelled(names), palette.dim)
        for column in range(self.columns):
            style = palette.strong if column == current[-1] else palette.dim
            text = centred(_value_name(across, column), self.field)
            canvas.put(self.place(column)[0], 1 + self.rows * self.tall, text, style)
        return canvas

    def _draw_cell(self, canvas: Canvas, index: int) -> None:
        scene = self.scene
        left, top = self.place(index)
        style = scene.style(index)
        for line in range(self.tall):
            canvas.put(left, top + line, " " * self.field, style)
        text = scene.text(index, self._room)
        before = max(0, self.field - len(text)) // 2
        behind = scene.mark(index)
        if index == scene.in_force and before and before + len(text + behind) < self.field:
            text, behind, before = f"[{text}", f"{behind}]", before - 1
        canvas.put(left + before, top + (self.tall - 1) // 2, text + behind, style)
        for line in range(self.tall if index == scene.cursor else 0):
            canvas.restyle(left, top + line, self.field, scene.look.palette.agent)


def _setting_name(variation: Variation) -> str:
    parameter = PARAMETERS.get(variation.name)
    return variation.name if parameter is None else parameter.symbol


def _value_name(variation: Variation, place: int) -> str:
    value = variation.value(place)
    return value if isinstance(value, str) else f"{value:.4g}"


class AtlasMap(Widget, can_focus=True):
    """The picture of ``scene``, with a cursor."""

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("left", "move(0, -1)", "left", show=False),
        Binding("right", "move(0, 1)", "right", show=False),
        Binding("up", "move(1, 0)", "up", show=False),
        Binding("down", "move(-1, 0)", "down", show=False),
    ]

    def __init__(self, scene: AtlasScene) -> None:
        super().__init__(id="map")
        self.scene = scene
        self._strips: list[Strip] = []

    def show(self, scene: AtlasScene) -> None:
        """Draw ``scene`` from now on."""
        self.scene = scene
        self._strips = []
        self.refresh()

    def get_content_height(self, container: Size, viewport: Size, width: int) -> int:
        """Return the rows of the map, so that the legend touches it."""
        picture = MapPicture(self.scene, width, container.height - _AROUND)
        return picture.rows * picture.tall + _NAMES

    def on_resize(self) -> None:
        """Draw again for the new size."""
        self._strips = []

    def render_line(self, y: int) -> Strip:
        """Return one line."""
        width, height = self.size
        if not self._strips:
            self._strips = MapPicture(self.scene, width, height).drawn().strips()
        strip = self._strips[y] if y < len(self._strips) else Strip.blank(width)
        return strip.apply_style(self.rich_style)

    def action_move(self, rows: int, columns: int) -> None:
        """Move up and to the right, within the map."""
        axes = len(self.scene.cells.variations)
        steps = {axes - 1: columns} | ({0: rows} if axes > 1 else {})
        self._point_at(self.scene.cells.moved(self.scene.cursor, steps))

    def on_click(self, event: Click) -> None:
        """Move the cursor to the click."""
        cell = MapPicture(self.scene, *self.size).cell_at(event.x, event.y)
        if cell is not None:
            self._point_at(cell)

    def _point_at(self, cell: int) -> None:
        self.call_later(self.run_action, f"screen.point_at({cell})")


# Text above and below


def head(scene: AtlasScene, runs: int, how_long: str = "") -> str:
    """Describe cells, progress and time left."""
    atlas = scene.atlas
    each = "" if atlas.episodes is None else f" of {counted(atlas.episodes, 'episode')}"
    return f"mean of {counted(runs, 'seed')}{each}; {progress(atlas, how_long)}"


def progress(atlas: Atlas, how_long: str) -> str:
    """Describe progress and remaining time, or the result."""
    done = f"{atlas.done:,} of {counted(atlas.planned, 'run')}"
    if atlas.state is AtlasState.FAILED:
        return f"failed: {atlas.message}"
    if atlas.state is AtlasState.STARTING:
        return ", ".join(filter(None, ("training the first cell", how_long)))
    if atlas.state is AtlasState.OUT_OF_TIME:
        return f"{done}: {atlas.message}"
    if atlas.state is AtlasState.DONE:
        return f"all {counted(atlas.planned, 'run')} done"
    return ", ".join(filter(None, (done, how_long)))


def legend(scene: AtlasScene) -> str:
    """Describe colours and marks."""
    glyphs, ends = scene.look.glyphs, scene.ends
    if ends is None:
        return ""
    first, last = (numbers.value(end, _ROOM, glyphs) for end in ends)
    names = ("least", "greatest") if scene.measure.larger_is_better is None else ("worst", "best")
    marks = f"{BEST} best  bold: tied with it  " if scene.measure.id in scene.atlas.standings else ""
    return f"{marks}[ ] current  {names[0]} {first}, {names[1]} {last}"


def cell_line(scene: AtlasScene) -> str:
    """Describe the cell under the cursor."""
    places = scene.cells.places(scene.cursor)
    settings = "  ".join(
        f"{_setting_name(each)} {_value_name(each, place)}"
        for each, place in zip(scene.cells.variations, places, strict=True)
    )
    return f"{settings}: {_figures(scene)}"


def _figures(scene: AtlasScene) -> str:
    index, glyphs = scene.cursor, scene.look.glyphs
    if index in scene.atlas.impossible:
        return f"impossible: {scene.atlas.impossible[index]}"
    cell = scene.atlas.cells.get(index)
    if cell is None:
        return "not done yet"
    found, value = cell.figures.get(scene.measure.id, {}), cell.value(scene.measure)

    def written(number: float) -> str:
        return numbers.value(number, _ROOM, glyphs)

    parts = []
    if value is not None:
        ends = [written(found[end]) for end in ("low", "high") if found.get(end) is not None]
        interval = f" (95 %: {ends[0]} to {ends[1]})" if len(ends) == 2 else ""
        parts.append(f"mean {written(value)}{interval}")
    if found.get("median") is not None:
        parts.append(f"median {written(found['median'])}")
    if scene.measure.may_never_arrive and "arrived" in found:
        parts.append(f"{found['arrived']} of {cell.runs - cell.failed} arrived")
    parts.append(counted(cell.runs, "run"))
    if cell.failed:
        parts.append(f"{cell.failed} failed ({cell.failure})")
    return ", ".join(parts)


# The dialog


_KEYS: Final = "m: metric   n: seed   enter: open seed {}   esc: close"
_NEWS_EVERY: Final = 0.1  # seconds


class AtlasDialog(Dialog[Recipe]):
    """A map around the current settings. The answer is the run to open."""

    CSS_PATH: ClassVar[list[str | Path]] = [  # type: ignore[assignment]
        Path(__file__).parents[1] / "dialogs" / "dialog.tcss",
        Path(__file__).with_name("atlas.tcss"),
    ]
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("S,q", "cancel", "back", id="close_atlas", tooltip="Close the settings map."),
        Binding("m", "measure", "metric", id="atlas.measure", tooltip="Show the next metric."),
        Binding("n", "seed", "next seed", id="atlas.seed", tooltip="Open another of the cell's runs."),
        Binding("enter", "open", "open", id="atlas.open", tooltip="Open the run with this seed."),
    ]

    def __init__(self, look: Look, request: AtlasRequest) -> None:
        super().__init__()
        self._look = look
        self._request = request
        self._seed = 0
        self._how_long = ""
        self._background = Background[AtlasRequest, Atlas](WORK, lambda: None)
        measure = MEASURES[JUDGED_BY[0]]
        self._scene = AtlasScene(
            look, request.cells, request.nothing_yet, measure, request.in_force, request.in_force
        )

    def compose(self) -> ComposeResult:
        """Yield metric, map and line."""
        names = " × ".join(map(_setting_name, self._request.variations))
        with self.box(self._look.glyphs.separated(f"Settings map · {names}"), ""):
            yield Static(id="measure", markup=False)
            yield Static(id="head", classes="hint", markup=False)
            yield AtlasMap(self._scene)
            yield Static(id="legend", classes="hint", markup=False)
            yield Static(id="cell", markup=False)

    def on_mount(self) -> None:
        """Start the computation in another process."""
        super().on_mount()
        self.query_one(AtlasMap).focus()
        try:
            process = self._background.begin(self._request, self._scene.atlas)
        except OSError as error:
            self.app.notify(f"cannot start a process: {error.strerror or error}", severity="error")
            self.dismiss(None)
            return
        if process is not None and self._request.is_awaited:
            process.wait()
        else:
            self.set_interval(_NEWS_EVERY, self._take_news)
        self._take_news()
        self._show()

    def on_unmount(self) -> None:
        """End the process."""
        self._background.close()

    def _take_news(self) -> None:
        process = self._background.process
        if process is None:
            return
        atlas, how_long = process.known, process.how_long
        if process.failed and not atlas.is_over:
            atlas = replace(atlas, state=AtlasState.FAILED, message=process.failed)
        if atlas != self._scene.atlas or how_long != self._how_long:
            self._how_long = how_long
            self._change(atlas=atlas)

    def _change(self, **changes: object) -> None:
        self._scene = replace(self._scene, **changes)  # type: ignore[arg-type]
        self._show()

    def _show(self) -> None:
        scene, glyphs = self._scene, self._look.glyphs
        self.query_one(AtlasMap).show(scene)
        texts = {
            "#measure": scene.measure.title,
            "#head": head(scene, self._request.runs, self._how_long),
            "#legend": legend(scene),
            "#cell": cell_line(scene),
        }
        for name, text in texts.items():
            self.query_one(name, Static).update(glyphs.spelled(text))
        self.query_one("#box").border_subtitle = _KEYS.format(self._request.seeds[self._seed])

    def action_point_at(self, cell: int) -> None:
        """Move the cursor to ``cell``."""
        self._change(cursor=cell)

    def action_measure(self) -> None:
        """Show the next known metric."""
        there = [
            each
            for each in MEASURES.values()
            if each is self._scene.measure
            or any(cell.value(each) is not None for cell in self._scene.atlas.cells.values())
        ]
        self._change(measure=there[(there.index(self._scene.measure) + 1) % len(there)])

    def action_seed(self) -> None:
        """Make enter open the next seed."""
        self._seed = (self._seed + 1) % self._request.runs
        self._show()

    def action_open(self) -> None:
        """Answer the cell's run."""
        if self._scene.cursor in self._scene.atlas.impossible:
            self.app.bell()
            return
        self.dismiss(self._request.recipe_of(self._scene.cursor, self._request.seeds[self._seed]))
