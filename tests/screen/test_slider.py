from __future__ import annotations

from itertools import product

import pytest
from rich.segment import Segment
from samples import look
from textual import events
from textual.app import App, ComposeResult
from textual.pilot import Pilot
from textual.widgets import Button

from rl_tui.agents.hyperparameters import PARAMETERS, SAMPLE_AVERAGE, Parameter, Range
from rl_tui.screen.panels.controls.slider import Slider
from rl_tui.screen.panels.controls.slider_picture import (
    SliderScale,
    SliderState,
    parsed,
    scale_of,
    slider_form,
    slider_strip,
)

ALPHA, GAMMA, EPSILON = (PARAMETERS[name] for name in ("alpha", "gamma", "epsilon"))
UNIT, OPEN = SliderScale(Range(0, 1)), SliderScale(Range(0, 1, open_low=True))


class Bench(App[None]):
    CSS = "Slider { width: 46; height: 1; } Button { height: 3; }"
    BINDINGS = [("s,e,n,slash,escape", "stolen", "Stolen")]  # noqa: RUF012

    def __init__(self, parameter: Parameter = GAMMA, value: float | str = 0.5) -> None:
        super().__init__()
        self.slider = Slider(look(), parameter, value)
        self.changes: list[tuple[str, float | str]] = []
        self.stolen = 0
        self.released = 0
        self.refusals: list[str] = []

    def compose(self) -> ComposeResult:
        yield self.slider
        yield Button("elsewhere")

    def on_mount(self) -> None:
        self.slider.focus()

    def on_slider_changed(self, event: Slider.Changed) -> None:
        self.changes.append((event.name, event.value))

    def on_slider_released(self) -> None:
        self.released += 1

    def on_slider_refused(self, event: Slider.Refused) -> None:
        self.refusals.append(event.reason)

    def action_stolen(self) -> None:
        self.stolen += 1
        self.changes.append(("stolen", self.stolen))

    @property
    def text(self) -> str:
        return self.slider.render_line(0).text

    @property
    def track(self) -> range:
        form = slider_form(
            self.slider.parameter, SliderState(0.5), self.slider.look.glyphs, self.slider.size.width
        )
        return range(form.start, form.start + form.cells)


def drawn(parameter: Parameter, state: SliderState, width: int, *, ascii: bool = False) -> str:  # noqa: A002
    assert parameter.range is not None
    strip = slider_strip(parameter, scale_of(parameter), state, look(ascii), width)
    assert strip.cell_length == width
    assert all(isinstance(segment, Segment) and segment.style for segment in strip)
    return strip.text


@pytest.mark.parametrize(
    ("state", "width", "expected"),
    [
        (SliderState(0.1), 46, " α  ━━━●───────────────────────────────  0.100"),
        (SliderState(0.1), 26, " α ━━●───────────── 0.100 "),
        (SliderState(1.0), 26, " α ━━━━━━━━━━━━━━━● 1.000 "),
        (SliderState(0.0005), 26, " α ●────────────── 0.0005 "),
        (SliderState(SAMPLE_AVERAGE), 46, " α  1/N  sample average" + " " * 23),
        (SliderState(SAMPLE_AVERAGE), 26, " α 1/N  sample average    "),
        (SliderState(0.5, typed="0.2"), 26, " α ━━━━━━━━●─────── 0.2   "),
        (SliderState(0.5, refused=True), 26, " α ━━━━●─── not in (0, 1] "),
        (SliderState(0.5), 9, " α 0.500 "),
        (SliderState(0.5), 7, " α .500"),
        (SliderState(0.5), 4, " α  "),
    ],
)
def test_it_is_drawn_in_one_row_without_cutting_a_number(
    state: SliderState, width: int, expected: str
) -> None:
    text = drawn(ALPHA, state, width)
    if state.typed is None:
        assert text == expected
    else:
        assert text.split() == expected.split()


def test_a_long_symbol_is_shortened_before_the_number_is_left_out() -> None:
    assert drawn(ALPHA, SliderState(0.5), 9, ascii=True) == " alp .500"


