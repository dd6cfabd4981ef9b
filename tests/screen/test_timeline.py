from __future__ import annotations

import pytest
from samples import bandit, lake, look
from snapshots import changed
from textual import events
from textual.app import App, ComposeResult
from textual.pilot import Pilot
from textual.widgets import Button

from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.runs.recipe import EditWorld, JournalEntry, SetParameter, SwitchAlgorithm, TakeAction
from rl_tui.runs.timeline.branches import Branch, Timeline
from rl_tui.screen.panels.timeline import TimelineBar, TimelineState, Track, timeline_form, timeline_strip
from rl_tui.screen.theme.look import Palette
from rl_tui.worlds.editing.edit import read_edits

JOURNAL = (
    JournalEntry(2_500, SetParameter("alpha", 0.5)),
    JournalEntry(5_000, SwitchAlgorithm("sarsa")),
    *(JournalEntry(step, TakeAction(1)) for step in range(7_500, 7_600)),
)


def one(here: int, end: int = 10_000, journal: tuple[JournalEntry, ...] = ()) -> Timeline:
    return Timeline((Branch("branch 1", journal, end=end, here=here),))


def two(here: int, end: int = 10_000, fork: int = 4_000) -> Timeline:
    return Timeline(
        (Branch("branch 1", end=20_000, here=20_000), Branch("branch 2", (), 0, fork, end=end, here=here)),
        branch=1,
    )


def drawn(timeline: Timeline, width: int = 62, *, ascii: bool = False, focused: bool = False) -> str:  # noqa: A002
    state = TimelineState(timeline, timeline.current.here, focused)
    strip = timeline_strip(state, look(ascii), width)
    assert strip.cell_length == width
    return strip.text


def at(here: int, end: int = 10_000, **changes: object) -> Snapshot:
    return lake(timeline=one(here, end), step=here, **changes)


# How it looks


def test_the_present_is_a_full_line_with_the_handle_at_its_end() -> None:
    assert drawn(one(10_000)) == " step 10,000      ━━━━━━━━━━━━━━━━━━━━━━━━━━━━━━━━━━● now     "
    assert drawn(one(10_000), 42) == " step 10,000  ━━━━━━━━━━━━━━━━━━● now     "


def test_the_past_tells_where_one_is_and_how_far_it_goes() -> None:
    assert drawn(one(2_500)) == " step 2,500       ━━━━━━━━●────────────────────────── 10,000  "
    assert drawn(one(2_500), 42) == " step 2,500   ━━━━●────────────── 10,000  "
    assert drawn(one(0), 42) == " step 0       ●────────────────── 10,000  "


def test_of_several_branches_it_names_the_one_in_force_and_where_it_began() -> None:
    assert drawn(two(10_000), 42) == " branch 2 10,000  ━━━━━━┻━━━━━━━● now     "
    assert drawn(two(2_000)) == " branch 2  step 2,000       ━━━━━●────┻────────────── 10,000  "


def test_changes_are_marked_and_steps_by_hand_more_lightly() -> None:
    text = drawn(one(10_000, journal=JOURNAL))
    start = timeline_form(one(10_000), 62).track
    assert [text[start.start + start.cell_of(step)] for step in (2_500, 5_000, 7_500)] == ["◆", "◆", "╍"]
    assert text.count("◆") == 2


def test_a_change_of_the_world_has_its_own_mark_which_outdoes_others() -> None:
    world = JournalEntry(2_500, EditWorld(read_edits("world.cell[0,1]=#")))
    text = drawn(one(10_000, journal=(world, *JOURNAL)))
    start = timeline_form(one(10_000), 62).track
    assert [text[start.start + start.cell_of(step)] for step in (2_500, 5_000, 7_500)] == ["◈", "◆", "╍"]
    assert "W" in drawn(one(10_000, journal=(*JOURNAL, world)), ascii=True)


def test_ascii() -> None:
    text = drawn(two(10_000), 42, ascii=True)
    assert text == " branch 2 10,000  ======Y=======o now     "
    text = drawn(one(6_000, journal=JOURNAL), ascii=True)
    assert text.isascii()
    assert "o" in text.split("step")[1]
    assert "+" in text
    assert ":" in text


