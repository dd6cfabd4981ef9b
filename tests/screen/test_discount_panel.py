"""The panel of γ."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import cache
from itertools import product
from typing import Any

import numpy as np
import pytest
from conftest import MakeApp
from rich.style import Style
from samples import bandit, lake, look, student
from seams import on_screen, playground, press, screen_text, snapshot, switch
from snapshots import changed

from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.answers.flip_answer import HELD_UP, FlipAnswer, FlipState, refused, worked_out
from rl_tui.runs.answers.view import AnswersView
from rl_tui.runs.library import recipe_named
from rl_tui.runs.recipe import begin
from rl_tui.screen.draw import braille
from rl_tui.screen.kit.panel import legend_rows
from rl_tui.screen.kit.snapshot_facts import ANSWER_KEY
from rl_tui.screen.panels.discount import HIDDEN, NO_FLIPS, PENDING, DiscountPanel, fitting_form
from rl_tui.screen.panels.discount_chart import ActionLine, action_lines, best_two, draw_values, ranked
from rl_tui.screen.theme.glyphs import UNICODE
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

SIZES = ((118, 30), (58, 19), (56, 20), (36, 19), (36, 13), (26, 7), (16, 10), (5, 3), (1, 1))
LOW = tuple((36, height) for height in range(1, 7))


@cache
def known(mdp: TabularMDP) -> FlipAnswer:
    return worked_out(mdp)


def with_flips(shown: Snapshot, answer: FlipAnswer | None = None, **answers: Any) -> Snapshot:
    mdp = shown.world.mdp
    assert mdp is not None
    return changed(shown, answers=AnswersView(flips=answer or known(mdp), **answers))


@cache
def discount() -> Snapshot:
    """A world of fourteen flips, one of which changes the optimal path."""
    return changed(student(), world=begin(recipe_named("discount")).world)


def panel(shown: Snapshot | None, *, state: int | None = None, ascii: bool = False) -> DiscountPanel:  # noqa: A002
    made = DiscountPanel(look(ascii))
    made.snapshot = shown
    if state is not None and shown is not None:
        made.point_at(shown.world.space.pairs_of(state))
    return made


def drawn(shown: Snapshot | None, width: int = 56, height: int = 20, **how: Any) -> str:
    rows = panel(shown, **how).picture(shown, width, height)
    assert [row.cell_length for row in rows] == [width] * height
    return "\n".join(row.text.rstrip() for row in rows)


def said(shown: Snapshot | None, width: int = 56, **how: Any) -> str:
    return " ".join(drawn(shown, width, **how).split())


@pytest.mark.exhaustive("draws every size", but=["36x13", "26x7", "5x3", "1x1", "36x1", "36x4"])
@pytest.mark.parametrize("size", [*SIZES, *LOW], ids=lambda size: f"{size[0]}x{size[1]}")
def test_it_is_drawn_at_any_size(size: tuple[int, int]) -> None:
    answers = [None, with_flips(lake(slippery=True)), with_flips(student()), with_flips(lake(slippery=False))]
    for shown in (*answers, with_flips(student(), is_hidden=True), with_flips(bandit())):
        drawn(shown, *size)
        assert drawn(shown, *size, ascii=True).isascii()


# Texts


def test_of_the_student_it_tells_the_one_flip_and_what_it_earns() -> None:
    text = said(with_flips(student()), state=0)
    assert f"{UNICODE.flip}{UNICODE.change_mark}.25 earns 0 below, 7.5 above" in text
    assert "state Class: check phone to study" in text


def test_of_the_lake_it_tells_both_flips_to_three_digits() -> None:
    text = drawn(with_flips(lake()), state=0)
    assert ".809  earns .4466 below, .7298 above" in text
    assert ".978  earns .7298 below, .7402 above" in text
    narrow = said(with_flips(lake()), 36, state=0)
    assert ".809 .447 below, .730 above" in narrow


def test_what_turns_in_the_state_shown_is_told_first() -> None:
    first, second = "state 0: →, ↓ to ←", "state 2: → to ←"
    of_0, of_2 = (drawn(with_flips(lake()), state=state) for state in (0, 2))
    assert of_0.index(first) < of_0.index(second)
    assert of_2.index(second) < of_2.index(first)
    here = [line.split()[0] for line in of_2.splitlines() if "earns" in line]
    assert here == [f"{UNICODE.flip}{UNICODE.change_mark}.809", f"{UNICODE.flip}{UNICODE.change_mark}.978"]


@pytest.mark.parametrize("width", [118, 56, 36])
def test_numbers_of_a_list_have_as_many_decimals_as_tell_them_apart(width: int) -> None:
    flips = known_of(discount()).flips
    form = fitting_form(flips, look(), width)
    gammas = [form.gamma(flip, look()) for flip in flips]
    assert len(set(gammas)) == len(flips)
    assert {len(gamma) for gamma in gammas} == {1 + form.gamma_decimals}
    assert form.gamma_decimals >= 4
    for flip in flips:
        below, above = (
            form.returns(flip, look()).removeprefix("earns ").removesuffix(" above").split(" below, ")
        )
        assert (below != above) is (flip.expected_return[0] != flip.expected_return[1])
        assert len(below.partition(".")[2]) == len(above.partition(".")[2])


def test_close_gammas_and_returns_get_more_decimals_where_room_is_short() -> None:
    flip = replace(known_of(student()).flips[0], gamma=0.12341, expected_return=(0.862952, 0.862955))
    near = replace(flip, gamma=0.12344)
    form = fitting_form((flip, near), look(), 30)
    assert [form.gamma(each, look()) for each in (flip, near)] == [".12341", ".12344"]
    assert form.returns(flip, look()) == ".86295 below, .86296 above"
    same = replace(flip, expected_return=(0.5, 0.5))
    assert form.returns(same, look()) == ".50 below, .50 above"


def test_a_return_that_is_not_known_is_not_made_up() -> None:
    answer = known_of(student())
    flip = replace(answer.flips[0], expected_return=(None, 7.5))
    assert "earns unknown below, 7.5 above" in said(with_flips(student(), replace(answer, flips=(flip,))))


def known_of(shown: Snapshot) -> FlipAnswer:
    mdp = shown.world.mdp
    assert mdp is not None
    return known(mdp)


def test_where_nothing_can_be_drawn_it_says_why() -> None:
    assert said(with_flips(student(), is_hidden=True)) == HIDDEN + ANSWER_KEY
    assert said(with_flips(student(), FlipAnswer(FlipState.PENDING))) == PENDING
    assert said(with_flips(student(), HELD_UP)) == HELD_UP.reason
    assert said(with_flips(student(), refused("too large"))) == "too large"
    idle = FlipAnswer(FlipState.KNOWN)
    assert said(with_flips(bandit(), idle)) == "each pull ends its episode: γ changes nothing"
    assert NO_FLIPS in said(with_flips(lake(slippery=False)))
    large = changed(student(), world=begin(recipe_named("taxi")).world)
    assert "at most 100 states" in said(large), "before anybody asks"


def test_while_hidden_no_key_gives_anything_away() -> None:
    made = panel(with_flips(student(), is_hidden=True))
    made.action_choose(1)
    assert made.chosen is None


# The chart


def chart(
    shown: Snapshot, state: int, width: int = 60, height: int = 16, *, is_ranked: bool = False
) -> list[str]:
    answer = known_of(shown)
    lines = action_lines(shown.world, answer.curves, state, look())
    lines = ranked(lines) if is_ranked else lines
    strips = draw_values(lines, answer.curves.gamma, answer.flips, state, 0.9, None, look(), width, height)
    return [strip.text for strip in strips]


def test_the_lines_are_the_values_of_solve() -> None:
    curves = known_of(student()).curves
    lines = {line.name: line.values for line in action_lines(student().world, curves, 0, look())}
    at = int(np.searchsorted(curves.gamma, 0.9))
    # by hand: Q(study) = −2 + .9 (.8 · 10 + .2 V), V = Q(study); Q(check phone) = .9 · .9 V
    best = (-2 + 0.9 * 0.8 * 10) / (1 - 0.9 * 0.2)
    assert lines["study"][at] == pytest.approx(best)
    assert lines["check phone"][at] == pytest.approx(0.81 * best)
    assert (lines["study"][0], lines["check phone"][0]) == (-2.0, 0.0)


def test_a_crossing_stands_on_the_line_of_its_flip_and_lines_have_their_names() -> None:
    rows = chart(student(), 0)
    mark = next(
        (y, row.index(UNICODE.change_mark)) for y, row in enumerate(rows) if UNICODE.change_mark in row
    )
    below = {row[mark[1]] for y, row in enumerate(rows[:-1]) if abs(y - mark[0]) > 2}
    assert below == {UNICODE.flip}
    zero = next(row for row in rows if row.strip().startswith("0┤"))
    assert UNICODE.change_mark in zero
    assert any("study" in row for row in rows)
    assert any("check phone" in row for row in rows)
    assert UNICODE.change_mark not in "".join(chart(student(), 1)), "nothing turns in Phone"


@pytest.mark.parametrize("ascii", [False, True])
def test_each_sign_means_one_thing_in_chart_list_slider_and_legend(ascii: bool) -> None:  # noqa: A002
    shown = with_flips(discount())
    made = panel(shown, state=19, ascii=ascii)
    rows = [row.text for row in made.picture(shown, 56, 99)]
    glyphs, flips = made.look.glyphs, known_of(discount()).flips
    listed = [row[1] for row in rows if "earns" in row]
    assert listed == [glyphs.flip if flip.turns_the_way else glyphs.side_flip for flip in flips]
    meanings = {sign.sign: sign.meaning for sign in made.legend(shown)}
    assert len(meanings) == 4
    assert meanings[glyphs.flip] == "path"
    assert meanings[glyphs.side_flip] == "other"
    assert meanings[glyphs.thumb] == "current γ"
    plot = [row[4:] for row in rows[1 : next(y for y, row in enumerate(rows) if "earns" in row) - 1]]
    assert sum(row.count(glyphs.thumb) for row in plot) == 1, "on the best value at the γ in force"
    assert sum(glyphs.untried in row for row in plot) > len(plot) - 4


def test_a_world_without_other_flips_explains_none() -> None:
    shown = with_flips(student())
    assert UNICODE.side_flip not in {sign.sign for sign in panel(shown).legend(shown)}
    without = with_flips(lake(slippery=False))
    assert [sign.sign for sign in panel(without).legend(without)] == [UNICODE.thumb]
    hidden = with_flips(student(), is_hidden=True)
    assert panel(hidden).legend(hidden) == ()


def test_from_worst_to_best_a_crossing_is_seen_where_values_are_close() -> None:
    curves = known_of(lake()).curves
    assert curves is not None
    lines = {line.name: line.values for line in ranked(action_lines(lake().world, curves, 0, look()))}
    below, above = (int(np.searchsorted(curves.gamma, each)) for each in (0.79, 0.83))
    assert (lines["↓"][below], lines["←"][above]) == (1.0, 1.0)
    assert lines["←"][below] < 1.0 > lines["↓"][above]
    assert np.isnan(lines["↑"][0]), "at γ = 0 all are as good"
    assert UNICODE.change_mark in chart(lake(), 0, is_ranked=True)[0]
    assert any(ord(cell) > braille.BLANK for row in chart(lake(), 0, is_ranked=True) for cell in row)


def test_where_colours_do_not_tell_lines_apart_their_signs_do() -> None:
    answer = known_of(lake())
    plain = look(depth="none")
    lines = action_lines(lake().world, answer.curves, 0, plain)
    strips = draw_values(lines, answer.curves.gamma, (), 0, 0.5, None, plain, 80, 20)
    drawn_in = {cell for strip in strips[:-1] for cell in strip.text}
    signs = {line.sign for line in lines}
    usual = {*" ┤│·●.", *"0123456789"}
    assert all(cell in usual | signs or braille.BLANK < ord(cell) <= braille.BLANK + 255 for cell in drawn_in)


@pytest.mark.parametrize("width", [36, 56, 80])
def test_without_colours_each_line_has_its_sign_along_it_also_where_others_cover_it(width: int) -> None:
    answer, plain = known_of(discount()), look(depth="none")
    lines = action_lines(discount().world, answer.curves, 19, plain)
    strips = draw_values(lines, answer.curves.gamma, (), 19, 0.9, None, plain, width, 10)
    body = "".join(strip.text[4:-3] for strip in strips[:-1])
    assert all(body.count(line.sign) >= 2 for line in lines)


def test_names_of_actions_are_whole_in_a_terminal_of_eighty_columns() -> None:
    assert any(row.endswith("check phone") for row in chart(student(), 0, 36, 13))


# Sizes


def framed(shown: Snapshot, width: int, height: int, *downs: int) -> tuple[DiscountPanel, list[str]]:
    made = panel(shown, state=0)
    made.is_explained = True
    for _ in downs:
        made.action_choose(1)
    return made, [row.text.rstrip() for row in made.picture(shown, width, height)]


@pytest.mark.parametrize("size", [(58, 18), (36, 18), (26, 11)])
def test_the_flip_chosen_comes_before_the_legend_and_that_before_other_flips(size: tuple[int, int]) -> None:
    worlds = with_flips(lake()), with_flips(discount()), with_flips(student())
    for shown, presses in product(worlds, range(4)):
        made, rows = framed(shown, *size, *range(presses))
        signs = tuple(sign._replace(in_full="") for sign in made.legend(shown))
        assert made.free_rows >= len(legend_rows(signs, size[0], len(signs), made.look))
        flip = made.chosen or known_of(shown).flips[0]
        if presses or len(known_of(shown).flips) == 1:
            gamma = fitting_form(known_of(shown).flips, made.look, size[0]).gamma(flip, made.look)
            assert any(gamma in row for row in rows)


def test_a_list_that_is_cut_tells_which_flips_of_how_many() -> None:
    made, rows = framed(with_flips(discount()), 56, 20, *range(20))
    count = sum("earns" in row for row in rows)
    assert f"{15 - count}–14 of 14" in made.heading
    for width in (36, 44):
        made, _ = framed(with_flips(discount()), width, 18, *range(20))
        assert made.heading.endswith("–14 of 14")
    made, _ = framed(with_flips(lake()), 26, 10, 1, 2)
    assert made.heading.endswith("2 of 2")
    assert not re.search(r"\d of \d", framed(with_flips(lake()), 56, 20)[0].heading)


def test_keys_have_words_and_v_is_named_by_what_it_turns_to() -> None:
    made, _ = framed(with_flips(lake()), 90, 20)
    assert "v: worst to best" in made.footing
    made.action_turn_layer()
    made.picture(with_flips(lake()), 90, 20)
    assert "v: Q*" in made.footing
    for width in range(8, 90):
        made, _ = framed(with_flips(lake()), width, 20)
        assert all(": " in hint for hint in made.footing.split(" · ") if hint)


# In the playground


async def test_it_follows_the_cursor_and_its_keys_choose_a_flip_and_go_beyond_it(make_app: MakeApp) -> None:
    async with on_screen(make_app("frozenlake-slippery"), (120, 40)) as pilot:
        board = playground(pilot).board
        panel = board.discount
        await press(pilot, "t", "g")
        assert "Q* of state 0" in panel.head
        assert board.world.shown_cursor == 0, "the map marks the state"
        board.world.focus()
        await press(pilot, "right", "right")
        assert "Q* of state 2" in panel.head
        panel.focus()
        await press(pilot, "down")
        assert "Q* of state 2" in panel.head, "the cursor points without the focus too"
        board.world.focus()
        await press(pilot, "home")
        assert "Q* of state 0" in panel.head
        panel.focus()
        await press(pilot, "up", "down")
        assert round(panel.chosen.gamma, 4) == 0.9783
        assert (await press(pilot, "enter")).agent.hyperparameters.gamma == 0.97
        assert (await press(pilot, "enter")).agent.hyperparameters.gamma == 0.98
        assert (await press(pilot, "up", "up", "enter")).agent.hyperparameters.gamma == 0.8
        assert snapshot(pilot).exact_answer.expected_return == pytest.approx(panel.chosen.expected_return[0])
        await press(pilot, "v")
        assert "worst to best" in screen_text(pilot.app)
        await press(pilot, "t", "g")
        assert "earns" not in screen_text(pilot.app)
        assert not board.world.subject
        board.table.focus()
        await press(pilot, "down", "t", "g")
        assert "Q* of state 1" in panel.head, "the cursor of the table counts as well"


async def test_while_the_answer_is_hidden_nothing_is_shown_and_a_planner_has_flips_too(
    make_app: MakeApp,
) -> None:
    async with on_screen(make_app("student"), (120, 40)) as pilot:
        await press(pilot, "t", "g", "2")
        assert HIDDEN in screen_text(pilot.app)
        assert "earns" not in screen_text(pilot.app)
        assert UNICODE.flip not in screen_text(pilot.app)
        panel = pilot.app.screen.query_one(DiscountPanel)
        assert panel.size.height < 5, "a sentence needs no more"
        await press(pilot, "w", "h")
        assert panel.size.height > 10
        assert "earns 0 below, 7.5 above" in screen_text(pilot.app)
        assert UNICODE.flip in screen_text(pilot.app)
        await press(pilot, "t", "g")
        assert "earns" not in screen_text(pilot.app)
        await switch(pilot, "value-iteration")
        await press(pilot, "t", "g", "s")
        assert "earns 0 below" in screen_text(pilot.app)


def test_the_chart_shows_the_best_action_and_the_second_best() -> None:
    values = np.array([[0.1, 0.5], [0.3, 0.2], [0.2, 0.1]])
    lines = [ActionLine(name, name, each, Style()) for name, each in zip("abc", values, strict=True)]
    best, second = best_two(lines, look())
    assert (best.sign, best.values.tolist(), second.values.tolist()) == ("ba", [0.3, 0.5], [0.2, 0.2])
    assert len(best_two(lines[:1], look())) == 1