@pytest.mark.parametrize(
    ("width", "ascii", "start"),
    [
        (45, False, " α step size    ━━●──"),
        (32, False, " α step size    ━●──"),
        (29, False, " α ━━●──"),
        (45, True, " alpha step size      ==o-"),
        (32, True, " alpha    =o--"),
    ],
)
def test_the_name_stands_behind_the_symbol_where_there_is_room(width: int, ascii: bool, start: str) -> None:  # noqa: A002
    columns = len("epsilon exploration" if ascii else "ε exploration")
    text = drawn(ALPHA, SliderState(0.1, label_columns=columns, name="step size"), width, ascii=ascii)
    assert text.startswith(start)
    assert text.rstrip().endswith("0.100")


@pytest.mark.parametrize("ascii", [False, True])
def test_what_a_lesson_points_at_has_a_sign_without_colours(ascii: bool) -> None:  # noqa: A002
    plain, lit = (
        drawn(ALPHA, SliderState(0.1, is_pointed_at=each), 26, ascii=ascii) for each in (False, True)
    )
    assert lit == (">" if ascii else "▸") + plain[1:]


@pytest.mark.parametrize("value", [0.001, 0.37, 1.0, SAMPLE_AVERAGE])
def test_every_width_is_filled_exactly(value: float) -> None:
    states = SliderState(value), SliderState(value, "0.1", focused=True), SliderState(value, refused=True)
    for width, state in product(range(1, 70), states):
        drawn(ALPHA, state, width)
        drawn(ALPHA, state, width, ascii=True).encode("ascii")


@pytest.mark.parametrize("scale", [UNIT, OPEN], ids=["closed", "open"])
def test_every_cell_of_a_track_sets_a_value_that_is_drawn_there(scale: SliderScale) -> None:
    for cells in range(3, 160):
        values = [scale.at_cell(cell, cells) for cell in range(cells)]
        assert [scale.cell_of(value, cells) for value in values] == list(range(cells))
        assert (values[0], values[-1]) == (scale.low, 1.0)
        assert all(value in scale.range for value in values)
    assert [UNIT.at_cell(cell, 11) for cell in (-5, 3, 40)] == [0.0, 0.3, 1.0]
    assert scale.at_cell(7, 20) == 0.37


def test_steps_leave_no_rounding_behind_and_stop_at_the_ends() -> None:
    value = 0.0
    for _ in range(100):
        value = UNIT.moved(value, UNIT.step)
    assert value == 1.0
    assert UNIT.moved(0.1, UNIT.step) == 0.11
    assert UNIT.moved(0.995, UNIT.step) == 1.0
    assert UNIT.moved(0.004, -UNIT.step) == 0.0
    assert OPEN.moved(0.01, -OPEN.step) == 0.001
    assert OPEN.moved(0.0004, -OPEN.fine) == 0.0004
    with pytest.raises(ValueError, match="finite range"):
        SliderScale(Range(0))


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("0.25", 0.25),
        (".5", 0.5),
        ("1", 1.0),
        ("0,1", 0.1),
        ("1e-3", 0.001),
        ("1/n", SAMPLE_AVERAGE),
        ("1/N", SAMPLE_AVERAGE),
        ("s", SAMPLE_AVERAGE),
        ("sample-average", SAMPLE_AVERAGE),
    ],
)
def test_what_may_be_typed(text: str, value: float | str) -> None:
    assert parsed(text, ALPHA) == value


@pytest.mark.parametrize("text", ["", "0", "1.01", "-0.1", "nan", "inf", "x", "1/2"])
def test_what_is_no_step_size_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match="type a number above 0 and at most 1, or sample-average, not "):
        parsed(text, ALPHA)


def test_words_belong_to_their_parameter() -> None:
    with pytest.raises(ValueError, match="type a number from 0 to 1, not "):
        parsed("1/n", GAMMA)
    with pytest.raises(ValueError, match="has only words as values"):
        Slider(look(), PARAMETERS["ties"], "random")


