"""No size of the terminal breaks a panel or a dialog, nor does a resize while one is open."""

from __future__ import annotations

from itertools import product

import pytest
from conftest import MakeApp
from lane_samples import side_by_side
from program_samples import failed, watched
from samples import bandit, lake, look, planning, stepped_lake, student
from seams import on_screen, screen_text, sized
from snapshots import changed
from study_samples import lake_study
from textual.pilot import Pilot
from textual.widget import Widget

from rl_tui.common.errors import UserError
from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.background.background import Background
from rl_tui.screen.draw.canvas import Canvas
from rl_tui.screen.keys.action import Place
from rl_tui.screen.keys.registry import actions_of
from rl_tui.screen.kit.panel import Panel
from rl_tui.screen.kit.row import WORLD, PanelRow
from rl_tui.screen.panels.catalogue import PANELS
from rl_tui.screen.panels.world_views import make_world_view
from rl_tui.screen.playground.playground import Playground

SIZES = [(1, 1), (5, 5), (20, 8), (7, 40), (200, 3)]
MORE = list(product((*range(1, 16), 40, 80, 250), (*range(1, 8), 18, 70)))
SMALL = [(20, 8), (7, 5)]
LEAVES = ("quit", "suspend", "back")
MOVES = ("run.", "previous_scenario", "next_scenario")  # these open nothing


def samples() -> list[Snapshot]:
    studied = changed(lake(), study=lake_study())
    ours = [lake(), lake(0), studied, student(), bandit(), stepped_lake(), planning(), side_by_side(2)]
    return [*ours, watched(), failed()]


@pytest.fixture
def no_app(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Widget, "size", property(lambda widget: widget.outer_size))


def panel_of(row: PanelRow, snapshot: Snapshot) -> Panel | None:
    """The panel, or None if it contains other widgets: the walk below draws those."""
    panel = make_world_view(snapshot.world, look()) if row.id == WORLD else row.make(look())
    return panel if isinstance(panel, Panel) else None


@pytest.mark.parametrize(
    "sizes",
    [
        pytest.param(SIZES, id="some"),
        pytest.param(MORE, id="all", marks=pytest.mark.exhaustive("162 sizes of every panel")),
    ],
)
@pytest.mark.parametrize("row", [row for row in PANELS if panel_of(row, lake(0))], ids=lambda row: row.id)
@pytest.mark.usefixtures("no_app")
def test_every_panel_draws_itself_at_any_size(row: PanelRow, sizes: list[tuple[int, int]]) -> None:
    for snapshot in samples():
        panel = panel_of(row, snapshot)
        panel.is_explained = True
        for width, height in sizes:
            sized(panel, width, height)
            panel.show(snapshot)
            rows = [panel.render_line(y) for y in range(height)]
            assert {row.cell_length for row in rows} == {width}


def test_a_canvas_leaves_out_whatever_would_stand_outside() -> None:
    style = look().palette.text
    for width, height in (0, 0), (1, 0), (1, 1), (3, 2):
        for x in range(-3, 5):
            for y in range(-2, 4):
                canvas = Canvas(width, height, style)
                canvas.put(x, y, "ab", style)
                canvas.put_over(x, y, "abc", style)
                canvas.put_cells(x, y, "abc", [style] * 3)
                canvas.restyle(x, y, 3, style)
                assert canvas.is_blank(x, y, 1) is False
                inside = [0 <= y < height and 0 <= x + place < width for place in range(3)]
                drawn = "".join(strip.text for strip in canvas.strips())
                assert sorted(drawn.strip()) == [
                    each for each, here in zip("abc", inside, strict=True) if here
                ]


@pytest.fixture
def no_processes(monkeypatch: pytest.MonkeyPatch) -> None:
    """Compute nothing in the background, which takes seconds."""
    monkeypatch.setattr(Background, "begin", lambda self, request, known: None)


def opened(pilot: Pilot[UserError]) -> list[object]:
    """Everything that can open over the playground, or in it."""
    boards = [each.board for each in pilot.app.screen_stack if isinstance(each, Playground)]
    return [*pilot.app.screen_stack, *(board.opened for board in boards)]


@pytest.mark.usefixtures("no_processes")
async def test_all_that_keys_open_can_be_opened_small_and_resized(make_app: MakeApp) -> None:
    async with on_screen(make_app("frozenlake")) as pilot:
        count = 0
        for action in actions_of(Place.PLAYGROUND):
            if action.id in LEAVES or action.id.startswith(MOVES):
                continue
            before = opened(pilot)
            await pilot.press(*(action.key.split() if action.menu else action.keys[:1]))
            await pilot.pause()
            if opened(pilot) != before:
                count += 1
                await pilot.resize_terminal(*SMALL[count % len(SMALL)])
                assert screen_text(pilot.app)
            while opened(pilot) != before:
                await pilot.press("escape")
        assert count >= 20
