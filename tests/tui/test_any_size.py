"""Whatever a key opens can be drawn at any size, and while the size changes."""

from __future__ import annotations

import pytest
from conftest import MakeApp
from seams import screen_text, train
from textual.geometry import Size

from rl_tui.tui.actions.action import Action, Place
from rl_tui.tui.actions.registry import ACTIONS
from rl_tui.tui.app.screenshot import settle
from rl_tui.tui.draw.canvas import Canvas
from rl_tui.tui.theme.palette import palette_for

SIZES = (250, 70), (20, 8), (1, 1), (7, 150), (60, 5), (80, 24), (30, 1), (1, 30), (120, 40), (60, 9)
STYLE = palette_for("truecolor", dark=True).text


def opens(action: Action) -> bool:
    usual = not (action.of_lesson or action.of_program)
    return (
        bool(action.keys)
        and usual
        and Place.PLAYGROUND in action.place
        and action.id not in ("quit", "suspend")
    )


OPENING = [action.id for action in ACTIONS if opens(action)]
EVERYDAY = [each for each in OPENING if each in ("view.model", "agent.show_options")]


def test_a_canvas_leaves_out_whatever_would_stand_outside() -> None:
    for width, height in (0, 0), (1, 0), (1, 1), (3, 2):
        for x in range(-3, 5):
            for y in range(-2, 4):
                canvas = Canvas(width, height, STYLE)
                canvas.put(x, y, "ab", STYLE)
                canvas.put_over(x, y, "abc", STYLE)
                canvas.put_cells(x, y, "abc", [STYLE] * 3)
                canvas.restyle(x, y, 3, STYLE)
                assert canvas.is_blank(x, y, 1) is False
                inside = [0 <= y < height and 0 <= x + place < width for place in range(3)]
                drawn = "".join(strip.text for strip in canvas.strips())
                assert sorted(drawn.strip()) == [
                    each for each, here in zip("abc", inside, strict=True) if here
                ]


@pytest.mark.exhaustive("an app for every key", but=EVERYDAY)
@pytest.mark.parametrize("opening", OPENING)
async def test_what_a_key_opens_is_drawn_at_any_size(opening: str, make_app: MakeApp) -> None:
    (action,) = (each for each in ACTIONS if each.id == opening)
    app = make_app("frozenlake")
    async with app.run_test(size=(80, 24)) as pilot:
        await settle(pilot)
        await train(pilot, 300)
        await pilot.press(action.keys[0])
        await settle(pilot)
        for size in SIZES:
            await pilot.resize_terminal(*size)
            await settle(pilot)
            assert app.screen.size == Size(*size)
            assert screen_text(app)


@pytest.mark.exhaustive("an app for every size and key")
@pytest.mark.parametrize("size", SIZES[1:5])
@pytest.mark.parametrize("opening", OPENING)
async def test_a_key_opens_it_at_any_size(opening: str, size: tuple[int, int], make_app: MakeApp) -> None:
    (action,) = (each for each in ACTIONS if each.id == opening)
    app = make_app("frozenlake")
    async with app.run_test(size=size) as pilot:
        await settle(pilot)
        await pilot.press(action.keys[0])
        await settle(pilot)
        assert app.screen.size == Size(*size)
