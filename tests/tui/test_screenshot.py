from __future__ import annotations

import pytest

from rl_tui.common.errors import UserError
from rl_tui.lab.run.library import recipe_for
from rl_tui.lab.run.recipe import Recipe
from rl_tui.tui.app.display import Colours, Display
from rl_tui.tui.app.screenshot import screenshot
from rl_tui.worlds.files.catalogue import find


def recipe(name: str) -> Recipe:
    return recipe_for(find(name), {}, 0)


@pytest.mark.parametrize("size", [(80, 24), (120, 40)])
async def test_the_same_call_gives_the_same_bytes(size: tuple[int, int]) -> None:
    keys = ["space", "wait:1000", "v", "tab"]
    first = await screenshot(recipe("student"), size, keys)
    assert first == await screenshot(recipe("student"), size, keys)
    assert "1,000" in first


async def test_the_catalogue_has_its_picture() -> None:
    first = await screenshot(None, (80, 24), ["down"])
    assert first == await screenshot(None, (80, 24), ["down"])


async def test_waiting_in_pieces_is_the_same_as_waiting_at_once() -> None:
    whole = await screenshot(recipe("student"), (80, 24), ["wait:300"])
    assert whole == await screenshot(recipe("student"), (80, 24), ["wait:100", "wait:200"])


async def test_a_key_that_is_none_is_refused() -> None:
    with pytest.raises(UserError, match="key 'sapce' is not known"):
        await screenshot(recipe("student"), (80, 24), ["sapce"])


@pytest.mark.parametrize("colors", ["none", "16", "256", "truecolor"])
@pytest.mark.parametrize("theme", ["dark", "light"])
async def test_every_depth_has_its_picture(colors: Colours, theme: str) -> None:
    display = Display(colors=colors, theme=theme)
    first = await screenshot(recipe("student"), (80, 24), ["wait:100"], display)
    assert first == await screenshot(recipe("student"), (80, 24), ["wait:100"], display)


async def test_a_picture_does_not_depend_on_the_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    first = await screenshot(recipe("student"), (80, 24))
    monkeypatch.setenv("NO_COLOR", "1")
    monkeypatch.setenv("TERM", "vt100")
    assert first == await screenshot(recipe("student"), (80, 24))


@pytest.mark.parametrize("keys", [["wait:"], ["wait:-3"], ["wait:x"]])
async def test_a_wait_that_is_none_is_refused(keys: list[str]) -> None:
    with pytest.raises(UserError, match="expected wait:N"):
        await screenshot(recipe("student"), (80, 24), keys)


@pytest.mark.parametrize("keys", [[], ["question_mark"], ["m"], ["ctrl+p"], ["i"], ["a"]])
@pytest.mark.parametrize("size", [(60, 18), (120, 40)])
async def test_ascii_screens_hold_ascii_characters_only(size: tuple[int, int], keys: list[str]) -> None:
    svg = await screenshot(recipe("student"), size, ["wait:50", *keys], Display(ascii=True))
    strange = {character for character in svg.replace("&#160;", " ") if ord(character) > 126}
    assert not strange


async def test_a_cursor_does_not_blink_in_a_picture() -> None:
    first = await screenshot(recipe("student"), (80, 24), ["n", "4"])
    assert first == await screenshot(recipe("student"), (80, 24), ["n", "4"])