async def test_keys_move_it_and_each_movement_is_posted() -> None:
    app = Bench()
    async with app.run_test() as pilot:
        focused = app.slider.render_line(0)
        await pilot.press("tab")
        assert app.slider.render_line(0) != focused, "the focus is seen"
        assert app.slider.render_line(0).text == focused.text
        await pilot.press("shift+tab")
        keys = ("right", "left", "left", "shift+right", "greater_than_sign", "shift+left", "less_than_sign")
        await pilot.press(*keys, "pageup", "pagedown", "pagedown", "home", "home", "left", "end", "right")
        values = [0.51, 0.5, 0.49, 0.491, 0.492, 0.491, 0.49, 0.59, 0.49, 0.39, 0.0, 1.0]
        assert app.changes == [("gamma", value) for value in values]
        assert app.slider.value == 1.0
        assert "━● 1.000" in app.text.replace("  ", " ")


@pytest.mark.parametrize(
    ("name", "value", "keys", "values"),
    [
        (
            "alpha",
            0.02,
            ["left", "left", "left", "shift+left", "home", "pagedown"],
            [0.01, 0.001],
        ),  # an open end
        ("alpha", SAMPLE_AVERAGE, ["right"], [0.1]),  # from a word to the default, for there was no number
        ("temperature", 0.1, ["right", "pageup", "end", "home"], [0.11, 0.28, 100.0, 0.01]),
    ],
)
async def test_keys_never_leave_the_range_and_go_by_its_scale(
    name: str, value: float | str, keys: list[str], values: list[float]
) -> None:
    app = Bench(PARAMETERS[name], value)
    async with app.run_test() as pilot:
        await pilot.press(*keys)
        assert app.changes == [(name, value) for value in values]


async def test_a_value_is_typed_in_its_place() -> None:
    app = Bench()
    async with app.run_test() as pilot:
        await pilot.press("0", "full_stop", "2", "5", "9", "backspace")
        assert app.slider.value == 0.5
        assert "0.25" in app.text
        await pilot.press("enter")
        assert app.changes == [("gamma", 0.25)]
        await pilot.press("full_stop", "7", "escape")
        assert app.slider.value == 0.25
        assert "0.250" in app.text
        await pilot.press("0", "full_stop", "3")
        app.post_message(events.AppBlur())
        await pilot.pause()
        app.post_message(events.AppFocus())
        await pilot.pause()
        assert len(app.changes) == 1, "it waits while the terminal has no focus"
        await pilot.press("3", "enter")
        assert app.changes[1:] == [("gamma", 0.33)]
        assert app.stolen == 0
        app.slider.set_value(1)
        await pilot.pause()
        assert app.slider.value == 1.0
        assert "1.000" in app.text
        assert len(app.changes) == 2, "that is silent"


async def test_what_is_typed_out_of_range_is_refused_with_the_range() -> None:
    app = Bench(ALPHA, 0.5)
    async with app.run_test() as pilot:
        await pilot.press("enter", "1", "full_stop", "5", "enter")
        assert app.slider.state.refused
        assert "not in (0, 1]" in app.text
        assert (app.slider.value, app.changes, app.released) == (0.5, [], 0)
        assert ["1.5" in each and "at most 1" in each for each in app.refusals] == [True]
        await pilot.press("enter", "escape")
        assert "0.500" in app.text
        await pilot.press("0", "enter", "right")
        assert app.changes == [("alpha", 0.51)]
        assert "0.510" in app.text
        assert (len(app.refusals), app.stolen) == (2, 0)


async def test_words_are_typed_and_keys_go_back_to_the_last_number() -> None:
    app = Bench(ALPHA, 0.3)
    async with app.run_test() as pilot:
        await pilot.press("enter", "1", "slash", "n", "enter")
        assert "1/N  sample average" in app.text
        await pilot.press("left")
        assert app.changes == [("alpha", SAMPLE_AVERAGE), ("alpha", 0.3)]
        await pilot.press("enter", "1", "slash", "N", "enter", "home")
        assert app.changes[2:] == [("alpha", SAMPLE_AVERAGE), ("alpha", 0.001)]
        assert app.stolen == 0


