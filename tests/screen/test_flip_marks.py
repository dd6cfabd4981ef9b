"""The flip points on the slider of γ."""

from __future__ import annotations

import pytest
from conftest import MakeApp
from samples import look, student
from seams import notes, on_screen, playground, press, screen_text, slider, snapshot
from snapshots import changed
from textual.app import App, ComposeResult

from rl_tui.agents.hyperparameters import PARAMETERS
from rl_tui.live.commands import AskFlips, Command
from rl_tui.runs.answers.flip_answer import FlipState, worked_out
from rl_tui.runs.library import recipe_named
from rl_tui.runs.recipe import begin
from rl_tui.screen.panels.controls.controls import flip_marks
from rl_tui.screen.panels.controls.slider import Slider, key_hints
from rl_tui.screen.panels.controls.slider_picture import SliderMark, SliderState, scale_of, slider_strip
from rl_tui.screen.theme.glyphs import ASCII, UNICODE
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

GAMMA = PARAMETERS["gamma"]


def discount_mdp() -> TabularMDP:
    mdp = begin(recipe_named("discount")).world.mdp
    assert mdp is not None
    return mdp


QUARTER = SliderMark(0.25, 0.24, 0.26)
HALF = SliderMark(0.5, 0.49, 0.51)
ASIDE = SliderMark(0.5, 0.49, 0.51, stands_out=False)


def row(*marks: SliderMark, value: float = 0.9, ascii: bool = False, width: int = 45) -> str:  # noqa: A002
    state = SliderState(value, marks=marks)
    return slider_strip(GAMMA, scale_of(GAMMA), state, look(ascii), width).text


@pytest.mark.parametrize("ascii", [False, True])
def test_a_mark_takes_one_cell_of_the_track_and_moves_nothing(ascii: bool) -> None:  # noqa: A002
    glyphs = ASCII if ascii else UNICODE
    without, with_marks = row(ascii=ascii), row(QUARTER, HALF, ascii=ascii)
    changed = [place for place, (was, now) in enumerate(zip(without, with_marks, strict=True)) if was != now]
    assert len(changed) == 2
    assert [with_marks[place] for place in changed] == [glyphs.flip] * 2
    assert len({glyphs.flip, glyphs.side_flip, glyphs.thumb, glyphs.track_done, glyphs.track_rest}) == 5


def test_marks_that_stand_close_together_share_a_cell() -> None:
    near = SliderMark(0.2501, 0.2500, 0.26)
    assert row(QUARTER, near) == row(QUARTER)


def test_what_stands_out_hides_what_does_not_and_the_thumb_hides_both() -> None:
    assert UNICODE.side_flip in row(ASIDE)
    assert row(ASIDE, HALF) == row(HALF, ASIDE) == row(HALF)
    assert row(HALF, value=0.5) == row(value=0.5)


def test_they_are_seen_on_both_parts_of_the_track_at_any_width() -> None:
    for width in range(1, 60):
        assert len(row(QUARTER, HALF, value=0.4, width=width)) == width
    assert row(QUARTER, HALF, value=0.4).count(UNICODE.flip) == 2


@pytest.mark.parametrize("ascii", [False, True])
@pytest.mark.parametrize("depth", ["truecolor", "16", "none"])
def test_at_the_ends_and_while_a_value_is_typed_or_refused_they_are_seen(ascii: bool, depth: str) -> None:  # noqa: A002
    ends = SliderMark(1e-4, 0.0, 0.01), SliderMark(0.9999, 0.99, 0.99995, stands_out=False)
    dressed = look(ascii, depth)
    states = [SliderState(0.5, marks=ends), SliderState(0.5, typed="0.", marks=ends)]
    for state in (*states, SliderState(0.5, refused=True, marks=ends)):
        strip = slider_strip(GAMMA, scale_of(GAMMA), state, dressed, 60)
        track = strip.text[strip.text.index(dressed.glyphs.flip) :]
        assert strip.cell_length == 60
        assert dressed.glyphs.side_flip in track
        assert dressed.glyphs.thumb in track


