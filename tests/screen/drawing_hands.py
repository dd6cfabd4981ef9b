"""Two ways to draw a map."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from seams import app_at, playground, press, snapshot
from textual.events import MouseScrollDown, MouseScrollUp
from textual.pilot import Pilot
from textual.widget import Widget

from rl_tui.common.errors import UserError
from rl_tui.runs.library import recipe_for
from rl_tui.screen.app.app import RlTuiApp
from rl_tui.screen.app.screenshot import settle
from rl_tui.screen.frame.key_line import KeyLine
from rl_tui.screen.frame.menu_strip import MenuRows
from rl_tui.screen.panels.controls.slider import Slider
from rl_tui.screen.panels.draw_panel import ToolRows
from rl_tui.screen.panels.grid.grid import GridView
from rl_tui.worlds.drawing import CellKind, Grid
from rl_tui.worlds.editing.drafts import first_draft
from rl_tui.worlds.editing.grid_draft import GridDraft
from rl_tui.worlds.editing.templates import template_text
from rl_tui.worlds.files.catalogue import find
from rl_tui.worlds.files.scenario import scenario_of
from rl_tui.worlds.grid.map import LegendEntry

Cell = tuple[int, int]
_PAINT = {".": ("full_stop", ". floor"), "#": ("number_sign", "# wall"), "S": ("S", "S start")} | {
    each: (each, f"{each} {word}") for each, word in (("G", "goal"), ("H", "hole"), ("X", "exit"))
}


@dataclass(frozen=True)
class Plan:
    lines: tuple[str, ...]
    rewards: Mapping[float, Sequence[Cell]] = field(default_factory=dict)
    """Rewards of cells that differ from those of their brush."""
    jump: tuple[Cell, Cell] | None = None
    numbers: Mapping[str, float] = field(default_factory=dict)
    """The numbers to set on sliders."""
    on_leaving: bool = False


def plan_of(scenario: str) -> Plan:
    """A file may use any characters for goals, holes and exits."""
    draft = first_draft(find(scenario), 0)
    assert isinstance(draft, GridDraft)
    lines, rewards, jump = [], dict[float, list[Cell]](), None
    for row, line in enumerate(draft.lines):
        brushes = ""
        for column, character in enumerate(line):
            entry = draft.legend[character]
            brush = _brush_of(entry)
            brushes += brush
            if not entry.is_wall and entry.pays != (1.0 if brush in "GX" else 0.0):
                rewards.setdefault(entry.pays, []).append((row, column))
            if entry.jump is not None:
                rows = [each.find(entry.jump) for each in draft.lines]
                jump = (row, column), next((r, c) for r, c in enumerate(rows) if c >= 0)
        lines.append(brushes)
    blank = {"noise": 0.0, "step_reward": 0.0, "time_limit": 200}
    numbers = {name: draft.rules.get(name, 0) for name in blank if draft.rules.get(name, 0) != blank[name]}
    return Plan(tuple(lines), rewards, jump, numbers, draft.rules.get("rewards") == "leaving")


def _brush_of(entry: LegendEntry) -> str:
    if entry.is_wall or entry.kind is CellKind.START:
        return "#" if entry.is_wall else "S"
    if entry.exit or not entry.ends:
        return "X" if entry.exit else "."
    return "G" if entry.kind is CellKind.GOAL else "H"


def app_of_template(template: str) -> RlTuiApp:
    scenario = scenario_of(template_text(template), Path("my-world.toml"))
    return app_at(recipe_for(scenario))


def map_drawn(pilot: Pilot[UserError]) -> GridDraft:
    draft = snapshot(pilot).editor.draft
    assert isinstance(draft, GridDraft)
    return draft


class Hands(ABC):
    def __init__(self, pilot: Pilot[UserError]) -> None:
        self.pilot = pilot

    async def draw(self, plan: Plan) -> None:
        await self.begin()
        rows, columns = len(plan.lines), len(plan.lines[0])
        await self.resize(rows - map_drawn(self.pilot).rows, "rows")
        await self.resize(columns - map_drawn(self.pilot).columns, "columns")
        await self.paint(plan.lines)
        for reward, cells in plan.rewards.items():
            await self.pay(reward, cells)
        if plan.jump is not None:
            await self.jump(*plan.jump)
        for name, value in plan.numbers.items():
            await self.set_number(name, value)
        if plan.on_leaving:
            await self.pay_on_leaving()
        await settle(self.pilot)

    @abstractmethod
    async def begin(self) -> None: ...

    @abstractmethod
    async def resize(self, by: int, what: str) -> None:
        """Add lines at the end, or delete the second one repeatedly. The first line holds the start."""

    @abstractmethod
    async def paint(self, lines: Sequence[str]) -> None: ...

    @abstractmethod
    async def pay(self, reward: float, cells: Sequence[Cell]) -> None: ...

    @abstractmethod
    async def jump(self, source: Cell, target: Cell) -> None: ...

    @abstractmethod
    async def set_number(self, name: str, value: float) -> None: ...

    @abstractmethod
    async def pay_on_leaving(self) -> None: ...

    @property
    def sliders(self) -> Sequence[Slider]:
        return playground(self.pilot).board.tools.sliders


class Keys(Hands):
    """Presses keys. They are typed ahead, with waits for pictures only where lines move."""

    _at: Cell = (0, 0)

    async def begin(self) -> None:
        await press(self.pilot, "w", "d")
        await self.pilot.press("down", "up")  # from here on the cursor does not move automatically

    async def _go(self, cell: Cell) -> None:
        (row, column), (to_row, to_column) = self._at, cell
        await self.pilot.press(*["down"] * (to_row - row), *["up"] * (row - to_row))
        await self.pilot.press(*["right"] * (to_column - column), *["left"] * (column - to_column))
        self._at = cell

    async def resize(self, by: int, what: str) -> None:
        await self._go((1, 0) if what == "rows" else (0, 1))
        last, away = (("w", "b"), ("w", "d")) if what == "rows" else (("w", "e"), ("w", "x"))
        await press(self.pilot, *last * by, *away * -by)
        rows, columns = map_drawn(self.pilot).rows, map_drawn(self.pilot).columns
        self._at = min(self._at[0], rows - 1), min(self._at[1], columns - 1)

    async def paint(self, lines: Sequence[str]) -> None:
        there = map_drawn(self.pilot).lines
        wanted = [((r, c), each) for r, line in enumerate(lines) for c, each in enumerate(line)]
        for cell, character in sorted(wanted, key=lambda each: each[1] != "S"):  # a start always exists
            if character == there[cell[0]][cell[1]] and character != "S":
                continue
            await self._go(cell)
            await self.pilot.press(_PAINT[character][0])

    async def pay(self, reward: float, cells: Sequence[Cell]) -> None:
        await self._go(cells[0])
        await self._type("equals_sign", reward)
        await self.pilot.press("comma")
        for cell in cells[1:]:  # as the first
            await self._go(cell)
            await self.pilot.press("enter")

    async def _type(self, key: str, number: float) -> None:
        await self.pilot.press(key, *f"{number:g}", "enter")

    async def jump(self, source: Cell, target: Cell) -> None:
        await self._go(source)
        await self.pilot.press("J")
        await self._go(target)
        await self.pilot.press("enter")

    async def set_number(self, name: str, value: float) -> None:
        number = next(place for place, each in enumerate(self.sliders, start=1) if each.id == name)
        await self.pilot.press(str(number), "enter", *f"{value:g}", "enter")

    async def pay_on_leaving(self) -> None:
        await press(self.pilot, "w", "r", *["down"] * 5, "enter", "down", "enter")


class Mouse(Hands):
    """Clicks, drags and turns the wheel at the places where a person sees their targets."""

    _places: dict[int, tuple[int, int]]

    async def begin(self) -> None:
        view, keys = self._view, self.pilot.app.screen.query_one(KeyLine)
        await self.pilot.click(view, offset=(5, 2))
        await settle(self.pilot)
        await self.pilot.click(keys, offset=(keys.render_line(0).text.index("edit the world"), 0))
        await settle(self.pilot)
        self._look()

    @property
    def _view(self) -> GridView:
        view = playground(self.pilot).board.world
        assert isinstance(view, GridView)
        return view

    def _look(self) -> None:
        view = self._view
        self._places = {}
        for y in range(view.size.height):
            for x in range(view.size.width):
                cell = view.place_at(x, y)
                if cell is not None:
                    self._places.setdefault(cell, (x + view.gutter.left, y + view.gutter.top))

    def offset(self, cell: Cell) -> tuple[int, int]:
        drawing = snapshot(self.pilot).world.drawing
        assert isinstance(drawing, Grid)
        return self._places[cell[0] * drawing.columns + cell[1]]

    async def tool(self, text: str) -> None:
        screen = self.pilot.app.screen
        await self._click_text(text, *screen.query(ToolRows))

    async def of_menu(self, label: str) -> None:
        rest = list(self.pilot.app.screen.query(ToolRows))[-1]
        await self.pilot.click(rest, offset=(1, rest.size.height - 1))
        await settle(self.pilot)
        await self._click_text(label, self.pilot.app.screen.query_one(MenuRows))

    async def _click_text(self, text: str, *widgets: Widget) -> None:
        places = ((each, y, each.render_line(y).text) for each in widgets for y in range(each.size.height))
        widget, y, row = next(each for each in places if text in each[2])
        await self.pilot.click(widget, offset=(row.index(text), y))

    async def drag(self, widget: Widget, first: tuple[int, int], last: tuple[int, int]) -> None:
        """Drag from one place of ``widget`` to another, too fast for any places between."""
        await self.pilot.mouse_down(widget, offset=first)
        await self.pilot.hover(widget, offset=last)
        await self.pilot.mouse_up(widget, offset=last)

    async def wheel(self, widget: Widget, offset: tuple[int, int], notches: int) -> None:
        kind = MouseScrollUp if notches > 0 else MouseScrollDown
        for _ in range(abs(notches)):
            x, y = widget.region.offset + offset
            event = kind(widget, *offset, 0, 0, 0, False, False, False, x, y)
            widget.post_message(event)
        await self.pilot.pause()

    async def resize(self, by: int, what: str) -> None:
        last, away = ("row below", "remove row") if what == "rows" else ("column right", "remove column")
        await self.tool("A arrow")
        await self.pilot.click(self._view, offset=self.offset((1, 0) if what == "rows" else (0, 1)))
        for _ in range(abs(by)):
            await self.of_menu(last if by > 0 else away)
            await settle(self.pilot)
        self._look()

    async def paint(self, lines: Sequence[str]) -> None:
        there, start = map_drawn(self.pilot).lines, None
        runs: dict[str, list[tuple[Cell, Cell]]] = {}
        for row, line in enumerate(lines):
            for column, wanted in enumerate(line):
                if wanted == "S":
                    start = row, column
                elif wanted != there[row][column]:
                    mine = runs.setdefault(wanted, [])
                    if mine and mine[-1][1] == (row, column - 1):
                        mine[-1] = mine[-1][0], (row, column)
                    else:
                        mine.append(((row, column), (row, column)))
        assert start is not None
        for character, pieces in {"S": [(start, start)], **runs}.items():
            await self.tool(_PAINT[character][1])
            for first, last in pieces:
                await self.drag(self._view, self.offset(first), self.offset(last))

    async def pay(self, reward: float, cells: Sequence[Cell]) -> None:
        draft = map_drawn(self.pilot)
        pays = draft.legend[draft.lines[cells[0][0]][cells[0][1]]].pays
        await self.tool("A arrow")
        await self.pilot.click(self._view, offset=self.offset(cells[0]))
        if abs(reward) == 10.0:
            await self._slide_to_end("pays", up=reward > 0)
        else:
            await self.wheel(self._view, self.offset(cells[0]), round(reward - pays))
        if len(cells) == 1:
            return
        await self.tool(", pick up")
        for cell in cells[1:]:  # as the first
            await self.pilot.click(self._view, offset=self.offset(cell))

    async def _slide_to_end(self, name: str, *, up: bool) -> None:
        await settle(self.pilot)
        slider = next(each for each in self.sliders if each.id == name)
        start = next(x for x, each in enumerate(slider.render_line(0).text) if each in "━─●")
        await self.drag(slider, (start + 3, 0), (slider.size.width - 1 if up else 0, 0))

    async def jump(self, source: Cell, target: Cell) -> None:
        await self.tool("A arrow")
        await self.pilot.click(self._view, offset=self.offset(source))
        await self.tool("J jump")
        await self.pilot.click(self._view, offset=self.offset(target))

    async def set_number(self, name: str, value: float) -> None:
        await settle(self.pilot)
        slider = next(each for each in self.sliders if each.id == name)
        now = slider.value
        assert isinstance(now, float)
        if value == slider.scale.low:
            await self._slide_to_end(name, up=False)
        else:
            await self.wheel(slider, (1, 0), round((value - now) / slider.scale.step))

    async def pay_on_leaving(self) -> None:
        await self.of_menu("on leaving")
