from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from lane_samples import side_by_side
from samples import bandit, lake, look, planning
from snapshots import changed
from textual import events
from textual.app import App, ComposeResult
from textual.pilot import Pilot
from textual.widgets import Button

from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.runs.recipe import EditWorld, JournalEntry, SetParameter, SwitchAlgorithm, TakeAction
from rl_tui.runs.results import Curve, Marks
from rl_tui.runs.run import WorldChanged
from rl_tui.runs.timeline.branches import Branch, Furthest, Timeline
from rl_tui.screen.panels.curve.data import curve_data, episode_axis
from rl_tui.screen.panels.curve.text import plot_columns
from rl_tui.screen.panels.timeline import TimelineBar, TimelineState, Track, timeline_strip, track_of
from rl_tui.screen.theme.look import Palette
from rl_tui.worlds.editing.edit import read_edits

JOURNAL = (
    JournalEntry(2_500, SetParameter("alpha", 0.5)),
    JournalEntry(5_000, SwitchAlgorithm("sarsa")),
    *(JournalEntry(step, TakeAction(1)) for step in range(7_500, 7_600)),
)
NO_MARKS = Marks(np.array([], dtype=np.int64), np.array([], dtype=np.int64), np.array([]))


def one(here: int, end: int = 10_000, journal: tuple[JournalEntry, ...] = ()) -> Timeline:
    return Timeline((Branch("branch 1", journal, end=end, here=here),))


def two(here: int, end: int = 10_000, fork: int = 4_000) -> Timeline:
    return Timeline(
        (Branch("branch 1", end=20_000, here=20_000), Branch("branch 2", (), 0, fork, end=end, here=here)),
        branch=1,
    )


def episodes(lengths: list[int], returns: list[float] | None = None) -> Curve:
    values = np.zeros(len(lengths)) if returns is None else np.array(returns)
    return Curve(np.arange(1, len(lengths) + 1), values, values, values, np.array(lengths, dtype=float))


def shown(timeline: Timeline, length: int = 50, **changes: object) -> Snapshot:
    here, end = timeline.current.here, timeline.current.end
    count = here // length
    usual = {
        "episodes": count,
        "episode_step": here % length,
        "curve": episodes([length] * count),
        "marks": NO_MARKS,
        "timeline": timeline,
    }
    found = lake(step=here or 1, **(usual | changes))
    found = replace(found, counters=replace(found.counters, step=here, last_step=None))
    if here == end or timeline.furthest is not None:
        return found
    whole = shown(replace(timeline, branches=(Branch("branch 1", end=end, here=end),), branch=0), length)
    return replace(found, timeline=replace(timeline, furthest=Furthest(whole.counters, whole.results)))


def drawn(snapshot: Snapshot, width: int = 62, *, ascii: bool = False, focused: bool = False) -> str:  # noqa: A002
    state = TimelineState(snapshot, snapshot.timeline.current.here, focused)
    strip = timeline_strip(state, look(ascii), width)
    assert strip.cell_length == width
    return strip.text


def at(here: int, end: int = 10_000) -> Snapshot:
    return shown(one(here, end))


def track(snapshot: Snapshot, width: int = 62) -> Track:
    return track_of(snapshot, look(), width)


def mark_at(snapshot: Snapshot, step: int, width: int = 62) -> str:
    found = track(snapshot, width)
    return drawn(snapshot, width)[found.start + found.cell_of(step)]


# Its look


def test_the_present_is_a_full_line_with_the_handle_at_its_end() -> None:
    text = drawn(at(10_000))
    assert text.startswith("ep 0 ━━━━")
    assert text.rstrip().endswith("━●  ep 201")
    assert "─" not in text


def test_the_past_tells_where_one_is_and_how_far_it_goes() -> None:
    assert drawn(at(2_500)).startswith("ep 0 ━━━━━━━━━━●──────")
    assert drawn(at(2_500)).rstrip().endswith("─  ep 51/200")
    assert drawn(at(0)).startswith("ep 0 ●───")


def test_of_several_branches_it_names_the_present_one_and_where_it_began() -> None:
    snapshot = shown(two(10_000))
    assert drawn(snapshot).startswith("  b2 ━━━")
    assert mark_at(snapshot, 4_000) == "┆"


def test_changes_are_marked_and_steps_by_hand_more_lightly() -> None:
    snapshot = shown(one(10_000, journal=JOURNAL))
    assert [mark_at(snapshot, step) for step in (2_500, 5_000, 7_500)] == ["▾", "▾", "╍"]
    assert drawn(snapshot).count("▾") == 2


