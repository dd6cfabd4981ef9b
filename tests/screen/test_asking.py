"""? explains the word under the mouse."""

from __future__ import annotations

import pytest
from conftest import MakeApp
from samples import answered, bandit, lake, look
from seams import on_screen, order, playground, press, screen_text, slider, tap, train
from snapshots import changed
from textual.containers import VerticalScroll
from textual.geometry import Region
from textual.pilot import Pilot
from textual.widgets import Input, OptionList, Static

from rl_tui.common.errors import UserError
from rl_tui.live.commands import AddLane
from rl_tui.runs.recipe import SwitchAlgorithm
from rl_tui.screen.app.screenshot import settle
from rl_tui.screen.frame.glossary import NUMBER, GlossaryScreen
from rl_tui.screen.frame.help import HelpScreen
from rl_tui.screen.frame.key_sheet import KeyPage, KeySheet
from rl_tui.screen.frame.number_here import number_of_pair, number_of_state
from rl_tui.screen.glossary.glossary import glossary
from rl_tui.screen.kit.layers import Layer
from rl_tui.screen.kit.row import LAST_STEP
from rl_tui.screen.panels.catalogue import PANELS
from rl_tui.screen.panels.model import SECRET
from rl_tui.screen.panels.world.view import WorldView
from rl_tui.screen.playground.playground import Playground

HEIGHTS = [(18, 40), pytest.param((80, 24), marks=pytest.mark.exhaustive("other heights"))]
TERMS = {row.id: list(row.terms) for row in PANELS}


def listed(pilot: Pilot[UserError]) -> list[str]:
    return [str(option.id) for option in pilot.app.screen.query_one(OptionList).options]


def told(pilot: Pilot[UserError]) -> str:
    return str(pilot.app.screen.query_one("#paragraph Static", Static).render())


async def point_at(pilot: Pilot[UserError], panel: str, text: str) -> None:
    widget = playground(pilot).board.panel(panel)
    for y in range(widget.size.height):
        x = widget.render_line(y).text.find(text)
        if x >= 0:
            edge = widget.content_region.offset - widget.region.offset
            await pilot.hover(widget, offset=(edge.x + x, edge.y + y))
            return
    raise AssertionError(f"{text} is not there")


async def test_with_no_word_pointed_at_it_shows_the_keys(make_app: MakeApp) -> None:
    async with on_screen(make_app("student")) as pilot:
        alpha, table = slider(pilot.app, "alpha"), playground(pilot).board.panel("table")
        thumb = alpha.render_line(0).text.index("●"), 0
        for panel, place in ((alpha, thumb), (table, (20, 12))):  # not a sign of the map, and not a word
            assert isinstance(pilot.app.screen, Playground)
            await pilot.hover(panel, offset=place)
            await press(pilot, "question_mark")
            assert isinstance(pilot.app.screen, KeySheet), panel
            await press(pilot, "escape")


@pytest.mark.exhaustive("asks at every size", but=["80"])
@pytest.mark.parametrize("size", [(60, 18), (80, 24), (120, 40)], ids=["60", "80", "120"])
async def test_what_is_in_focus_lists_its_words_and_typing_searches_all(
    size: tuple[int, int], make_app: MakeApp
) -> None:
    async with on_screen(make_app("student"), size) as pilot:
        await press(pilot, "tab", "question_mark", "question_mark")
        assert listed(pilot) == [NUMBER, *TERMS["world"]]
        await press(pilot, "down", "down")
        assert glossary()[TERMS["world"][1]].text in told(pilot)
        await tap(pilot, *"regret")
        assert listed(pilot)[0] == "regret"
        assert glossary()["regret"].text in told(pilot)
        await tap(pilot, *["backspace"] * 6)
        assert listed(pilot) == [NUMBER, *TERMS["world"]]
        await tap(pilot, *"qqq")
        assert listed(pilot) == []
        assert told(pilot) == "nothing found"
        await press(pilot, "escape")
        assert isinstance(pilot.app.screen, Playground)
        await press(pilot, "2", "question_mark", "question_mark")
        assert listed(pilot)[0] == "gamma", "the slider comes first"
        assert set(TERMS["controls"]) <= set(listed(pilot))
        assert glossary()["gamma"].text in told(pilot)
        assert glossary()["gamma"].book in told(pilot)
        await press(pilot, "question_mark")
        assert isinstance(pilot.app.screen, HelpScreen), "another question mark goes on to it"
        await press(pilot, "escape")
        assert isinstance(pilot.app.screen, Playground)


