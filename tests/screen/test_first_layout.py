"""A playground has its final layout at once."""

from __future__ import annotations

import asyncio
from pathlib import Path

import pytest
from lesson_texts import LESSON
from seams import app_at
from textual.pilot import Pilot

from rl_tui.common.errors import UserError
from rl_tui.lessons.file.view import begun
from rl_tui.live.record import Record
from rl_tui.live.sessions.progress import LessonStart
from rl_tui.live.sessions.session import StoredSession, encoded, read_session
from rl_tui.runs.library import recipe_for
from rl_tui.runs.recipe import Recipe
from rl_tui.runs.timeline.branches import RunRecord
from rl_tui.screen.app.screenshot import settle
from rl_tui.worlds.files.catalogue import find

WIDE, SMALL = (120, 40), (80, 24)


def lake() -> Recipe:
    return recipe_for(find("frozenlake"))


def two_lanes(folder: Path) -> StoredSession:
    path = folder / "two.json"
    path.write_bytes(encoded(Record((RunRecord(lake()), RunRecord(lake())))))
    return read_session(path)


def borders(pilot: Pilot[UserError]) -> dict[str | None, tuple[object, ...]]:
    panels = pilot.app.screen.query("#board > *")
    return {panel.id: (panel.region, panel.size) for panel in panels if panel.region}


@pytest.mark.parametrize(
    ("kind", "size"), [("scenario", WIDE), ("lanes", WIDE), ("lesson", WIDE), ("lesson", SMALL)]
)
async def test_no_panel_moves_when_the_world_is_built(
    kind: str, size: tuple[int, int], tmp_path: Path, is_typed: asyncio.Event
) -> None:
    start: Recipe | StoredSession | LessonStart
    if kind == "lesson":
        start = LessonStart(begun(LESSON))
    else:
        start = lake() if kind == "scenario" else two_lanes(tmp_path)
    async with app_at(start).run_test(size=size) as pilot:
        while not (before := borders(pilot)):
            await pilot.pause()
        is_typed.set()
        settled = asyncio.create_task(settle(pilot))
        while not settled.done():
            now = borders(pilot)
            # the view replaces its placeholder between two frames
            assert {panel: now.get(panel, place) for panel, place in before.items()} == before
            assert now.keys() - before.keys() <= {"world-beside", "table-beside"}
            await asyncio.sleep(0)
        after = borders(pilot)
        assert before.keys() <= after.keys()
        assert ("world-beside" in after) == (kind == "lanes")
