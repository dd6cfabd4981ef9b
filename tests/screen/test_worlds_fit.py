"""Every shipped world fits every screen."""

from __future__ import annotations

from itertools import combinations
from typing import Final

import pytest
from conftest import MakeApp
from rich.cells import cell_len
from seams import on_screen, playground, train
from shipped import SHIPPED

from rl_tui.screen.app.screenshot import settle
from rl_tui.screen.kit.panel import Panel

SIZES: Final = [(60, 18), (80, 24), (120, 40), (160, 50), (200, 60)]
EVERY_DAY: Final = ["taxi", "student", "windy-king"]


@pytest.mark.exhaustive("plays every scenario", but=EVERY_DAY)
@pytest.mark.parametrize("name", SHIPPED)
async def test_nothing_overlaps_or_is_cut_off(make_app: MakeApp, name: str) -> None:
    async with on_screen(make_app(name), SIZES[0]) as pilot:
        await train(pilot, 300)
        board = playground(pilot).board
        for size in SIZES:
            await pilot.resize_terminal(*size)
            await settle(pilot)
            shown = [panel for panel in board.children if board.shows(panel.id or "")]
            assert {"world", "table", "curve"} <= {panel.id for panel in shown}
            for panel in shown:
                assert board.region.contains_region(panel.region), (size, panel.id)
            for one, other in combinations(shown, 2):
                assert not one.region.overlaps(other.region), (size, one.id, other.id)
            for panel in (each for each in shown if isinstance(each, Panel)):
                assert cell_len(panel.head) <= panel.region.width, (size, panel.head)
                lengths = {panel.render_line(y).cell_length for y in range(panel.size.height)}
                assert lengths == {panel.size.width}, (size, panel.id)