def test_an_edit_comes_before_a_branch_a_setting_the_first_reward_and_a_policy() -> None:
    curve = episodes([50] * 200, [0.0] * 80 + [1.0] * 120)
    policies = Marks(np.array([0, 4_000]), np.array([0, 80]), np.array([0.0, 0.5]))
    edit = JournalEntry(4_000, EditWorld(read_edits("world.cell[0,1]=#")))
    setting = JournalEntry(4_000, SetParameter("alpha", 0.5))
    hand = JournalEntry(4_000, TakeAction(1))
    for branch, journal, mark in (
        (two(10_000), (hand, edit, setting), "◆"),
        (two(10_000), (setting,), "┆"),
        (one(10_000), (hand, setting), "▾"),
        (one(10_000), (hand,), "★"),
    ):
        current = replace(branch.current, journal=journal)
        timeline = replace(branch, branches=(*branch.branches[:-1], current))
        assert mark_at(shown(timeline, curve=curve, marks=policies), 4_000) == mark
    assert mark_at(shown(one(10_000), marks=policies), 4_000) == "┃"


def test_the_first_reward_is_marked_where_it_came_unless_every_episode_has_one_or_some_lose() -> None:
    for returns, found in (
        ([0.0] * 40 + [1.0] * 160, 1),
        ([1.0] * 200, 0),
        ([0.0] * 200, 0),
        ([-1.0] * 40 + [1.0] * 160, 0),
    ):
        snapshot = shown(one(10_000), curve=episodes([50] * 200, returns))
        assert drawn(snapshot).count("★") == found
        if found:
            assert mark_at(snapshot, 40 * 50 + 25) == "★"


def test_the_last_eight_changes_of_the_greedy_policy_are_marked_apart() -> None:
    many = Marks(np.arange(200) * 50, np.arange(200), np.arange(200) / 200)
    snapshot = shown(one(10_000), marks=many)
    found = track(snapshot, 122)
    cells = [cell for cell in range(found.cells) if drawn(snapshot, 122)[found.start + cell] == "┃"]
    assert len(cells) in (7, 8)  # the handle may hide the last one
    assert min(np.diff(cells)) >= 0.04 * found.columns
    assert cells[0] > found.cells / 2
    same = replace(many, expected_return=np.full(200, 0.5))
    assert "┃" not in drawn(shown(one(10_000), marks=same), 122)


def test_a_hidden_greedy_policy_has_no_marks() -> None:
    secret = bandit(400, timeline=one(400, 400), marks=Marks(*(np.arange(9) * 40,) * 2, np.arange(9) / 9))
    assert "┃" not in drawn(secret)
    assert "┃" in drawn(changed(secret, is_hidden=False))


def test_going_back_keeps_every_event_of_the_branch() -> None:
    curve = episodes([50] * 200, [0.0] * 150 + [1.0] * 50)
    whole = shown(one(10_000), curve=curve)
    back = shown(replace(one(2_000), furthest=Furthest(whole.counters, whole.results)))
    assert "★" in drawn(whole)
    assert drawn(back).index("★") == drawn(whole).index("★")


def test_ascii() -> None:
    text = drawn(shown(one(6_000, journal=JOURNAL)), ascii=True)
    assert text.isascii()
    assert "o" in text
    assert "v" in text
    assert ":" in text
    assert "Y" in drawn(shown(two(10_000)), ascii=True)


@pytest.mark.parametrize("focused", [False, True])
def test_it_fits_any_width(focused: bool) -> None:
    for timeline in (one(0, 0), one(0, 1), one(1, 1), one(3, 7, JOURNAL), two(99), two(9_500)):
        for width in (1, 2, 3, 5, 9, 14, 20, 31, 42, 55, 62, 90, 200):
            drawn(shown(timeline), width, focused=focused)
            assert drawn(shown(timeline), width, ascii=True, focused=focused).isascii()


@pytest.mark.parametrize("width", [32, 42, 62, 120])
def test_it_has_the_columns_of_the_curve(width: int) -> None:
    for snapshot in (at(10_000), at(2_500), side_by_side(3), bandit(400, timeline=one(400, 400))):
        columns, found = plot_columns(snapshot, look(), width), track(snapshot, width)
        assert (found.start, found.columns) == columns[:2]
        assert found.axis.right == curve_data(snapshot).axis.right


def test_an_empty_run_says_what_the_row_is() -> None:
    for focused in (False, True):
        assert drawn(at(0, 0), focused=focused).strip() == "timeline: no step yet"
    assert drawn(bandit(0)).strip() == "timeline: no pull yet"


