"""No size of the terminal breaks a panel or a dialog."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from conftest import MakeApp
from drawn_curves import flat
from lane_samples import side_by_side
from program_samples import failed, watched
from rich.cells import cell_len
from samples import bandit, big_lake, lake, look, planning, stepped_lake, student
from seams import on_screen, screen_text, sized
from snapshots import changed
from study_samples import bandit_study, cliff_study, lake_study
from textual.pilot import Pilot
from textual.widget import Widget

from rl_tui.common.errors import UserError
from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.runs.background.background import Background
from rl_tui.screen.draw.canvas import Canvas
from rl_tui.screen.keys.action import Place
from rl_tui.screen.keys.registry import actions_of
from rl_tui.screen.kit.panel import Panel
from rl_tui.screen.kit.row import CURVE, WORLD, PanelRow
from rl_tui.screen.panels.catalogue import PANELS
from rl_tui.screen.panels.world_views import make_world_view
from rl_tui.screen.playground.playground import Playground
from rl_tui.screen.theme.glyphs import UNICODE
from rl_tui.screen.theme.look import Look
from rl_tui.studies.many_seeds.figures import SeedStudy, StudyState

SIZES = [(1, 1), (5, 5), (13, 2), (20, 8), (36, 13), (7, 40), (120, 20), (200, 3)]
MORE = list(product((*range(1, 16), 40, 80, 250), (*range(1, 8), 18, 70)))
SMALL = [(20, 8), (7, 5)]
LEAVES = ("quit", "suspend", "back")
MOVES = ("run.", "previous_scenario", "next_scenario")  # these open nothing


def samples() -> list[Snapshot | None]:
    start = [None, lake(0), student(0), bandit(0), bandit(400), changed(lake(), is_hidden=True)]
    ours = [lake(), student(), bandit(), big_lake(), stepped_lake(), planning(), watched(), failed()]
    moving, equal = changed(lake(), phase=Phase.RUNNING, speed=None), lake(curve=flat(1.0))
    lanes = [side_by_side(2), side_by_side(4, 3), side_by_side(2, 1, study=cliff_study())]
    of_arms = bandit(400, study=bandit_study(), is_hidden=False)
    refused = SeedStudy(StudyState.FAILED, message="not in a kiosk")
    studied = [lake(study=lake_study()), lake(study=refused), of_arms]
    return [*start, *ours, moving, equal, *lanes, *studied]


def odd() -> list[Snapshot]:
    far = np.array([np.nan, np.inf, -1e15, 0.0, 123_456.0])
    return [lake(q=np.full(44, np.inf)), student(q=far), bandit(q=np.tile(far, 2))]


@pytest.fixture
def no_app(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Widget, "size", property(lambda widget: widget.outer_size))


def panel_of(row: PanelRow, snapshot: Snapshot | None, of: Look) -> Panel | None:
    """The panel, or None if it contains other widgets: the walk below draws those."""
    panel = row.make(of)
    if row.id == WORLD and snapshot is not None:
        panel = make_world_view(snapshot.world, of)
    return panel if isinstance(panel, Panel) else None


@pytest.mark.parametrize(
    "sizes",
    [
        pytest.param(SIZES, id="some"),
        pytest.param(MORE, id="all", marks=pytest.mark.exhaustive("162 sizes of every panel")),
    ],
)
@pytest.mark.parametrize(
    "row", [row for row in PANELS if panel_of(row, lake(0), look())], ids=lambda row: row.id
)
@pytest.mark.parametrize("plain", [False, True])
@pytest.mark.usefixtures("no_app")
def test_every_panel_draws_itself_at_any_size(
    row: PanelRow, plain: bool, sizes: list[tuple[int, int]]
) -> None:
    for snapshot in samples():
        panel = panel_of(row, snapshot, look(plain, "none" if plain else "truecolor"))
        for width, height in sizes[:: 1 + plain] if panel else ():
            check_picture(panel, snapshot, width, height)
            if snapshot is not None:
                panel.is_explained = True
                sized(panel, width, height).show(snapshot)
                rows = [panel.render_line(y) for y in range(height)]
                assert {each.cell_length for each in rows} == {width}
                assert not plain or "".join(each.text for each in rows).isascii()


def check_picture(panel: Panel, snapshot: Snapshot | None, width: int, height: int) -> None:
    strips = panel.picture(snapshot, width, height)
    assert [strip.cell_length for strip in strips] == [width] * height
    assert all(segment.style is not None for strip in strips for segment in strip)
    assert panel.look.glyphs is UNICODE or "".join(strip.text for strip in strips).isascii()
    assert panel.id != CURVE or cell_len(panel.heading) <= width


@pytest.mark.parametrize("plain", [False, True])
@pytest.mark.parametrize("size", SIZES)
def test_every_world_draws_itself_whatever_its_values_are(size: tuple[int, int], plain: bool) -> None:
    for snapshot in odd():
        view = make_world_view(snapshot.world, look(plain, "none" if plain else "truecolor"))
        check_picture(view, snapshot, *size)


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