def test_flips_of_the_way_are_marked_others_on_request_and_none_while_the_answer_is_hidden() -> None:
    mdp = discount_mdp()
    shown = changed(student(), flips=worked_out(mdp))
    assert len(flip_marks(shown, every=True)) == 14
    assert [round(mark.value, 12) for mark in flip_marks(shown, every=False)] == [0.518845036131]
    assert flip_marks(changed(shown, is_hidden=True), every=True) == ()
    assert flip_marks(student(), every=True) == ()


class Bench(App[None]):
    def __init__(self) -> None:
        super().__init__()
        self.slider = Slider(look(), GAMMA, 0.9)
        self.changes: list[float | str] = []

    def compose(self) -> ComposeResult:
        yield self.slider

    def on_mount(self) -> None:
        self.slider.focus()

    def on_slider_changed(self, event: Slider.Changed) -> None:
        self.changes.append(event.value)


async def test_keys_go_beyond_the_next_mark_and_stay_where_there_is_none() -> None:
    app = Bench()
    async with app.run_test() as pilot:
        await pilot.press("left_curly_bracket", "right_curly_bracket")
        assert app.changes == []
        assert "{ }" not in str(key_hints(app.slider))
        app.slider.set_marks((QUARTER, HALF))
        down, up = ["left_curly_bracket"] * 3, ["right_curly_bracket"] * 3
        await pilot.press(*down, *up)
        assert app.changes == [0.49, 0.24, 0.26, 0.51]
        assert "{ }" in str(key_hints(app.slider))
        await pilot.press("0", "full_stop", "4", "enter", "right_curly_bracket")
        assert app.changes[4:] == [0.4, 0.51], "a value is typed as before"


# In the playground


async def test_the_marks_come_with_the_focus_and_a_key_turns_the_policy(make_app: MakeApp) -> None:
    async with on_screen(make_app("student"), (120, 40)) as pilot:
        assert slider(pilot.app, "gamma").marks == ()
        before = screen_text(pilot.app)
        await press(pilot, "2")
        assert slider(pilot.app, "gamma").marks == (), "the student's answer is hidden at first"
        assert snapshot(pilot).answers.flips.state is FlipState.NOT_ASKED
        shown = await press(pilot, "w", "h")
        assert slider(pilot.app, "gamma").marks == (QUARTER,)
        assert UNICODE.flip in screen_text(pilot.app)
        assert len(before) == len(screen_text(pilot.app))
        assert shown.exact_answer.expected_return == 7.5
        shown = await press(pilot, "left_curly_bracket")
        assert shown.agent.hyperparameters.gamma == 0.24
        assert shown.exact_answer.expected_return == 0.0
        await press(pilot, "escape")
        assert slider(pilot.app, "gamma").marks == (QUARTER,), "they stay"
        assert notes(pilot.app) == []


async def test_of_discount_one_flip_is_marked_and_all_while_the_panel_is_open(make_app: MakeApp) -> None:
    async with on_screen(make_app("discount"), (120, 40)) as pilot:
        await press(pilot, "t", "g")
        assert len(slider(pilot.app, "gamma").marks) == 14
        assert screen_text(pilot.app).count(UNICODE.side_flip) > 10
        await press(pilot, "t", "g")
        assert [round(mark.value, 12) for mark in slider(pilot.app, "gamma").marks] == [0.518845036131]


async def test_nobody_asks_for_them_before_somebody_may_see_them(make_app: MakeApp) -> None:
    async with on_screen(make_app("frozenlake-slippery")) as pilot:
        await press(pilot, "s", "1", "right", "escape")
        assert snapshot(pilot).answers.flips.state is FlipState.NOT_ASKED
        assert snapshot(pilot).playback.handled == 2


async def test_they_are_asked_for_where_the_focus_moved_before_a_snapshot_was_drawn(
    make_app: MakeApp, monkeypatch: pytest.MonkeyPatch
) -> None:
    async with on_screen(make_app("student")) as pilot:
        screen, sent = playground(pilot), list[Command]()
        hidden = await press(pilot, "2")
        monkeypatch.setattr(screen.link, "send", sent.append)
        screen.link.receive(changed(hidden, is_hidden=False))
        screen.show_key_hints()
        screen.redraw()
        assert sent == [AskFlips()]