def test_a_bandit_counts_pulls_and_a_planner_sweeps() -> None:
    assert "pull 400" in drawn(bandit(400, timeline=one(400, 400)))
    assert "sweep" in drawn(planning(timeline=one(132, 132)))


def styles(snapshot: Snapshot, character: str, *, focused: bool = False) -> set[object]:
    state = TimelineState(snapshot, snapshot.timeline.current.here, focused)
    return {each.style for each in timeline_strip(state, look(), 62) if character in each.text}


def test_the_present_is_calm_and_the_past_stands_out() -> None:
    palette: Palette = look().palette
    assert styles(at(10_000), "━") == {palette.slider_rest}
    assert styles(at(10_000), "●") == {palette.strong}
    assert styles(at(2_500), "━") == {palette.press}
    assert styles(at(2_500), "●") == {palette.press}


def test_the_focus_shows() -> None:
    palette = look().palette
    for snapshot, label in ((at(10_000), "ep 201"), (at(2_500), "ep 51")):
        assert styles(snapshot, "●", focused=True) == {palette.focus}
        assert styles(snapshot, label, focused=True) == {palette.focus}


# Episodes, steps and cells


def uneven(here: int | None = None) -> Snapshot:
    lengths = np.geomspace(1_000, 16, 100).round().astype(int)
    end = int(lengths.sum()) + 9
    found = shown(one(end, end), curve=episodes(lengths.tolist()), episodes=100, episode_step=9)
    if here is None:
        return found
    return replace(
        found,
        timeline=replace(one(here, end), furthest=Furthest(found.counters, found.results)),
        counters=replace(found.counters, step=here),
    )


def test_the_place_of_a_step_goes_by_its_episode_and_inside_one_by_its_steps() -> None:
    axis = episode_axis(uneven())
    ends = np.concatenate(([0], np.cumsum(np.geomspace(1_000, 16, 100).round())))
    assert [axis.episode_of(end) for end in ends] == pytest.approx(range(101))
    assert axis.episode_of(500.0) == pytest.approx(0.5)
    assert 100.0 < axis.episode_of(ends[-1] + 9) < 101.0 <= axis.right < 101.0 * 1.05 + 1e-6


@pytest.mark.parametrize("make", [uneven, lambda: at(10_000), lambda: at(2_500), lambda: at(7, 7)])
def test_steps_and_places_are_one_to_one(make: Callable[[], Snapshot]) -> None:
    snapshot = make()
    axis, end = episode_axis(snapshot), snapshot.timeline.current.end
    places = [axis.episode_of(step) for step in range(end + 1)]
    assert np.all(np.diff(places) > 0.0)
    assert [round(axis.step_of(place)) for place in places] == list(range(end + 1))


def test_the_axis_does_not_move_while_one_goes_back() -> None:
    now = episode_axis(uneven())
    for here in (0, 1, 700, 5_000):
        then = episode_axis(uneven(here))
        assert (then.step.tolist(), then.episode.tolist(), then.right) == (
            now.step.tolist(),
            now.episode.tolist(),
            now.right,
        )


def test_where_the_rest_of_a_branch_is_not_known_it_goes_on_evenly() -> None:
    loaded = replace(at(2_500), timeline=one(2_500))
    axis = episode_axis(loaded)
    assert axis.episode_of(10_000) == pytest.approx(200.0)
    begun = replace(at(0), timeline=one(0))
    found = track(begun)
    assert found.cell_of(5_000) == pytest.approx(found.cells / 2, abs=1)


def test_steps_of_an_episode_that_an_edit_gave_up_keep_their_place() -> None:
    edited = replace(
        shown(one(6_000, 6_000), curve=episodes([50] * 100), episodes=100, episode_step=0),
        world_changes=(WorldChanged(2_000, 20, given_up=True),),
    )
    axis = episode_axis(edited)
    assert axis.episode_of(2_000) == pytest.approx(20.0, abs=1.0)
    assert axis.episode_of(6_000) == pytest.approx(100.0)
    assert axis.episode_of(4_000) == pytest.approx(60.0)


def test_the_right_end_moves_in_small_steps_and_no_further_than_there_will_be_episodes() -> None:
    ends = [episode_axis(shown(one(50 * n, 50 * n))).right for n in range(2, 400)]
    assert ends == sorted(ends)
    assert len(set(ends)) < 120
    assert all(n <= end <= 1.05 * n + 1e-6 for n, end in enumerate(ends, 2))
    assert episode_axis(bandit(990, timeline=one(990, 990))).right <= 1_000


