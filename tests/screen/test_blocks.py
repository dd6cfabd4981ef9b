"""Blocks in a limited width."""

from __future__ import annotations

import numpy as np
import pytest
from samples import look

from rl_tui.screen.draw.canvas import Piece
from rl_tui.screen.kit.blocks import Block, Column, Flow, Labelled, Row, Section, Table, Text, laid
from rl_tui.screen.kit.charts import Bar, SeedMarks, axis_of

pytestmark = pytest.mark.unit
STYLE = look().palette.text


def drawn(block: Block, width: int, *, ascii: bool = False) -> list[str]:  # noqa: A002
    lines = block.lines(width, look(ascii))
    return ["".join(piece.text for piece in line) for line in lines]


def table(*widths: int, **more: bool) -> Table:
    names = Column("", ["first", "second"], STYLE, right=False)
    figures = Column("mean", [".5", "−1.25"], STYLE), Column("steps", ["7", "12"], STYLE)
    forms = (names, *figures), (names, figures[0]), (names._replace(least=3), figures[0])
    return Table(forms, **more)


def test_a_row_has_the_longest_form_that_fits_or_what_stands_in_its_place() -> None:
    forms = [Piece("in full", STYLE)], [Piece("short", STYLE)]
    assert [drawn(Row(*forms), width) for width in (7, 6, 2)] == [["in full"], ["short"], ["short"]]
    assert drawn(Row(*forms, instead=[Text("a b", STYLE)]), 2) == [" a", " b"]
    assert drawn(Row([Piece("α → β", STYLE)], [Piece("short", STYLE)]), 5, ascii=True) == ["short"]


def test_a_text_may_be_made_for_its_width_and_none_takes_no_line() -> None:
    assert drawn(Text("one two", STYLE, "- ", "  "), 6) == ["- one", "  two"]
    assert drawn(Text(lambda width: "x" * width, STYLE, ""), 3) == ["xxx"]
    assert drawn(Text("", STYLE), 9) == []


def test_a_label_stands_beside_its_block_or_above_it() -> None:
    block = Labelled("γ", STYLE, 7, Text("one two", STYLE, "", ""), beside_from=10)
    assert drawn(block, 10) == [" γ     one", "       two"]
    assert drawn(block, 10, ascii=True) == [" gamma one", "       two"]
    assert drawn(block, 9) == [" γ", "   one", "   two"]


def test_groups_flow_and_a_heading_has_its_rule() -> None:
    groups = [[Piece(f"   {word}", STYLE)] for word in ("one", "two", "three")]
    assert drawn(Flow(groups, 2), 12) == [" one   two", "  three"]
    assert drawn(Section("The step", remarks=("of many", "7")), 14) == [" The step  7 ─"]


def test_a_table_leaves_columns_out_then_shortens_names() -> None:
    assert drawn(table(), 20) == ["         mean steps", " first     .5     7", " second −1.25    12"]
    assert drawn(table(), 18) == ["         mean", " first     .5", " second −1.25"]
    assert drawn(table(), 11) == ["       mean", " fir…    .5", " sec… −1.25"]
    assert drawn(table(), 11, ascii=True)[2] == " sec~ -1.25"


def test_a_table_that_does_not_fit_may_have_a_line_for_each_figure() -> None:
    assert drawn(table(is_stacked=True), 8) == [" first", "  .5", " second", "  −1.25"]
    wide = [Column("", ["name"], STYLE, right=False), Column("mean", ["1,000,000"], STYLE)]
    assert drawn(Table([wide]), 14)[1:] == [" name 1,000,000"]
    assert drawn(Table([wide], is_stacked=True), 14) == [" name", "  1,000,000"]


def test_rows_around_the_cursor_are_in_view_and_texts_that_have_room() -> None:
    texts = [Text("much too long for so little room as this", STYLE), Text("note", STYLE)]
    lines, places, free = laid([table()], 1, [], texts, (14, 5), look())
    assert ["".join(piece.text for piece in line).strip() for line in lines] == [
        "mean",
        "first     .5",
        "second −1.25",
        "",
        "note",
    ]
    assert (list(places), free) == ([1, 2], 0)
    lines, places, free = laid([table()], 1, texts, texts, (13, 1), look())
    assert [piece.text for piece in lines[0]] == [" second", " −1.25"]
    assert (list(places), free) == ([-1, 0], 0)


def test_charts_fill_the_room_that_columns_leave_else_a_line_of_their_own() -> None:
    values = 0.5, -1.25
    columns = [Column("", ["first", "second"], STYLE, right=False), Column("mean", [".5", "−1.25"], STYLE)]
    charts = {place: Bar(value, axis_of(values), STYLE) for place, value in enumerate(values)}
    assert drawn(Table([columns], charts=charts, least_chart=7), 21) == [
        "                 mean",
        " first      │█▌    .5",
        " second ████│   −1.25",
    ]
    assert drawn(Table([columns], charts=charts), 16)[1:3] == [" first     .5", "          │███▌"]


def test_a_bar_far_beyond_the_others_is_cut() -> None:
    axis = axis_of([-1_000.0, -10.0, -5.0])
    bars = [Bar(value, axis, STYLE).lines(7, look())[0] for value in (-1_000.0, -10.0, -5.0, 0.0)]
    texts = ["".join(piece.text for piece in bar) for bar in bars]
    assert texts == ["‹█████│", "  ████│", "    ██│", "      │"]


def test_bars_are_in_proportion_where_the_best_is_far_above_the_others() -> None:
    assert axis_of([0.014, 0.068, 0.74]) == (0.0, 0.74)


def test_seeds_are_marked_above_their_mean_and_its_error() -> None:
    spread = SeedMarks(np.array([0.0, 0.5, 0.5, 1.0]), 0.0, 0.5, 0.25, (0.0, 1.0), ("0", "1"), STYLE)
    lines = ["".join(piece.text for piece in line) for line in spread.lines(13, look())]
    assert lines == ["  ◆   ▄   ▂  ", "0 ──━━●━━── 1"]
    assert not spread.lines(5, look())


def test_nothing_to_show_takes_no_line() -> None:
    word = [Piece("   one", STYLE)]
    assert drawn(Flow([[], word, []]), 12) == [" one"]
    assert [drawn(Table(forms), 12) for forms in ((), ([],))] == [[], []]
