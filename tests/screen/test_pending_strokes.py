"""Strokes that are on their way to the player."""

from __future__ import annotations

from dataclasses import replace

import pytest
from conftest import MakeApp
from seams import press, snapshot
from textual.pilot import Pilot

from rl_tui.common.errors import UserError
from rl_tui.screen.app.screenshot import settle
from rl_tui.screen.playground.modes import editing as pending
from rl_tui.screen.playground.modes.editing import PendingStrokes
from rl_tui.worlds.editing.edit import read_edits
from rl_tui.worlds.editing.grid_draft import GridDraft

pytestmark = pytest.mark.screen


async def drawn_on(pilot: Pilot[UserError]) -> None:
    await settle(pilot)
    await press(pilot, "w", "d")


async def test_each_stroke_is_drawn_once_however_many_are_on_their_way(
    make_app: MakeApp, monkeypatch: pytest.MonkeyPatch
) -> None:
    async with make_app("maze").run_test(size=(80, 24)) as pilot:
        await drawn_on(pilot)
        shown, strokes, drawn = snapshot(pilot), PendingStrokes(), list[object]()
        draw = pending.edited_draft
        monkeypatch.setattr(pending, "edited_draft", lambda *which: drawn.append(which) or draw(*which))
        for number in range(1, 51):
            strokes.note(shown.playback.handled + number, read_edits(f"world.reward[0,0]={number}"))
            draft = strokes.draft(shown)
            assert strokes.draft(shown) is draft
            assert isinstance(draft, GridDraft)
            assert draft.legend[draft.lines[0][0]].pays == number
        assert len(drawn) == 50
        later = replace(shown.playback, handled=shown.playback.handled + 49)
        strokes.draft(replace(shown, playback=later))
        assert len(drawn) == 51, "of what is in the picture nothing is drawn again"
        strokes.forget()
        assert strokes.draft(shown) is shown.editor.draft
