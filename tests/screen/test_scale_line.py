"""The line below a world."""

from __future__ import annotations

from dataclasses import replace

import pytest
from samples import bandit, lake, look, student
from snapshots import changed
from test_value_scale import with_policies
from textual.geometry import Size

from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.answers.policy_kind import PolicyKind
from rl_tui.screen.draw.canvas import Piece
from rl_tui.screen.kit.layers import Layer
from rl_tui.screen.kit.panel import LegendSign
from rl_tui.screen.kit.value_scale import Ramp, ValueScale
from rl_tui.screen.panels.arms import ArmsView
from rl_tui.screen.panels.graph.graph import GraphView
from rl_tui.screen.panels.grid.grid import PALE, GridView
from rl_tui.screen.panels.world.scale_line import NOTHING_KNOWN, NamedScale, scale_line
from rl_tui.screen.panels.world.view import WorldView
from rl_tui.worlds.drawing import Grid

PALETTE = look().palette
AGENT = LegendSign("◉", "agent", PALETTE.agent)
TRAIL = LegendSign("•", "trail", PALETTE.strong)
VALUES = NamedScale("value", ValueScale(0.0, 0.86))


def line_below(
    view: WorldView, snapshot: Snapshot, width: int = 70, *, cell: int = 17, explained: bool = True
) -> str:
    view.cell, view.is_explained = Size(cell, 6), explained
    view.show(snapshot)
    return view.picture(snapshot, width, 25)[-1].text.strip()


def test_word_and_ends_come_first_then_signs_as_there_is_room() -> None:
    ramp = " " * len(PALETTE.values)
    strip = scale_line((), VALUES, (AGENT, TRAIL), 70, look())
    assert strip.text.rstrip() == f"value 0 {ramp} .86  ◉ agent  • trail"
    assert {each.style for each in strip if not each.text.strip()} >= set(PALETTE.values)
    for width, signs in ((49, "  ◉ agent  • trail"), (32, "  ◉ agent"), (24, "")):
        strip = scale_line((), VALUES, (AGENT, TRAIL), width, look())
        assert strip.text.rstrip() == f"value 0 {ramp[::2]} .86{signs}"


def test_the_scale_gets_coarser_and_then_leaves_its_word_where_there_is_little_room() -> None:
    errors = NamedScale("error", ValueScale(-0.5, 0.5, Ramp.ERRORS))
    for named, width, scale in (
        (VALUES, 19, f"value 0 {' ' * 6} .86"),
        (VALUES, 10, ""),
        (errors, 10, "error"),
        (errors, 4, ""),
    ):
        assert scale_line((), named, (), width, look()).text.rstrip() == scale


def test_a_studied_policy_is_named_in_fewer_words_where_the_scale_needs_their_room() -> None:
    shown = with_policies(lake(), PolicyKind.GREEDY, greedy=0.6)
    for width, name in (
        (70, "World · V of the greedy policy"),
        (50, "V of the greedy policy"),
        (38, "V: greedy"),
    ):
        assert f"{name}  value 0 " in line_below(GridView(shown.world, look()), shown, width, cell=9)


def test_what_is_said_of_mode_lane_or_cursor_comes_before_it() -> None:
    said = (Piece("1 q-learning", PALETTE.strong),)
    assert scale_line(said, VALUES, (AGENT,), 60, look()).text.startswith("1 q-learning  value 0 ")


def test_before_anything_is_known_it_says_so() -> None:
    unknown = NamedScale("value", ValueScale())
    assert scale_line((), unknown, (), 40, look()).text.rstrip() == f"value: {NOTHING_KNOWN}"


@pytest.mark.parametrize("in_ascii", [False, True])
def test_without_colours_it_has_both_ends(in_ascii: bool) -> None:
    plain = look(in_ascii, depth="none")
    assert scale_line((), VALUES, (), 40, plain).text.rstrip() == "value 0 to .86"


def test_a_map_has_it_with_and_without_its_signs() -> None:
    assert line_below(GridView(lake().world, look()), lake()).endswith(f"  ◉ agent  ▲ {PALE}  ● hole")
    bare = line_below(GridView(lake().world, look()), lake(), explained=False)
    assert bare.startswith("value 0 ")
    assert bare.endswith(" .60")


def test_a_grey_cell_of_a_state_never_tried_is_told_from_an_error_of_zero() -> None:
    visits = lake().agent.visits.copy()
    for tried, layer, is_told in (
        (True, Layer.ERROR, False),
        (False, Layer.ERROR, True),
        (False, Layer.Q, False),
    ):
        visits[:4] = tried
        q = lake().agent.q.copy()
        q[:4] = 0.0
        shown = changed(lake(), q=q, visits=visits)
        view = GridView(shown.world, look())
        view.wanted_layer = layer
        assert ("◉ agent  · not tried" in line_below(view, shown)) is is_told


def test_a_graph_has_it_and_arms_have_their_signs_alone() -> None:
    assert line_below(GraphView(student().world, look()), student()).startswith("value 0 ")
    below = line_below(ArmsView(bandit(400).world, look()), bandit(400))
    assert below.startswith("━ standard error  ◉ last pull")


def test_a_lane_and_a_mode_are_named_before_the_scale() -> None:
    view = GridView(lake().world, look())
    view.lane = ("1 Q-learning",)
    assert line_below(view, lake(), 110).startswith("1 Q-learning")
    assert "value 0" in line_below(view, lake(), 110)
    view.title, view.prompt = ("You draw the world",), ("esc: end",)
    assert line_below(view, lake(), 110).startswith("You draw the world   esc: end  value 0")


def test_without_a_board_there_is_no_such_line() -> None:
    view = GridView(lake().world, look())
    assert "value" not in "".join(strip.text for strip in view.picture(lake(), 70, 25))


def test_a_name_leaves_room_for_what_is_said_with_it() -> None:
    view = GridView(lake().world, look())
    view.title = ("You draw the world here and there", "You draw the world")
    view.prompt = ("enter: paint it all · esc: end", "esc: end")
    for width, line in (
        (72, "You draw the world here and there   enter: paint it all · esc: end"),
        (50, "You draw the world here and there   esc: end"),
        (36, "You draw the world   esc: end"),
    ):
        assert line_below(view, lake(), width) == line


def test_what_rows_and_columns_mean_leaves_room_for_the_scale() -> None:
    drawing = lake().world.drawing
    assert isinstance(drawing, Grid)
    world = replace(
        lake().world, drawing=replace(drawing, legend="sum down, dealer across, blocks: usable ace")
    )
    shown = changed(lake(), world=world)
    for width, said in (
        (100, "sum down, dealer across, blocks: usable ace"),
        (70, "sum down, dealer across"),
    ):
        assert line_below(GridView(world, look()), shown, width).startswith(f"{said}  value 0 ")