async def test_letters_are_left_to_the_screen_once_what_was_typed_is_set() -> None:
    app = Bench()
    async with app.run_test() as pilot:
        await pilot.press("s", "e", "n")
        assert (app.stolen, app.slider.value) == (3, 0.5)
        app.changes, app.stolen = [], 0
        await pilot.press("0", "full_stop", "4", "s", "full_stop", "7", "e")
        assert app.changes == [("gamma", 0.4), ("stolen", 1), ("gamma", 0.7), ("stolen", 2)]
        await pilot.press("9", "n")
        assert app.changes[4:] == [("stolen", 3)]
        assert ["9" in each for each in app.refusals] == [True]
        await pilot.press("enter", "s")
        assert app.changes[5:] == [("stolen", 4)]
        assert (app.slider.is_typing, len(app.refusals)) == (False, 1)


async def test_enter_and_escape_release_it_once_nothing_is_typed() -> None:
    app = Bench()
    async with app.run_test() as pilot:
        await pilot.press("0", "escape")
        assert app.released == 0
        await pilot.press("escape")
        assert app.released == 1
        await pilot.press("enter", "enter")
        assert app.released == 2
        await pilot.press("0", "full_stop", "6", "enter")
        assert (app.released, app.changes, app.stolen) == (3, [("gamma", 0.6)], 0)


async def test_tab_sets_what_was_typed_and_stays_where_that_is_no_value() -> None:
    app = Bench()
    async with app.run_test() as pilot:
        await pilot.press("0", "full_stop", "1", "tab")
        assert not app.slider.has_focus
        assert app.changes == [("gamma", 0.1)]
        await pilot.press("tab", "7", "tab")
        assert app.slider.has_focus
        assert app.slider.state.refused
        assert app.changes == [("gamma", 0.1)]
        assert len(app.refusals) == 1


async def test_the_digits_of_sliders_are_left_to_the_screen_until_a_value_is_begun() -> None:
    app = Bench()
    async with app.run_test() as pilot:
        for key in "1234":
            await pilot.press(key)
            assert not app.slider.is_typing
        for key in ("0", "5", "full_stop", "comma"):
            await pilot.press(key)
            assert app.slider.is_typing
            await pilot.press("escape")
        await pilot.press("enter", "1", "full_stop", "full_stop", "0", "enter")
        assert app.changes == [("gamma", 1.0)]


async def test_a_click_elsewhere_sets_what_was_typed_and_one_on_the_value_begins_typing() -> None:
    app = Bench()
    async with app.run_test() as pilot:
        await pilot.click(app.slider, offset=(app.track.stop + 3, 0))
        assert app.slider.is_typing
        await pilot.press("full_stop", "2")
        await pilot.click(Button)
        assert not app.slider.has_focus
        assert app.changes == [("gamma", 0.2)]


async def test_both_ends_and_every_cell_are_reached_by_a_click_to_which_a_word_gives_way() -> None:
    app = Bench(ALPHA, SAMPLE_AVERAGE)
    async with app.run_test() as pilot:
        await pilot.click(app.slider, offset=(30, 0))
        assert app.changes == [("alpha", 0.1)]
        for column in app.track:
            await pilot.click(app.slider, offset=(column, 0))
            value = app.slider.value
            assert not isinstance(value, str)
            assert OPEN.cell_of(value, len(app.track)) == column - app.track.start
        assert app.slider.value == 1.0
        await pilot.click(app.slider, offset=(app.track.start, 0))
        assert app.slider.value == 0.001
        await pilot.click(app.slider, offset=(1, 0))
        assert app.slider.value == 0.001


