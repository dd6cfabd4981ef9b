"""Pictures of whole screens. Update one only after looking at it: see CONTRIBUTING.md."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Final

import pytest
from conftest import MakeApp
from textual.pilot import Pilot
from textual.widgets import OptionList

from rl_tui.lab.commands import Train
from rl_tui.tui.screens.playground import Playground
from rl_tui.tui.screenshot import settle
from rl_tui.worlds.errors import UserError

SIZES: Final = [(80, 24), (120, 40)]
MOMENTS: Final = {
    "bandit": {"started": 1, "halfway": 300, "trained": 1_000},
    "student": {"started": 1, "halfway": 40, "trained": 2_000},
    "frozenlake": {"started": 1, "halfway": 3_000, "trained": 60_000},
    "frozenlake-slippery": {"started": 1, "halfway": 5_000, "trained": 400_000},
}


def _named(size: tuple[int, int]) -> str:
    return f"{size[0]}x{size[1]}"


@pytest.mark.parametrize("size", SIZES, ids=_named)
@pytest.mark.parametrize(
    ("scenario", "moment"),
    [(scenario, moment) for scenario, moments in MOMENTS.items() for moment in moments],
)
def test_playground(
    scenario: str, moment: str, size: tuple[int, int], snap_compare: Any, make_app: MakeApp
) -> None:
    async def train(pilot: Pilot[UserError]) -> None:
        await settle(pilot)
        for screen in pilot.app.screen_stack:
            if isinstance(screen, Playground):
                screen.send(Train(MOMENTS[scenario][moment]))
        await settle(pilot)

    assert snap_compare(make_app(scenario), terminal_size=size, run_before=train)


@pytest.mark.parametrize("size", SIZES, ids=_named)
def test_catalogue(size: tuple[int, int], snap_compare: Any, make_app: MakeApp) -> None:
    async def choose_a_lake(pilot: Pilot[UserError]) -> None:
        await settle(pilot)
        listed = pilot.app.screen.query_one("#scenarios", OptionList)
        listed.highlighted = listed.get_option_index("frozenlake-slippery")
        await settle(pilot)

    assert snap_compare(make_app(), terminal_size=size, run_before=choose_a_lake)


def test_no_picture_is_left_over() -> None:
    kept = Path(__file__).parent / "__snapshots__" / "test_pictures"
    drawn = [f"playground[{scenario}-{moment}" for scenario, moments in MOMENTS.items() for moment in moments]
    names = {f"test_{one}-{_named(size)}].svg" for one in drawn for size in SIZES}
    names |= {f"test_catalogue[{_named(size)}].svg" for size in SIZES}
    assert {path.name for path in kept.iterdir()} == names