@pytest.mark.parametrize("width", [1, 2, 3, 5, 9, 14, 20, 31, 42, 55, 62, 90, 200])
@pytest.mark.parametrize("focused", [False, True])
def test_it_fits_any_width(width: int, focused: bool) -> None:
    for timeline in (one(0, 0), one(0, 1), one(1, 1), one(3, 7, JOURNAL), two(99), two(876_543_210, 10**9)):
        drawn(timeline, width, focused=focused)
        assert drawn(timeline, width, ascii=True, focused=focused).isascii()


@pytest.mark.parametrize("width", [32, 42, 62, 120])
def test_nothing_moves_while_it_runs(width: int) -> None:
    early, late = (timeline_form(one(end, end), width).track for end in (7, 876_543_210))
    assert (early.start, early.cells) == (late.start, late.cells)
    assert timeline_form(one(3, 876_543_210), width).track == late


def test_an_empty_run_says_what_the_row_is() -> None:
    for focused in (False, True):
        assert drawn(one(0, 0), focused=focused).strip() == "timeline: no step yet"


def test_a_bandit_counts_pulls() -> None:
    bar = TimelineBar(look())
    assert bar.picture(bandit(400, timeline=one(400, 1_000)), 42, 1)[0].text.startswith(" pull 400 ")
    assert bar.picture(bandit(0), 42, 1)[0].text.strip() == "timeline: no pull yet"


def styles(timeline: Timeline, character: str, *, focused: bool = False) -> set[object]:
    strip = timeline_strip(TimelineState(timeline, timeline.current.here, focused), look(), 62)
    return {segment.style for segment in strip if character in segment.text}


def test_the_present_is_calm_and_the_past_stands_out() -> None:
    palette: Palette = look().palette
    assert styles(one(10_000), "━") == {palette.slider_rest}
    assert styles(one(10_000), "●") == {palette.slider_thumb}
    assert styles(one(2_500), "━") == {palette.slider_done}
    assert styles(one(2_500), "●") == {palette.press}


def test_the_focus_shows() -> None:
    palette = look().palette
    for timeline in (one(10_000), one(2_500)):
        assert styles(timeline, "●", focused=True) == {palette.focus}
        assert styles(timeline, "step", focused=True) == {palette.focus}


# Steps and cells


@pytest.mark.parametrize(("cells", "end"), [(3, 1), (19, 5), (19, 10_000), (35, 10**9), (35, 34), (2, 7)])
def test_the_ends_are_the_ends_and_the_past_is_not_the_present(cells: int, end: int) -> None:
    track = Track(0, cells, end)
    assert track.cell_of(0) == 0
    assert track.cell_of(end) == cells - 1
    assert track.cell_of(end - 1) < cells - 1
    assert track.step_at(-5) == 0
    assert track.step_at(cells + 5) == end
    assert track.steps_a_cell >= 1
    assert all(track.step_at(cell) <= track.step_at(cell + 1) for cell in range(cells - 1))


def test_a_cell_of_the_middle_is_met_again() -> None:
    track = Track(10, 35, 10_000)
    assert all(track.cell_of(track.step_at(cell)) == cell for cell in range(35))


# Keys and mouse


class Bench(App[None]):
    CSS = "TimelineBar { width: 62; height: 1; }"

    def __init__(self, snapshot: Snapshot) -> None:
        super().__init__()
        self.bar = TimelineBar(look())
        self.bar.show(snapshot)
        self.sought: list[int] = []

    def compose(self) -> ComposeResult:
        yield self.bar
        yield Button("elsewhere")

    def on_mount(self) -> None:
        self.bar.focus()

    def on_timeline_bar_sought(self, event: TimelineBar.Sought) -> None:
        self.sought.append(event.step)

    @property
    def text(self) -> str:
        return self.bar.render_line(0).text

    @property
    def track(self) -> Track:
        return timeline_form(self.bar.snapshot.timeline, self.bar.size.width).track


