"""Panels hide what would reveal the exact values."""

from __future__ import annotations

import pytest
from conftest import MakeApp
from drawn_curves import drawn as drawn_curve
from drawn_tables import Drawn
from samples import lake, look, student
from seams import notes, on_screen, order, playground, press, screen_text, snapshot, train
from snapshots import changed

from rl_tui.live.commands import HideAnswer
from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.screen.dialogs.until_options import until_options
from rl_tui.screen.frame.number_here import number_of_pair, number_of_state
from rl_tui.screen.kit.blocks import lines_of
from rl_tui.screen.kit.layers import Layer
from rl_tui.screen.kit.snapshot_facts import ANSWER_KEY, hides_means, is_secret
from rl_tui.screen.panels.curve.data import curve_data
from rl_tui.screen.panels.curve.text import HIDDEN_OPTIMUM, OPTIMAL
from rl_tui.screen.panels.microscope.microscope import history_strips
from rl_tui.screen.panels.model import pair_blocks
from rl_tui.screen.theme.glyphs import UNICODE
from rl_tui.worlds.files.catalogue import scenarios

SECRET = changed(lake(), is_hidden=True)


def test_the_model_of_a_world_that_is_no_bandit_is_no_secret() -> None:
    assert is_secret(SECRET)
    assert not hides_means(SECRET)
    assert not is_secret(lake())


@pytest.mark.parametrize("state", [changed(lake(), is_hidden=True), changed(student(), is_hidden=True)])
def test_the_table_has_dots_for_exact_numbers_and_names_the_key(state: Snapshot) -> None:
    for layer in Layer:
        table = Drawn(state, 44, 17, layer)
        assert Layer.ERROR not in table.table.layer_choices
        assert ("···" in table.text) is (layer is Layer.OPTIMAL)
    assert Drawn(state, 44, 17).table.footing == "v  Q  Q*  visits · w h shows Q*"


def test_a_world_without_an_exact_answer_hides_nothing_in_its_table() -> None:
    refused = changed(lake(0), refused="state 3 cannot reach an end", is_hidden=True)
    table = Drawn(refused, 44, 17, Layer.OPTIMAL)
    assert "state 3 cannot" in table.text
    assert "h:" not in table.table.footing
    assert not curve_data(refused).hides_optimum


def test_the_curve_keeps_the_greedy_policy_and_hides_the_best() -> None:
    shown, hidden = curve_data(lake()), curve_data(SECRET)
    assert shown.optimum is not None
    assert hidden.optimum is None
    assert hidden.greedy_now == shown.greedy_now
    text, curve = drawn_curve(SECRET, (80, 13))
    assert HIDDEN_OPTIMUM[0] in curve.heading
    assert OPTIMAL not in text
    assert OPTIMAL in drawn_curve(lake())[0]


def test_the_bellman_equation_has_no_numbers() -> None:
    lines = "\n".join(
        "".join(piece.text for piece in line) for line in lines_of(pair_blocks(SECRET, 0, look()), 90, look())
    )
    assert f"··· {ANSWER_KEY}" in lines
    assert "p · [r + γ · max Q*" in lines.replace("\xa0", " ")


def test_the_history_of_a_cell_has_no_exact_value() -> None:
    for shown, told in ((lake(), True), (SECRET, False)):
        text = "".join(strip.text for strip in history_strips(shown, 0, look(), 60, 9))
        assert ("w h shows the exact" in text) is not told
        assert (", exact " in text) is told


def test_a_number_is_told_without_the_exact_one() -> None:
    for number, symbol in (
        (number_of_pair(SECRET, 0, Layer.Q, look()), "Q*"),
        (number_of_state(SECRET, 0, look()), "V*"),
    ):
        assert number.meaning.endswith(f"The exact {symbol} is hidden: w h shows it.")


def test_until_the_policy_is_optimal_shows_nothing_of_it() -> None:
    (option,) = (each for each in until_options(SECRET, 0, UNICODE) if each.id == "optimal")
    assert not option.refused
    assert option.hint == "Compares with the exact values without showing them."


async def test_what_a_person_hides_or_has_seen_is_hidden_in_the_neighbouring_scenarios(
    make_app: MakeApp,
) -> None:
    async with on_screen(make_app("cliff")) as pilot:
        assert is_secret(await press(pilot, "w", "h"))
        ids = [scenario.id for scenario in scenarios()]
        there = ids[ids.index("cliff") + 2]
        shown = await press(pilot, *"w]w]")
        assert (shown.recipe.scenario.id, is_secret(shown)) == (there, True)
        shown = await press(pilot, *"whw[")
        assert not is_secret(shown), "as the scenario says"
    async with on_screen(make_app("student")) as pilot:
        await press(pilot, "w", "m")
        assert ANSWER_KEY in screen_text(pilot.app)
        assert not is_secret(await press(pilot, "w", "h"))
        assert ANSWER_KEY not in screen_text(pilot.app), "the numbers of the model are shown while it is open"
        assert "6.3415" in screen_text(pilot.app)
        await press(pilot, "escape", "w", "[")
        assert is_secret(await press(pilot, "w", "]")), "what was seen is hidden elsewhere"


async def test_nothing_is_hidden_where_there_is_no_exact_answer(make_app: MakeApp) -> None:
    async with on_screen(make_app("cartpole")) as pilot:
        await order(pilot, HideAnswer(is_hidden=True))
        assert not is_secret(snapshot(pilot))


async def test_h_hides_the_layer_that_is_shown_and_the_line_and_brings_both_back(make_app: MakeApp) -> None:
    async with on_screen(make_app("frozenlake"), (120, 40), notifications=True) as pilot:
        await press(pilot, "e", "v")
        table = playground(pilot).board.table
        assert table.shown_layer is Layer.OPTIMAL
        before = screen_text(pilot.app)
        assert OPTIMAL in before
        hidden = await press(pilot, "w", "h")
        assert is_secret(hidden)
        world = playground(pilot).board.world
        assert world is not None
        for panel in (table, world):
            text = "".join(panel.render_line(y).text for y in range(panel.size.height))
            assert "···" in text
            assert "1.00" not in text
        assert f"{OPTIMAL}  " not in screen_text(pilot.app)
        assert is_secret(await press(pilot, "r", "r", "e"))
        await press(pilot, "w", "h")
        assert table.shown_layer is Layer.OPTIMAL
        assert f"{OPTIMAL}  " in screen_text(pilot.app)
        assert not notes(pilot.app)


async def test_a_spent_budget_has_nothing_to_hide(make_app: MakeApp) -> None:
    async with on_screen(make_app("bandit"), notifications=True) as pilot:
        spent = await train(pilot, 5_000)
        assert spent.playback.phase is Phase.SPENT
        assert not is_secret(await press(pilot, "w", "h"))
        assert f"Not here: {playground(pilot).view.why_not('hide_answer')}." in screen_text(pilot.app)