@pytest.mark.parametrize(
    ("here", "end"), [(1, 1), (5, 5), (10_000, 10_000), (2_500, 10_000), (34, 34), (7, 7)]
)
def test_the_ends_are_the_ends_and_the_past_is_not_the_present(here: int, end: int) -> None:
    for found in (track(at(here, end), width) for width in (12, 42, 62, 200)):
        assert found.cell_of(0) == 0
        assert found.cell_of(end) == found.cells - 1
        assert found.cells == 1 or found.cell_of(end - 1) < found.cells - 1
        assert found.cells == 1 or found.step_at(-5) == 0
        assert found.step_at(found.cells + 5) == end
        assert all(found.step_at(cell) <= found.step_at(cell + 1) for cell in range(found.cells - 1))


def test_a_cell_of_the_middle_is_met_again() -> None:
    for snapshot in (at(10_000), uneven()):
        found = track(snapshot)
        assert all(found.cell_of(found.step_at(cell)) == cell for cell in range(found.cells))


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
        return track_of(self.bar.snapshot, self.bar.look, self.bar.size.width)


async def test_arrows_move_by_a_cell_shift_by_a_step_pages_by_a_tenth_and_none_beyond_an_end() -> None:
    app = Bench(at(0, 0))
    async with app.run_test(size=(80, 10)) as pilot:

        async def pressed(start: Snapshot, *keys: str) -> list[int]:
            app.bar.sought, app.sought = None, []
            app.bar.show(start)
            await pilot.press(*keys)
            return app.sought

        assert await pressed(at(0, 0), "left", "right", "home", "end", "pageup") == [], "an empty run"
        cells = map(track(at(5_000)).cell_of, (5_000, *await pressed(at(5_000), "left", "left", "right")))
        assert np.diff([*cells]).tolist() == [-1, -1, 1]
        assert await pressed(at(3, 7), "left", "right", "right") == [2, 3, 4], "a short run"
        keys = ("shift+left", "less_than_sign", "greater_than_sign", "pagedown", "pageup", "pageup")
        assert await pressed(at(5_000), *keys) == [4_999, 4_998, 4_999, 3_999, 4_999, 5_999]
        keys = ("home", "left", "pagedown", "end", "right", "end")
        assert await pressed(at(5_000), *keys) == [0, 10_000]


async def test_the_handle_is_at_once_where_it_is_sent_and_stays_until_it_is_let_go() -> None:
    app = Bench(at(10_000))
    async with app.run_test(size=(80, 10)) as pilot:
        await pilot.press("home")
        assert app.text.startswith("ep 0 ●─")
        app.bar.show(at(10_000))
        assert app.bar.at == 0
        app.bar.sought = None
        app.bar.show(at(7_000))
        assert app.bar.at == 7_000


async def test_a_click_goes_there_a_drag_tells_each_moment_once_and_goes_past_the_ends() -> None:
    app = Bench(at(10_000))
    async with app.run_test(size=(80, 10)) as pilot:
        track = app.track
        app.bar.on_mouse_down(events.MouseDown(app.bar, 20, 0, 0, 0, 3, False, False, False, 20, 0))
        assert app.sought == [], "the other buttons do nothing"
        await pilot.click(app.bar, offset=(track.start, 0))
        await pilot.click(app.bar, offset=(track.start + 17, 0))
        await pilot.click(app.bar, offset=(2, 0))
        await pilot.click(app.bar, offset=(track.start + track.cells + 3, 0))
        assert app.sought == [0, track.step_at(17), 10_000]
        app.bar.sought, app.sought = None, []
        app.bar.show(at(10_000))
        await pilot.mouse_down(app.bar, offset=(track.start + 20, 0))
        await pilot.hover(app.bar, offset=(track.start + 20, 0))
        await pilot.hover(app.bar, offset=(track.start + 10, 0))
        await pilot.hover(offset=(0, 5))
        await pilot.mouse_up(offset=(0, 5))
        await pilot.hover(app.bar, offset=(track.start + 30, 0))
    assert app.sought == [track.step_at(20), track.step_at(10), 0]


async def test_at_full_speed_only_the_row_is_drawn_again(monkeypatch: pytest.MonkeyPatch) -> None:
    app = Bench(at(10_000))
    async with app.run_test(size=(80, 10)) as pilot:
        await unfocus(pilot)
        drawn_again: list[object] = []
        monkeypatch.setattr(app.bar, "refresh", lambda *regions, **_: drawn_again.append(regions))
        app.bar.show(changed(at(10_000), speed=3.0))
        assert not drawn_again
        app.bar.show(changed(at(10_500, 10_500), phase=Phase.RUNNING))
        assert len(drawn_again) == 1


async def unfocus(pilot: Pilot[None]) -> None:
    pilot.app.set_focus(None)
    await pilot.pause()
