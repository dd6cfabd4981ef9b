"""Pictures of whole screens. Update one only after looking at it: see docs/internals/tests.md."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any, Final

import pytest
from conftest import MakeApp
from textual.pilot import Pilot
from textual.widgets import OptionList

from rl_tui.common.errors import UserError
from rl_tui.live.commands import Train
from rl_tui.screen.app.screenshot import settle
from rl_tui.screen.playground.playground import Playground
from rl_tui.worlds.files.catalogue import scenarios

SAMPLES: Final = Path(__file__).parent / "sample_scenarios"
SIZES: Final = [(80, 24), (120, 40)]
SCENES: Final = {  # a scenario, then keys. A number takes that many steps
    "bandit-halfway": ("bandit", 300),
    "bandit-spent": ("bandit", 1_000),
    "student-started": ("student", 1),
    "student-trained": ("student", 2_000),
    "lake-started": ("frozenlake-slippery", 1),
    "lake-trained": ("frozenlake-slippery", 400_000),
    "lake-actions": ("frozenlake-slippery", 20_000, "w", "a"),
    "past": ("frozenlake-slippery", 5_000, "1", "right", 5_000, *"mg7000", "enter", "b", "B"),
    "journal": ("student", 300, *"mg200", "enter", "1", "right", 100, "m", "b"),
    "microscope": ("frozenlake-slippery", 60_000, "d"),
    "lanes": ("cliff", 3_000, "c", "a", "enter", 12_000),
    "hand": ("student", 40, "y", "1"),
    "drawing": ("maze", 3_000, "w", "d", "right", "right", "H", "s", "down", "number_sign"),
    "drawing-unfinished": ("student", 200, "w", "d", "delete", "delete"),
}


def _named(size: tuple[int, int]) -> str:
    return f"{size[0]}x{size[1]}"


@pytest.mark.parametrize("size", SIZES, ids=_named)
@pytest.mark.parametrize("scene", SCENES)
def test_playground(scene: str, size: tuple[int, int], snap_compare: Any, make_app: MakeApp) -> None:
    scenario, *keys = SCENES[scene]

    async def play(pilot: Pilot[UserError]) -> None:
        await settle(pilot)
        for key in keys:
            if isinstance(key, int):
                screen = pilot.app.screen
                assert isinstance(screen, Playground)
                screen.send(Train(key))
            else:
                await pilot.press(key)
            await settle(pilot)

    assert snap_compare(make_app(scenario), terminal_size=size, run_before=play)


@pytest.fixture
def sample_catalogue(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Made-up scenarios, so that a new shipped scenario changes no picture."""
    shutil.copytree(SAMPLES, tmp_path, dirs_exist_ok=True)
    for cells in range(5, 26):  # more rows than a screen has
        lines = (f'title = "A corridor of {cells} cells"', f"order = {300 + cells}", "[grid]")
        corridor = f'map = "S{"." * (cells - 2)}G"'
        (tmp_path / f"corridor-{cells:02}.toml").write_text("\n".join((*lines, corridor)), encoding="utf-8")
    monkeypatch.setattr("rl_tui.worlds.files.catalogue.shipped_folder", lambda: tmp_path)


@pytest.mark.usefixtures("sample_catalogue")
@pytest.mark.parametrize("size", SIZES, ids=_named)
def test_catalogue(size: tuple[int, int], snap_compare: Any, make_app: MakeApp) -> None:
    async def choose_the_pond(pilot: Pilot[UserError]) -> None:
        await settle(pilot)
        listed = pilot.app.screen.query_one("#scenarios", OptionList)
        listed.highlighted = listed.get_option_index("pond")
        await settle(pilot)
        assert {each.id for each in scenarios()} <= {option.id for option in listed.options}

    assert snap_compare(make_app(), terminal_size=size, run_before=choose_the_pond)


def test_no_picture_is_left_over() -> None:
    kept = Path(__file__).parent / "__snapshots__" / "test_pictures"
    names = {f"test_playground[{scene}-{_named(size)}].svg" for scene in SCENES for size in SIZES}
    names |= {f"test_catalogue[{_named(size)}].svg" for size in SIZES}
    assert {path.name for path in kept.iterdir()} == names
