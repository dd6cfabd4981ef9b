"""The app in a real browser."""

from __future__ import annotations

import re
import signal
import time
from collections.abc import AsyncIterator, Iterator
from pathlib import Path

import pytest
import pytest_asyncio

pytest.importorskip("aiohttp", reason='needs aiohttp: pip install "rl-tui[serve]"')
pytest.importorskip("textual_serve", reason='needs textual-serve: pip install "rl-tui[serve]"')

from aiohttp import web
from aiohttp.test_utils import TestServer
from chromium import DEADLINE, Chromium, Tab, chromium, until
from served import Served, is_running, serving

pytestmark = [
    pytest.mark.skipif(chromium() is None, reason="needs Chromium: apt-get install chromium"),
    pytest.mark.asyncio(loop_scope="module"),
]
HEAT = re.compile(r"-?[0-9]\.[0-9]{3}")  # a value in the Q-table


@pytest_asyncio.fixture(scope="module", loop_scope="module")
async def browser(tmp_path_factory: pytest.TempPathFactory) -> AsyncIterator[Chromium]:
    async with Chromium(tmp_path_factory.mktemp("browser") / "profile") as started:
        yield started


@pytest.fixture(scope="module")
def server() -> Iterator[Served]:
    with serving("frozenlake-slippery", "--most", "2", RL_TUI_KIOSK="1") as started:
        yield started


def heat(tab: Tab) -> dict[tuple[int, int], str]:
    """Return the cells (column, row) of the Q-table's values, with the app's background colours."""
    return {
        (found.start(), row): str(tab.emulator.cell(found.start(), row).bg)
        for row, line in enumerate(tab.emulator.text.splitlines())
        for found in HEAT.finditer(line)
        if len(str(tab.emulator.cell(found.start(), row).bg)) == 6
    }


async def shown(tab: Tab, cells: list[tuple[int, int]]) -> list[str]:
    width, height = await tab.cell()
    points = [(column * width + 1, row * height + 1) for column, row in cells]
    return await tab.colours(await tab.screenshot(), points)


async def test_it_is_the_same_app(browser: Chromium, server: Served, tmp_path: Path) -> None:
    tab = await browser.open(server.url, (1280, 800))
    await tab.wait_for("paused")
    assert tab.emulator.columns >= 120
    assert tab.emulator.lines >= 40
    cold = set(heat(tab).values())
    await tab.press(" ")
    await tab.wait_for(r"10/s")
    await tab.press("+++++++")
    await tab.wait_for(r"step +[0-9]{2,},[0-9]{3}")
    await tab.press(" ")
    await tab.wait_for("paused")

    await until(lambda: len(set(heat(tab).values()) - cold) > 5, "the table to be tinted")

    # the window shows the values of the app
    values = heat(tab)
    deadline = time.perf_counter() + DEADLINE
    while await shown(tab, list(values)) != list(values.values()):
        assert time.perf_counter() < deadline, "the window has other colours"
        values = heat(tab)  # the last frame may still be on its way
    picture = await tab.screenshot()
    (tmp_path / "window.png").write_bytes(picture)
    assert picture.startswith(b"\x89PNG")
    edges = await tab.colours(picture, [(1279, 400), (640, 799)])  # beyond the last column and line
    assert edges == [tab.emulator.cell(0, 1).bg] * 2

    await tab.press("v")
    await tab.wait_for(r"Q\*, exact")
    await tab.resize((800, 600))
    await until(lambda: tab.emulator.columns < 100, "the terminal to follow the window")
    await tab.wait_for(r"\? keys\Z")  # in the last corner
    await move_the_first_slider(tab)

    for _ in range(2):
        await tab.press("q")
    await tab.shows("document.querySelector('.ended').checkVisibility()")
    assert await tab.evaluate("document.getElementById('why').textContent") == "You left rl-tui."
    await until(lambda: not server.apps, "the app to end")
    await tab.evaluate("document.getElementById('again').click()")
    await until(lambda: server.apps, "another app to start")

    assert tab.faults == []
    assert {re.sub(r"^ws", "http", url).startswith(server.url) for url in tab.asked_for} == {True}
    await tab.close()
    await until(lambda: not server.apps, "nothing of it to stay")


async def move_the_first_slider(tab: Tab) -> None:
    """Click on the right end of the slider of α, which starts at 0.1."""
    await tab.wait_for(r"α step size\W+0\.100")
    lines = tab.emulator.text.splitlines()
    row = next(row for row, line in enumerate(lines) if re.search(r"α step size\W+0\.100", line))
    column = lines[row].index("0.100") - 4
    width, height = await tab.cell()
    await tab.click((column + 0.5) * width, (row + 0.5) * height)
    await tab.wait_for(r"α step size\W+(0\.[89]|1\.0)")


@pytest.mark.exhaustive("four more pages; tests/browser/test_site.py asks the server itself")
async def test_nobody_else_gets_in_and_nothing_stays(browser: Chromium, server: Served) -> None:
    async with TestServer(web.Application()) as stranger:
        page = await browser.open(str(stranger.make_url("/")), (400, 300))
        await page.shows(f"location.href === '{stranger.make_url('/')}'")
        opened = await page.evaluate(
            "new Promise((done) => {"
            f" const socket = new WebSocket('{server.web_socket}');"
            " socket.onopen = () => done('opened'); socket.onerror = () => done('refused'); })"
        )
        assert opened == "refused"
        assert server.apps == []

    first, second = [await browser.open(server.url, (800, 600)) for _ in range(2)]
    await until(lambda: len(server.apps) == 2, "two apps")
    third = await browser.open(server.url, (800, 600))
    await third.shows("document.body?.textContent.includes('Every place is taken: 2 at once')")
    await third.close()  # otherwise it would ask again, and get the next free place
    await first.close()
    await until(lambda: len(server.apps) == 1, "its app to end")
    await second.wait_for("FrozenLake")

    (left,) = server.apps
    server.process.send_signal(signal.SIGTERM)
    await second.shows("document.getElementById('why').textContent === 'The server was stopped.'")
    assert server.wait() == 0
    assert not is_running(left)
