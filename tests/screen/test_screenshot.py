from __future__ import annotations

import pytest
from conftest import MakeApp
from seams import on_screen, press, screen_text, train

from rl_tui.common.errors import UserError
from rl_tui.runs.library import recipe_for
from rl_tui.runs.recipe import Recipe
from rl_tui.screen.app.display import Colours, Display
from rl_tui.screen.app.screenshot import screenshot
from rl_tui.screen.keys.action import MENUS
from rl_tui.worlds.files.catalogue import find


def recipe(name: str) -> Recipe:
    return recipe_for(find(name), {}, 0)


@pytest.mark.exhaustive("plays at another size", but=["size0"])
@pytest.mark.parametrize("size", [(80, 24), (120, 40)])
async def test_the_same_call_gives_the_same_bytes_whatever_the_terminal(
    size: tuple[int, int], monkeypatch: pytest.MonkeyPatch
) -> None:
    keys = ["space", "wait:1000", "v", "tab"]
    first = await screenshot(recipe("student"), size, keys)
    monkeypatch.setenv("NO_COLOR", "1")
    monkeypatch.setenv("TERM", "vt100")
    assert first == await screenshot(recipe("student"), size, keys)
    assert "1,000" in first


async def test_the_catalogue_has_its_picture() -> None:
    first = await screenshot(None, (80, 24), ["down"])
    assert first == await screenshot(None, (80, 24), ["down"])


async def test_waiting_in_pieces_is_the_same_as_waiting_at_once_and_no_cursor_blinks() -> None:
    whole = await screenshot(recipe("student"), (80, 24), ["wait:300", "r", "s", "4"])
    assert whole == await screenshot(recipe("student"), (80, 24), ["wait:100", "wait:200", "r", "s", "4"])


async def test_a_key_that_is_none_is_refused() -> None:
    with pytest.raises(UserError, match="key 'sapce' is not known"):
        await screenshot(recipe("student"), (80, 24), ["sapce"])


@pytest.mark.exhaustive("the other depths", but=["dark-none", "light-256"])
@pytest.mark.parametrize("colors", ["none", "16", "256", "truecolor"])
@pytest.mark.parametrize("theme", ["dark", "light"])
async def test_every_depth_has_its_picture(colors: Colours, theme: str) -> None:
    display = Display(colors=colors, theme=theme)
    first = await screenshot(recipe("student"), (80, 24), ["wait:100"], display)
    assert first == await screenshot(recipe("student"), (80, 24), ["wait:100"], display)


@pytest.mark.parametrize("keys", [["wait:"], ["wait:-3"], ["wait:x"]])
async def test_a_wait_that_is_none_is_refused(keys: list[str]) -> None:
    with pytest.raises(UserError, match="expected wait:N"):
        await screenshot(recipe("student"), (80, 24), keys)


@pytest.mark.exhaustive("plays at another size", but=["size1"])
@pytest.mark.parametrize("size", [(60, 18), (120, 40)])
async def test_ascii_screens_hold_ascii_characters_only(make_app: MakeApp, size: tuple[int, int]) -> None:
    async with on_screen(make_app("student", ascii=True), size) as pilot:
        await train(pilot, 50)
        assert screen_text(pilot.app).isascii()
        for keys in ("question_mark", "w m", "ctrl+p", "r i", "a a", *MENUS):
            await press(pilot, *keys.split())
            assert len(pilot.app.screen_stack) == (2 if keys == "w m" else 3), keys  # a panel, or a dialog
            assert screen_text(pilot.app).isascii(), keys
            await press(pilot, "escape")
