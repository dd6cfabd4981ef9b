"""A lesson page that asks for a program."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from functools import partial
from pathlib import Path

import pytest
from lessons.program_tasks import SKELETON, program_lesson, updating
from seams import notes, on_screen, order, press, screen_text, snapshot
from textual.pilot import Pilot

from rl_tui.common.errors import UserError
from rl_tui.lessons.file.setups import recipe_of
from rl_tui.lessons.file.view import LessonRecord, begun
from rl_tui.live.commands import KeepLesson
from rl_tui.live.player import Player
from rl_tui.screen.app.app import RlTuiApp
from rl_tui.screen.app.display import Display
from rl_tui.screen.playground.actions.lesson import NOT_HERE
from rl_tui.screen.terminal.driver_choice import IN_BROWSER

LESSON = program_lesson()


@asynccontextmanager
async def page(size: tuple[int, int] = (120, 40), *, kiosk: bool = False) -> AsyncIterator[Pilot[UserError]]:
    recipe = recipe_of(LESSON, "lake")
    make = partial(Player, automatic=False)
    app = RlTuiApp(Display(fps=1000.0), recipe, make, picture=True, kiosk=kiosk)
    app.NOTIFICATION_TIMEOUT = 3600.0
    async with on_screen(app, size, notifications=True) as pilot:
        await order(pilot, KeepLesson(begun(LESSON)))
        yield pilot


def record(pilot: Pilot[UserError]) -> LessonRecord:
    view = snapshot(pilot).lesson
    return view.record


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.exhaustive("plays at another size", but=["size1"])
@pytest.mark.parametrize("size", [(120, 40), (80, 24)])
async def test_from_the_skeleton_to_the_pass(size: tuple[int, int], here: Path) -> None:
    async with page(size) as pilot:
        await press(pilot, "enter", "enter")
        file = here / "my_agent.py"
        assert file.read_text(encoding="utf-8") == SKELETON
        assert "my_agent.py is written" in " ".join(notes(pilot.app))
        await press(pilot, "enter", "enter")
        assert not record(pilot).has_passed("write")
        assert "No number of the" in screen_text(pilot.app)
        file.write_text(updating("reward + gamma * max(Q[next_state])"), encoding="utf-8")
        await press(pilot, "enter", "enter")
        assert "○ nothing is wrong with it (1)" in screen_text(pilot.app)
        assert "line 24" in screen_text(pilot.app)
        file.write_text(updating(), encoding="utf-8")
        await press(pilot, "enter", "enter")
        assert record(pilot).has_passed("write")
        assert record(pilot).passed[0].program == updating()
        assert "PASSED" in screen_text(pilot.app)
        assert snapshot(pilot).counters.step == 0


async def test_a_file_that_is_there_is_never_written_over_nor_one_elsewhere(here: Path) -> None:
    async with page() as pilot:
        await press(pilot, "enter", *"../x.py")
        assert "A name such as my_agent.py" in screen_text(pilot.app)
        await press(pilot, "enter", "escape")
        assert list(here.iterdir()) == []
        (here / "my_agent.py").write_text("mine", encoding="utf-8")
        await press(pilot, "enter", "enter")
        assert (here / "my_agent.py").read_text(encoding="utf-8") == "mine"
        assert "is not changed" in " ".join(notes(pilot.app))
        await press(pilot, "enter", "end", "enter")
        assert "this can be done" in " ".join(notes(pilot.app))  # so it is possible
        await press(pilot, "enter", "down", "enter")
        await press(pilot, *"b.py", "enter")
        assert (here / "b.py").read_text(encoding="utf-8") == SKELETON


async def test_where_others_sit_nothing_is_written(here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    async with page(kiosk=True) as pilot:
        await press(pilot, "enter")
        assert NOT_HERE in " ".join(notes(pilot.app))
        assert list(here.iterdir()) == []
        await press(pilot, "pagedown", "pagedown")
        assert record(pilot).page == "after"
    async with page((80, 24)) as pilot:
        monkeypatch.setenv("TEXTUAL_DRIVER", IN_BROWSER)
        await press(pilot, "enter")
        assert NOT_HERE in " ".join(notes(pilot.app))
        assert list(here.iterdir()) == []
