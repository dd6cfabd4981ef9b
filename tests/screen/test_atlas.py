"""The settings map and its keys."""

from __future__ import annotations

from dataclasses import replace

import pytest
from conftest import MakeApp
from rich.style import Style
from seams import on_screen, playground, press, screen_text, snapshot

from rl_tui.screen.app.screenshot import settle
from rl_tui.screen.atlas.atlas import AtlasDialog, AtlasScene, MapPicture, cell_line, head, legend
from rl_tui.screen.theme.glyphs import ASCII, UNICODE
from rl_tui.screen.theme.look import Look, palette_for
from rl_tui.studies.atlas import request as atlas_request
from rl_tui.studies.atlas import request as axes
from rl_tui.studies.atlas.cells import CellGrid
from rl_tui.studies.atlas.figures import Atlas, AtlasCell, AtlasStandings, AtlasState
from rl_tui.studies.sweeps.cell import MEASURES
from rl_tui.studies.sweeps.cells.variation import Variation

GRID = CellGrid((Variation("epsilon", (0.0, 0.1)), Variation("alpha", (0.1, 0.5, 1.0))))
LOOK = Look(UNICODE, palette_for("truecolor", dark=True))


def cell(mean: float) -> AtlasCell:
    figures = {"mean": mean, "median": mean, "low": mean - 0.1, "high": mean + 0.1, "count": 10}
    return AtlasCell(10, figures={"area": figures})


def scene(atlas: Atlas, look: Look = LOOK, cursor: int = 0) -> AtlasScene:
    return AtlasScene(look, GRID, atlas, MEASURES["area"], cursor, in_force=4)


PART = Atlas(
    AtlasState.RUNNING,
    {1: cell(0.25), 4: cell(0.75), 5: cell(0.5), 2: AtlasCell(10, 10, failure="it ran away")},
    {3: "that cannot be"},
    {"area": AtlasStandings(4, frozenset({4, 5}))},
    episodes=50,
    done=40,
    planned=60,
)


def lines(drawn: AtlasScene, width: int = 40, height: int = 8) -> list[str]:
    return [strip.text.rstrip() for strip in MapPicture(drawn, width, height).drawn().strips()]


def test_the_map_has_a_number_or_a_sign_in_every_cell() -> None:
    text = lines(scene(PART))
    assert text[0].split() == ["ε", "↑", "α", "→"]
    assert "×" in text[2]
    assert "[0.750*]" in text[2]
    assert "0.500" in text[2]
    assert "·" in text[5]
    assert "0.250" in text[5]
    assert "fails" in text[5]
    assert text[7].split() == ["0.1", "0.5", "1"]


def test_the_narrowest_cells_have_room_for_three_digits_and_a_sign() -> None:
    far = replace(PART, cells={1: cell(-447.0), 4: cell(-702.0), 5: cell(-56.0)})
    text = lines(scene(far), width=19)
    assert "-702*" in text[2].replace("−", "-")
    assert "-447" in text[5].replace("−", "-")


def test_numbers_stand_in_the_middle_of_their_cells_above_their_names() -> None:
    text = lines(scene(PART))
    assert text[5].index("0.250") == text[7].index("0.5") - 1


def test_in_ascii_it_is_ascii() -> None:
    drawn = scene(PART, Look(ASCII, palette_for("none", dark=True)))
    assert all(line.isascii() for line in lines(drawn))


def test_colours_go_from_the_worst_to_the_best() -> None:
    drawn, palette = scene(PART), LOOK.palette
    assert drawn.style(4) == palette.value(1.0) + Style(bold=True)
    assert drawn.style(1) == palette.value(0.0)
    assert drawn.style(0) == palette.unvisited
    lower_is_better = replace(drawn, measure=MEASURES["regret"])
    assert lower_is_better.ends is None


@pytest.mark.parametrize(("width", "height"), [(76, 15), (116, 22), (40, 8)])
def test_each_cell_is_found_where_it_is_drawn(width: int, height: int) -> None:
    plan = MapPicture(scene(PART), width, height)
    for index in range(GRID.count):
        x, y = plan.place(index)
        assert plan.cell_at(x, y) == plan.cell_at(x + plan.field - 1, y + plan.tall - 1) == index
    assert plan.cell_at(0, 1) is None


def test_it_can_be_drawn_at_any_size() -> None:
    for width in range(1, 70, 3):
        for height in (*range(1, 12), 40):
            for cursor in range(GRID.count):
                assert len(lines(scene(PART, cursor=cursor), width, height)) == height


def test_words_say_what_a_cell_is_and_how_far_all_is() -> None:
    drawn = scene(PART, cursor=4)
    assert "10 seeds of 50 episodes" in head(drawn, 10)
    assert head(drawn, 10).endswith("40 of 60 runs")
    assert head(drawn, 10, "how long").endswith("40 of 60 runs, how long")
    assert head(scene(Atlas()), 10, "how long").endswith(", how long")
    assert "how long" not in head(scene(replace(PART, state=AtlasState.DONE)), 10, "how long")
    assert "mean 0.750 (95 %: 0.650 to 0.850)" in cell_line(drawn)
    assert "not done yet" in cell_line(scene(PART))
    assert "impossible" in cell_line(scene(PART, cursor=3))
    assert "it ran away" in cell_line(scene(PART, cursor=2))
    assert "worst 0.250" in legend(drawn)
    assert legend(scene(Atlas())) == ""


@pytest.fixture
def small_atlas(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(atlas_request, "RUNS", 2)
    monkeypatch.setattr(atlas_request, "episodes_of", lambda scenario: 10)
    monkeypatch.setattr(axes, "MOST_COLUMNS", 3)
    monkeypatch.setattr(axes, "MOST_ROWS", 3)


@pytest.mark.process
@pytest.mark.usefixtures("small_atlas")
async def test_escape_leaves_the_run_as_it_is_and_enter_opens_that_of_a_cell(make_app: MakeApp) -> None:
    async with on_screen(make_app("student"), notifications=True) as pilot:
        before = playground(pilot.app)
        first = snapshot(pilot.app).recipe
        await press(pilot, "t", "s", "left", "escape")
        await settle(pilot)
        assert playground(pilot.app) is before
        await press(pilot, "t", "s")
        await settle(pilot)
        assert isinstance(pilot.app.screen, AtlasDialog)
        text = screen_text(pilot.app)
        assert "Settings map · ε × α" in text
        assert "runs done" in text
        assert f"enter: open seed {first.seed}" in text
        await press(pilot, "m", "right", "up", "n", "enter")
        await settle(pilot)
        opened = playground(pilot.app).recipe
        assert opened.seed == first.seed + 1
        assert opened.hyperparameters.alpha != first.hyperparameters.alpha
        assert opened.hyperparameters.epsilon != first.hyperparameters.epsilon
        assert opened.scenario is first.scenario


@pytest.mark.screen
async def test_where_there_is_none_it_says_why(make_app: MakeApp) -> None:
    async with on_screen(make_app("blackjack"), notifications=True) as pilot:
        await press(pilot, "t", "s")
        assert "simulated environment" in screen_text(pilot.app)
