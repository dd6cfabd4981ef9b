"""Memory limits for the runs of a kiosk."""

from __future__ import annotations

from dataclasses import replace

import pytest
from recipes import recipe

from rl_tui.common.errors import UserError
from rl_tui.runs.edited_world import EditedWorld
from rl_tui.runs.recipe import SetParameter, begin
from rl_tui.runs.timeline.branches import RunRecord
from rl_tui.runs.timeline.branching_run import BranchingRun
from rl_tui.runs.timeline.checkpoints import KIOSK, USUAL, Checkpoints, limits
from rl_tui.runs.timeline.run_group import MOST


def test_four_lanes_of_a_kiosk_keep_64_megabytes() -> None:
    in_all = KIOSK.checkpoints + KIOSK.checkpoints_left + KIOSK.samples + KIOSK.samples_left
    assert MOST * in_all == 64 * 2**20


def test_the_variable_chooses(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("RL_TUI_KIOSK", raising=False)
    assert limits() is USUAL
    monkeypatch.setenv("RL_TUI_KIOSK", "1")
    assert limits() is KIOSK


def test_checkpoints_stay_within_them(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("RL_TUI_KIOSK", "1")
    lane = _lane()
    kept = Checkpoints()
    for _ in range(600):
        lane.advance(steps=5)
        kept.add(lane.run.checkpoint())
    assert len(kept) > 2
    assert kept.nbytes <= KIOSK.checkpoints


def test_branches_are_so_many(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("RL_TUI_KIOSK", "1")
    lane = _lane()
    for number in range(50):
        lane.advance(steps=10)
        lane.seek_to(step=5)
        while lane.seek:
            lane.continue_seek(1000)
        if number < 49:
            lane.apply(SetParameter("alpha", 0.1 + number / 1000))
    assert len(lane.timeline.branches) == 50
    with pytest.raises(UserError, match=r"^a kiosk allows at most 50 branches; r r starts again$"):
        lane.apply(SetParameter("alpha", 0.9))


def test_changes_are_so_many(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("RL_TUI_KIOSK", "1")
    monkeypatch.setattr("rl_tui.runs.timeline.checkpoints.KIOSK", replace(KIOSK, changes=5))
    lane = _lane()
    for number in range(5):
        lane.apply(SetParameter("alpha", 0.1 + number / 100))
    with pytest.raises(UserError, match=r"^a kiosk allows at most 5 changes; r r starts again$"):
        lane.apply(SetParameter("alpha", 0.9))
    assert len(lane.run.journal) == 5


def _lane() -> BranchingRun:
    made_from = recipe("student")
    return BranchingRun(RunRecord(made_from), EditedWorld(begin(made_from).world))