async def test_the_word_or_number_under_the_mouse_comes_before_the_focus(make_app: MakeApp) -> None:
    async with on_screen(make_app("frozenlake"), (120, 40)) as pilot:
        await press(pilot, "s")
        await point_at(pilot, LAST_STEP, "δ")
        await press(pilot, "question_mark")
        assert listed(pilot) == ["td-error", *(each for each in TERMS[LAST_STEP] if each != "td-error")]
        await press(pilot, "escape")
        await point_at(pilot, LAST_STEP, "reward")
        await press(pilot, "2", "question_mark", "question_mark")
        assert listed(pilot)[0] == "reward"
        assert "gamma" in listed(pilot), "what is in focus is asked about too"
        await press(pilot, "escape", "escape")
        await train(pilot, 400)
        await press(pilot, "tab", "tab", "home")
        world, table = (playground(pilot).board.panel(each) for each in ("world", "table"))
        assert isinstance(world, WorldView)
        edge = world.content_region.offset - world.region.offset
        places = [(x, y) for y in range(world.size.height) for x in range(world.size.width)]
        x, y = next(each for each in places if world.place_at(*each) == 6)
        await pilot.hover(world, offset=(edge.x + x, edge.y + y))
        await press(pilot, "question_mark")
        assert listed(pilot)[0] == NUMBER
        assert "in state 6:" in told(pilot)
        await press(pilot, "escape", "right", "question_mark", "question_mark")
        assert "in state 0" in told(pilot), "the cursor was moved since"
        await press(pilot, "escape")
        await pilot.hover(table, offset=(14, 5))
        await press(pilot, "question_mark")
        assert "in state 3" in told(pilot)


@pytest.mark.parametrize("heights", HEIGHTS)
async def test_the_pages_of_the_start_screen_begin_at_their_beginning_and_words_list_the_whole_glossary(
    make_app: MakeApp, heights: tuple[int, int]
) -> None:
    async with on_screen(make_app(None), (100, 40)) as pilot:
        for height in heights:
            await pilot.resize_terminal(100, height)
            await tap(pilot, "question_mark", "3")
            assert isinstance(pilot.app.screen, HelpScreen)
            assert pilot.app.screen.query_one(VerticalScroll).scroll_y == 0, height
            assert "◔ opened, ◑ run, ● optimal policy found" in screen_text(pilot.app)
            await tap(pilot, "escape")
        await tap(pilot, "question_mark", "2")
        assert isinstance(pilot.app.screen, GlossaryScreen)
        assert listed(pilot) == list(glossary())
        await tap(pilot, "slash", *"alpha")
        assert pilot.app.screen.query_one(Input).value.endswith("alpha")
        assert listed(pilot)[0] == "alpha"


@pytest.mark.parametrize("heights", HEIGHTS)
@pytest.mark.parametrize(
    "ascii_only", [False, pytest.param(True, marks=pytest.mark.exhaustive("other characters"))]
)
async def test_the_pages_begin_at_their_beginning_and_titles_are_apart_from_their_text(
    make_app: MakeApp, ascii_only: bool, heights: tuple[int, int]
) -> None:
    async with on_screen(make_app("student", ascii=ascii_only), (100, 40)) as pilot:
        for height in heights:
            await pilot.resize_terminal(100, height)
            await press(pilot, "question_mark", "3")
            assert pilot.app.screen.query_one(VerticalScroll).scroll_y == 0, height
            pages = pilot.app.screen.query(KeyPage)
            lines = [page.render_line(y).text for page in pages for y in range(page.size.height)]
            titles = {row.title for row in PANELS if not row.of_lesson}
            assert titles <= {line[:14].strip() for line in lines}
            assert [line for line in lines if line[:2] == "  " and line[13:14].strip()] == []
            await press(pilot, "escape")
        screen, notes = playground(pilot), "\n\n".join(["A paragraph of notes."] * 40)
        page = HelpScreen(screen.look, (), notes)  # only the notes make it scroll
        await pilot.app.push_screen(page)
        await settle(pilot)
        while not page.query("Markdown"):
            await pilot.pause()
        await settle(pilot)
        scroll = page.query_one(VerticalScroll)
        assert scroll.max_scroll_y > 0
        assert scroll.scroll_y == 0