async def pressed(app: Bench, *keys: str) -> list[int]:
    async with app.run_test(size=(80, 10)) as pilot:
        await pilot.press(*keys)
    return app.sought


async def test_the_arrows_move_by_a_cell() -> None:
    cell = round(10_000 / 34)
    assert timeline_form(one(5_000), 62).track.cells == 35
    keys = ("left", "left", "right")
    assert await pressed(Bench(at(5_000)), *keys) == [5_000 - cell, 5_000 - 2 * cell, 5_000 - cell]


async def test_in_a_short_run_the_arrows_move_by_a_step() -> None:
    assert await pressed(Bench(at(3, 7)), "left", "right", "right") == [2, 3, 4]


async def test_shift_moves_by_a_step_and_pages_by_a_tenth() -> None:
    keys = ("shift+left", "less_than_sign", "greater_than_sign", "pagedown", "pageup", "pageup")
    assert await pressed(Bench(at(5_000)), *keys) == [4_999, 4_998, 4_999, 3_999, 4_999, 5_999]


async def test_home_and_end_go_to_the_ends_and_no_further() -> None:
    assert await pressed(Bench(at(5_000)), "home", "left", "pagedown", "end", "right", "end") == [0, 10_000]


async def test_an_empty_run_has_nowhere_to_go() -> None:
    assert await pressed(Bench(at(0, 0)), "left", "right", "home", "end", "pageup") == []


async def test_the_handle_is_at_once_where_it_is_sent_and_stays_until_it_is_let_go() -> None:
    app = Bench(at(10_000))
    async with app.run_test(size=(80, 10)) as pilot:
        await pilot.press("home")
        assert app.text.startswith(" step 0           ●─")
        app.bar.show(at(10_000))
        assert app.bar.at == 0
        app.bar.sought = None
        app.bar.show(at(7_000))
        assert app.bar.at == 7_000


async def test_a_click_goes_there() -> None:
    app = Bench(at(10_000))
    async with app.run_test(size=(80, 10)) as pilot:
        track = app.track
        await pilot.click(app.bar, offset=(track.start, 0))
        await pilot.click(app.bar, offset=(track.start + 17, 0))
        await pilot.click(app.bar, offset=(2, 0))
        await pilot.click(app.bar, offset=(track.start + track.cells + 3, 0))
    assert app.sought == [0, track.step_at(17), 10_000]


async def test_a_drag_tells_each_moment_once_and_goes_past_the_ends() -> None:
    app = Bench(at(10_000))
    async with app.run_test(size=(80, 10)) as pilot:
        track = app.track
        await pilot.mouse_down(app.bar, offset=(track.start + 20, 0))
        await pilot.hover(app.bar, offset=(track.start + 20, 0))
        await pilot.hover(app.bar, offset=(track.start + 10, 0))
        await pilot.hover(offset=(0, 5))
        await pilot.mouse_up(offset=(0, 5))
        await pilot.hover(app.bar, offset=(track.start + 30, 0))
    assert app.sought == [track.step_at(20), track.step_at(10), 0]


async def test_the_other_buttons_do_nothing() -> None:
    app = Bench(at(10_000))
    async with app.run_test(size=(80, 10)):
        down = events.MouseDown(app.bar, 20, 0, 0, 0, 3, False, False, False, 20, 0)
        app.bar.on_mouse_down(down)
    assert app.sought == []


async def test_at_full_speed_only_the_row_is_drawn_again(monkeypatch: pytest.MonkeyPatch) -> None:
    app = Bench(at(10_000))
    async with app.run_test(size=(80, 10)) as pilot:
        await unfocus(pilot)
        drawn_again: list[object] = []
        monkeypatch.setattr(app.bar, "refresh", lambda *regions, **_: drawn_again.append(regions))
        app.bar.show(changed(at(10_000), episodes=3))
        assert not drawn_again
        app.bar.show(at(10_500, 10_500, phase=Phase.RUNNING))
        assert len(drawn_again) == 1


async def unfocus(pilot: Pilot[None]) -> None:
    pilot.app.set_focus(None)
    await pilot.pause()