async def test_a_drag_follows_the_pointer_past_the_ends() -> None:
    app = Bench()
    async with app.run_test() as pilot:
        await pilot.mouse_down(app.slider, offset=(app.track[3], 0))
        await pilot.hover(app.slider, offset=(app.track[20], 0))
        assert app.slider.value == UNIT.at_cell(20, len(app.track))
        await pilot.hover(app.slider, offset=(app.track.stop + 4, 0))
        assert app.slider.value == 1.0
        await pilot.hover(Button, offset=(0, 1))
        assert app.slider.value == 0.0
        await pilot.mouse_up(Button, offset=(0, 1))
        await pilot.hover(app.slider, offset=(app.track[9], 0))
        assert app.slider.value == 0.0
        assert app.mouse_captured is None


async def wheel(pilot: Pilot[None], slider: Slider, kind: type[events.MouseEvent]) -> None:
    slider.post_message(
        kind(slider, x=9, y=0, delta_x=0, delta_y=0, button=0, shift=False, meta=False, ctrl=False)
    )
    await pilot.pause()


async def test_the_wheel_moves_it_by_a_step() -> None:
    app = Bench(EPSILON, 0.99)
    async with app.run_test() as pilot:
        await wheel(pilot, app.slider, events.MouseScrollUp)
        await wheel(pilot, app.slider, events.MouseScrollUp)
        await wheel(pilot, app.slider, events.MouseScrollDown)
        assert app.changes == [("epsilon", 1.0), ("epsilon", 0.99)]


def test_spelled_out_sliders_one_above_the_other_begin_in_one_column() -> None:
    rows = [
        slider_strip(each, UNIT, SliderState(0.5), look(ascii=True), 60).text
        for each in (ALPHA, GAMMA, EPSILON)
    ]
    assert len({row.index("=") for row in rows}) == 1


# Equal ratios

TAU = scale_of(PARAMETERS["temperature"])


def test_a_temperature_is_walked_in_equal_ratios() -> None:
    assert TAU.logarithmic
    assert (TAU.low, TAU.high) == (0.01, 100.0)
    for value in (0.01, 0.1, 1.0, 10.0):
        assert TAU.moved(value, TAU.step) == pytest.approx(1.1 * value)
        assert TAU.moved(value, TAU.coarse) == pytest.approx(2.5 * value)
        assert TAU.moved(value, TAU.fine) == pytest.approx(1.01 * value)
    walked = 0.1
    for _ in range(30):
        further = TAU.moved(walked, TAU.step)
        assert walked < further <= 1.2 * walked
        walked = further
    for _ in range(40):
        nearer = TAU.moved(walked, -TAU.step)
        assert 0.8 * walked <= nearer < walked
        walked = nearer


def test_its_thumb_stands_where_the_ratio_is() -> None:
    values = 0.001, 0.01, 0.1, 1.0, 10.0, 100.0, 1e6
    assert [TAU.cell_of(value, 41) for value in values] == [0, 0, 10, 20, 30, 40, 40]
    assert [TAU.at_cell(cell, 41) for cell in (0, 10, 20, 30, 40)] == [0.01, 0.1, 1.0, 10.0, 100.0]
    for cells in (5, 17, 33):
        assert all(TAU.cell_of(TAU.at_cell(cell, cells), cells) == cell for cell in range(cells))


def test_a_value_typed_beyond_an_end_is_not_brought_back() -> None:
    assert TAU.moved(1000.0, TAU.step) == 1000.0
    assert TAU.moved(1000.0, -TAU.step) < 1000.0
    assert TAU.moved(100.0, TAU.step) == 100.0
    assert parsed("1000", PARAMETERS["temperature"]) == 1000.0
    with pytest.raises(ValueError, match="ratios"):
        SliderScale(Range(0, 1), logarithmic=True)


def test_a_slider_spans_what_people_try() -> None:
    assert scale_of(PARAMETERS["confidence"]).high == 5.0
    assert scale_of(PARAMETERS["alpha"]).low == 0.001
    for parameter in PARAMETERS.values():
        if parameter.slide is not None:
            assert "●" in drawn(parameter, SliderState(0.1), 40)
