"""Captions and legends of panels."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from conftest import MakeApp
from drawn_grids import paying
from rich.segment import Segment
from rich.style import Style
from samples import answered, bandit, curve, lake, look, student
from seams import app_at, on_screen, playground, press, train
from snapshots import changed
from textual.geometry import Size
from textual.strip import Strip

from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.library import recipe_for
from rl_tui.runs.timeline.branches import Branch, Timeline
from rl_tui.screen.app.app import RlTuiApp
from rl_tui.screen.catalogue.preview import beginning_of
from rl_tui.screen.draw.names import landmark
from rl_tui.screen.kit.layers import Layer
from rl_tui.screen.kit.panel import LegendSign, Panel, legend_text
from rl_tui.screen.kit.row import CONTROLS, CURVE, LAST_STEP, TABLE, WORLD
from rl_tui.screen.panels.arms import ArmsView
from rl_tui.screen.panels.catalogue import PANELS
from rl_tui.screen.panels.curve.curve import ReturnCurve
from rl_tui.screen.panels.curve.text import BELOW_AXIS
from rl_tui.screen.panels.graph.graph import GraphView
from rl_tui.screen.panels.grid.grid import PALE, GridView
from rl_tui.screen.panels.q_table.q_table import QTable
from rl_tui.screen.panels.q_table.sheet import rare_signs
from rl_tui.screen.panels.world.scale_line import ALL_ZERO
from rl_tui.worlds.drawing import CellKind, Grid
from rl_tui.worlds.files.catalogue import find
from rl_tui.worlds.mdp.space import FloatArray

CAPTIONS = {row.id: row.caption for row in PANELS}


def explained(panel: Panel, snapshot: Snapshot, width: int, height: int) -> Panel:
    panel.__class__ = type("Sized", (type(panel),), {"size": Size(width, height)})
    panel.is_explained = True
    panel.show(snapshot)
    return panel


def rows(panel: Panel) -> list[str]:
    return [panel.render_line(y).text.rstrip() for y in range(panel.size.height)]


def legend(panel: Panel) -> list[str]:
    assert panel.snapshot is not None
    return [f"{each.sign.strip()} {each.meaning}" for each in panel.legend(panel.snapshot)]


def test_a_legend_touches_the_table_if_a_row_is_free() -> None:
    table = explained(QTable(look()), lake(), 64, 14)
    assert rows(table)[12] == " ▌▐ greedy: looks best  ▐ just updated  ◉ agent  · not tried"
    assert "greedy" not in table.foot


def test_without_a_free_row_it_is_on_the_border_as_far_as_there_is_room() -> None:
    for width, expected in (
        (70, "▌▐ greedy · ▐ just updated · ◉ agent · v  Q"),
        (60, "▌▐ greedy · ▐ just updated · v  Q"),
        (44, "▌▐ greedy · v  Q"),
    ):
        assert explained(QTable(look()), lake(), width, 12).foot.startswith(expected)


def test_signs_on_the_border_have_the_styles_that_they_explain() -> None:
    table = explained(QTable(look()), lake(), 70, 12)
    palette = look().palette
    styled = [(each.text, each.style) for each in table.foot_pieces(table.foot, look())]
    assert styled[0] == ("▌▐", palette.best)
    assert ("◉", palette.agent) in styled
    assert styled[1] == (" greedy · ", palette.dim)


def test_signs_stand_closer_where_all_of_them_fit_so() -> None:
    signs = tuple(LegendSign(sign, meaning, Style()) for sign, meaning in (("a", "agent"), ("b", "hole")))
    assert legend_text(signs, 16, look()) == "a agent · b hole"
    assert legend_text(signs, 15, look()) == "a agent, b hole"
    assert legend_text(signs, 14, look()) == "a agent"


def test_what_stands_on_the_border_already_stays_there() -> None:
    table = explained(QTable(look()), lake(), 36, 12)
    assert table.foot.endswith("v  Q  Q*  Q−Q*  visits ")
    table = explained(QTable(look()), lake(), 60, 12)
    assert table.foot.startswith("▌▐ greedy")


@pytest.mark.parametrize("in_ascii", [False, True])
@pytest.mark.parametrize(
    ("kind", "made"),
    [
        ("grid", lambda shown, look: GridView(shown.world, look)),
        ("graph", lambda shown, look: GraphView(shown.world, look)),
        ("arms", lambda shown, look: ArmsView(shown.world, look)),
        ("table", lambda shown, look: QTable(look)),
    ],
)
def test_a_legend_has_signs_that_are_drawn_and_no_others(kind: str, made: object, in_ascii: bool) -> None:
    assert callable(made)
    snapshot = {"graph": student(), "arms": bandit(400)}.get(kind, lake())
    panel: Panel = made(snapshot, look(in_ascii))
    drawn = "\n".join(strip.text for strip in panel.picture(snapshot, 58, 22))
    for sign in panel.legend(snapshot):
        of_blocks = () if in_ascii else ("◉", "●", "★", "▲")  # with large cells
        told = sign.sign.strip() in ("tint", "bold", *of_blocks)
        assert told or set(sign.sign) <= set(drawn), sign


def test_true_means_and_the_best_arm_have_signs_once_they_are_revealed() -> None:
    signs = {"◆ true mean", "★ best arm"}
    for is_hidden in (True, False):
        shown = changed(bandit(400), is_hidden=is_hidden)
        told = legend(explained(ArmsView(shown.world, look()), shown, 60, 22))
        assert signs & set(told) == (set() if is_hidden else signs)


def test_only_what_occurs_in_the_scenario_has_a_sign() -> None:
    assert "╱ cliff" not in legend(explained(GridView(lake().world, look()), lake(), 60, 13))
    table = explained(QTable(look()), bandit(400), 60, 20)
    assert legend(table) == ["▌▐ greedy", "▐ just updated", "◉ last pull", "· not tried"]


@pytest.mark.parametrize(("scenario", "ends"), [("bridge", "●★ exit"), ("maze-188", "★ exit")])
def test_exits_have_one_sign_and_no_letter(scenario: str, ends: str) -> None:
    start = beginning_of(find(scenario), find(scenario).section.build(np.random.default_rng(0)))
    shown = legend(explained(GridView(start.world, look()), start, 100, 40))
    assert [entry for entry in shown if "exit" in entry] == [ends]


@pytest.mark.parametrize("layer", [Layer.Q, Layer.ERROR, Layer.VISITS])
def test_arrows_are_explained_in_a_colour_of_the_layer(layer: Layer) -> None:
    shown = answered(lake())
    view = GridView(shown.world, look())
    view.cell, view.wanted_layer = Size(13, 5), layer
    view.show(shown)
    view.picture(shown, 52, 21)
    tints = {style.bgcolor for style in view.tints.tints(look().palette)}
    (arrow,) = (sign.style for sign in view.legend(shown) if sign.meaning in ("greedy", PALE))
    assert arrow.bgcolor in tints


def test_an_end_whose_name_is_a_word_is_called_so() -> None:
    picture = lake()
    world, space = picture.world, picture.world.space
    assert isinstance(world.drawing, Grid)
    kinds = [world.drawing.kinds[cell] for cell in world.drawing.cell_of_state]
    hole, goal = kinds.index(CellKind.HOLE), kinds.index(CellKind.GOAL)
    names = [{hole: "lost", goal: "won"}.get(place, name) for place, name in enumerate(space.state_names)]
    cards = replace(world, space=replace(space, state_names=names))
    shown = legend(explained(GridView(cards, look()), replace(picture, world=cards), 60, 13))
    assert {"● hole", "★ won"} <= set(shown)  # there are several holes
    assert [landmark(world, each) for each in (hole, goal)] == ["hole", "goal"]
    assert [landmark(cards, each) for each in (hole, goal)] == ["", ""]


def with_q(q: FloatArray) -> Snapshot:
    return lake(q=q, visits=np.zeros(44, dtype=np.int64))


def tied(shown: Snapshot) -> Snapshot:
    q = shown.agent.q.copy()
    q[:4] = 0.5, 0.5, 0.0, 0.0
    return changed(shown, q=q)


def test_ties_have_a_sign_where_arrows_have_no_room() -> None:
    assert "* tie" in legend(explained(GridView(lake().world, look()), tied(lake()), 24, 4))
    assert "* tie" not in legend(explained(GridView(lake().world, look()), tied(lake()), 60, 12))
    assert "* tie" not in legend(explained(GridView(lake().world, look()), lake(), 24, 4))


def test_arrows_are_explained_as_pale_or_plain_or_not_where_there_is_none() -> None:
    def map_of(shown: Snapshot) -> GridView:
        return GridView(shown.world, look())

    one = np.zeros(44)
    one[4] = 1.0
    close = one.copy()
    close[5] = 0.999
    said = [
        "".join(legend(explained(map_of(shown), shown, 60, 12)))
        for shown in map(with_q, (one * 0, one, close))
    ]
    assert ["pale" in each for each in said] == [False, False, True]
    assert ["▲ greedy" in each for each in said] == [False, True, False]


def test_no_tint_is_explained_where_there_are_no_colours() -> None:
    for depth in ("truecolor", "256", "16", "none"):
        view = GridView(lake().world, look(depth=depth))
        view.shows_actions = True
        assert ("tint Q" in legend(explained(view, lake(), 60, 13))) is (depth != "none")


def test_rewards_and_ties_have_signs_of_their_own() -> None:
    shown = tied(paying())
    small = explained(GridView(shown.world, look()), shown, 25, 2)
    assert legend(small)[:2] == ["+− reward", "* tie"]
    ascii_only = explained(GridView(shown.world, look(ascii=True)), shown, 25, 2)
    assert legend(ascii_only)[:2] == ["+- reward", "* tie"]
    large = explained(GridView(shown.world, look()), shown, 60, 6)
    assert legend(large)[0] == "+1 reward"


def test_a_kind_of_cell_in_which_something_can_be_done_has_no_sign() -> None:
    shown = paying()  # a jump leads away from its goal
    assert "★ goal" not in legend(explained(GridView(shown.world, look()), shown, 60, 6))


def test_a_legend_is_told_in_full_where_all_of_it_has_room() -> None:
    for width, expected in ((90, "▌▐ greedy: looks best"), (70, "▌▐ greedy")):
        assert explained(QTable(look()), lake(), width, 12).foot.split(" · ")[0] == expected


@pytest.mark.screen
async def test_a_key_hides_captions_and_legends_and_shows_them_again(make_app: MakeApp) -> None:
    async with on_screen(make_app("frozenlake"), (120, 40)) as pilot:
        await train(pilot, 2)
        board = playground(pilot).board
        titles = {each: board.panel(each).head for each in (TABLE,)}
        assert all(CAPTIONS[each] in title for each, title in titles.items())
        world = board.panel(WORLD)
        assert "◉ agent" in world.render_line(world.size.height - 1).text
        await press(pilot, "m", "l")
        assert world.render_line(world.size.height - 1).text.rstrip() == f"value: {ALL_ZERO}"
        for each in (WORLD, TABLE, CURVE, LAST_STEP, CONTROLS):
            panel = board.panel(each)
            assert CAPTIONS[each] not in panel.head
            layers = "v  Q  Q*  Q−Q*  visits "
            assert panel.foot in ("", layers, f"{layers} landscape ")
        await press(pilot, "m", "l")
        assert {each: board.panel(each).head for each in titles} == titles


@pytest.mark.screen
async def test_hidden_legends_stay_hidden_the_next_time(tmp_path: Path) -> None:
    folder = tmp_path / "state" / "sessions"

    def app() -> RlTuiApp:
        return app_at(recipe_for(find("student")), sessions=folder)

    for expected in (True, False, True):
        async with on_screen(app()) as pilot:
            assert playground(pilot).board.legends.is_on is expected
            await press(pilot, "m", "l")


@pytest.mark.screen
async def test_where_nothing_can_be_kept_nothing_is_remembered(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    app = app_at(recipe_for(find("student")), sessions=tmp_path / "file" / "sessions")
    async with on_screen(app) as pilot:
        await press(pilot, "m", "l")
        assert not playground(pilot).board.legends.is_on


@pytest.mark.parametrize("in_ascii", [False, True])
def test_almost_zero_is_explained_in_a_table_that_has_it(in_ascii: bool) -> None:
    above, below = ("0+", "0-") if in_ascii else ("0⁺", "0⁻")
    signs = rare_signs([Strip([Segment(f" 1.0 {above}")])], look(in_ascii))
    assert [(each.sign, each.meaning) for each in signs] == [(above, "just above 0")]
    assert not rare_signs([Strip([Segment(" 1.0 <.01 ")])], look(in_ascii))
    assert [each.sign for each in rare_signs([Strip([Segment(f"9 {below}")])], look(in_ascii))] == [below]


def test_the_heading_of_the_curve_explains_marks_below_it_and_on_the_timeline() -> None:
    timeline = Timeline((Branch("branch 1", end=150_000, here=150_000),))
    shown = lake(curve=curve(40, 0.0, 0.5, 300), timeline=timeline)
    for snapshot, is_told in ((shown, True), (lake(0), False)):
        panel = explained(ReturnCurve(look()), snapshot, 120, 9)
        assert ("┃ new greedy policy" in panel.heading) is is_told
    low = lake(curve=curve(40, -90.0, 0.5, 300))
    assert f"▾ {BELOW_AXIS}" in explained(ReturnCurve(look()), low, 120, 9).heading


def test_a_differing_cell_has_one_neutral_mark_in_map_and_legend() -> None:
    view, palette = GridView(lake().world, look()), look().palette
    view.differing = frozenset({0})
    rows = explained(view, lake(), 60, 22).picture(lake(), 60, 22)
    drawn = next(segment for strip in rows for segment in strip if "◤" in segment.text)
    assert view.legend(lake())[0] == LegendSign("◤", "differs", palette.text)
    assert drawn.style is not None
    assert drawn.style in palette.values