async def test_the_number_under_the_cursor_is_explained_first(make_app: MakeApp) -> None:
    async with on_screen(make_app("student")) as pilot:
        await train(pilot, 400)
        now = await press(pilot, "w", "h", "tab", "tab", "home", "question_mark", "question_mark")
        assert listed(pilot)[0] == NUMBER
        visits = f"{int(now.agent.visits[0]):,} visit"
        for part in ("study in state Class", visits, "exact Q* here is"):
            assert part in told(pilot)
        await press(pilot, "escape", "v", "question_mark", "question_mark")
        assert "Exact" in told(pilot)


@pytest.mark.parametrize("layer", list(Layer))
def test_every_layer_of_the_table_says_what_its_number_is(layer: Layer) -> None:
    told = number_of_pair(lake(), 24, layer, look())
    assert "= " in told.name
    assert told.meaning.endswith(".")


@pytest.mark.parametrize(
    ("layer", "name", "term"),
    [
        (Layer.OPTIMAL, "V*(0) = ", "q-star"),
        (Layer.ERROR, "V(0) − V* = ", "error"),
        (Layer.VISITS, "N(0) = ", "visits"),
    ],
)
def test_every_layer_of_a_world_says_what_its_number_is(layer: Layer, name: str, term: str) -> None:
    told = number_of_state(lake(), 0, look(), layer)
    assert told is not None
    assert told.name.startswith(name)
    assert told.term == term
    assert told.meaning.endswith(".")
    hidden = number_of_state(changed(lake(), is_hidden=True), 0, look(), Layer.OPTIMAL)
    assert hidden is not None
    assert hidden.name.startswith("V(0) = ")


def test_what_is_secret_is_not_told() -> None:
    arm = number_of_pair(bandit(400), 5, Layer.Q, look())
    assert SECRET in arm.meaning
    assert "exact" not in arm.meaning
    known = number_of_pair(answered(bandit(400)), 5, Layer.Q, look())
    assert "exact" in known.meaning


async def test_a_word_on_a_border_is_a_word_and_figures_say_the_limits_of_this_world(
    make_app: MakeApp,
) -> None:
    async with on_screen(make_app("frozenlake")) as pilot:
        world = playground(pilot).board.panel("world")
        below = world.region.height - 1
        line = world.render_lines(Region(0, below, world.region.width, 1))[0].text
        await pilot.hover(world, offset=(line.index("hole"), below))
        await press(pilot, "question_mark")
        assert listed(pilot)[0] == "terminal"
        await press(pilot, "escape")
        await tap(pilot, "question_mark", *"return")
        assert listed(pilot)[0] == "return"
        assert "time limit of 100 steps" in " ".join(told(pilot).split())
        assert "undiscounted" in told(pilot)


async def test_of_two_lanes_a_number_says_whose_it_is(make_app: MakeApp) -> None:
    async with on_screen(make_app("frozenlake-slippery"), (120, 40)) as pilot:
        await train(pilot, 500)
        await order(pilot, AddLane((SwitchAlgorithm("sarsa"),)))
        await press(pilot, "tab", "question_mark", "question_mark")
        assert "run 1" in str(pilot.app.screen.query_one(OptionList).options[0].prompt)
        assert "Q-learning" in told(pilot)
        await press(pilot, "escape", "tab", "question_mark", "question_mark")
        assert "run 2" in str(pilot.app.screen.query_one(OptionList).options[0].prompt)
        assert "SARSA" in told(pilot)
