"""The app on a real terminal."""

from __future__ import annotations

import asyncio
from itertools import count

import pytest
from textual import _time

from rl_tui.screen.terminal.linked_app import LinkedApp


async def test_on_a_machine_that_stalls_it_happens_though_late(monkeypatch: pytest.MonkeyPatch) -> None:
    happened = asyncio.Event()
    app = LinkedApp[None]()
    async with app.run_test():
        monkeypatch.setattr(_time, "get_time", count().__next__)  # a second passes between two looks
        app.set_timer(0.001, happened.set)
        async with asyncio.timeout(60):
            await happened.wait()


async def test_without_a_terminal_no_first_paint_is_waited_for() -> None:
    app = LinkedApp[None]()
    async with app.run_test(), asyncio.timeout(60):
        await app.painted()
