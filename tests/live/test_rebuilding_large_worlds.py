"""A large world is rebuilt in the background."""

from __future__ import annotations

import threading
from collections.abc import Iterator

import pytest
from edited_worlds import edit, small_map
from playing import assert_true_to_the_record, begin, stand

from rl_tui.common.errors import UserError
from rl_tui.live import world_editor as rebuild
from rl_tui.live.commands import (
    Apply,
    Command,
    DrawWorld,
    GoTo,
    OpenEditor,
    Pause,
    Play,
    RedoStroke,
    Restart,
    Step,
    StepBack,
    ToggleBreakpoint,
    Train,
    UndoStroke,
)
from rl_tui.live.playback import Playback
from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.live.snapshot_builder import REBUILDING
from rl_tui.live.state import State
from rl_tui.runs import edited_world
from rl_tui.runs.edited_world import NextWorld
from rl_tui.runs.recipe import SetParameter
from rl_tui.worlds.editing.grid_draft import GridDraft

pytestmark = pytest.mark.unit


class Site:
    """A place where worlds are built. Each build waits for its release."""

    def __init__(self) -> None:
        self.begun: list[str] = []
        self._may_end = threading.Semaphore(0)
        self._ended = threading.Semaphore(0)

    def build(self, before: object, change: object, recipe: object) -> NextWorld:
        self.begun.append(type(change).__name__)
        assert self._may_end.acquire(timeout=60)
        try:
            return edited_world.next_world(before, change, recipe)  # type: ignore[arg-type]
        finally:
            self._ended.release()

    def close(self) -> None:
        self._may_end.release(20)

    def let_through(self, playback: Playback) -> None:
        self._may_end.release()
        assert self._ended.acquire(timeout=60)
        for each in threading.enumerate():
            if each.name == "world":
                each.join(60)
        playback.work()


@pytest.fixture
def site(monkeypatch: pytest.MonkeyPatch) -> Iterator[Site]:
    site = Site()
    monkeypatch.setattr("rl_tui.runs.large_worlds.MOST_STATES_AT_ONCE", 5)
    monkeypatch.setattr(rebuild, "next_world", site.build)
    yield site
    site.close()


def live() -> Playback:
    playback = begin(small_map(), automatic=True)
    send(playback, OpenEditor(is_open=True), Train(40))
    while playback.on_the_way:
        playback.work()
    return playback


def send(playback: Playback, *commands: Command) -> Snapshot:
    for command in commands:
        assert playback.takes(command)
        playback.handle(command)
    return playback.snapshot()


def draw(text: str) -> DrawWorld:
    return DrawWorld(edit(text).edits)


def drawn(snapshot: Snapshot) -> tuple[str, ...]:
    draft = snapshot.editor.draft
    assert isinstance(draft, GridDraft)
    return draft.lines


def journal(playback: Playback) -> list[object]:
    return [entry.change for entry in playback.group.current.run.journal]


def test_the_drawing_shows_at_once_and_learning_waits(site: Site) -> None:
    playback = live()
    before = playback.group.current.run.world
    snapshot = send(playback, Play(), draw("cell[1,2]=H"))
    assert drawn(snapshot) == ("S..G", ".#HG", "S..C")
    assert (snapshot.editor.rebuilding, snapshot.playback.message) == (True, REBUILDING)
    assert snapshot.playback.phase is Phase.RUNNING
    assert snapshot.world is before
    for _ in range(5):
        assert playback.work() != 0.0
    assert (playback.group.current.run.step, journal(playback)) == (40, [])
    assert not playback.takes(Step())
    site.let_through(playback)
    assert playback.state is State.RUNNING
    snapshot = playback.snapshot()
    assert (snapshot.editor.rebuilding, snapshot.playback.message) == (False, "")
    assert snapshot.world is not before
    assert [(each.step, each.change) for each in playback.group.current.run.journal] == [
        (40, edit("cell[1,2]=H"))
    ]
    assert_true_to_the_record(playback)


def test_every_stroke_made_meanwhile_is_an_entry_of_its_own(site: Site) -> None:
    playback = live()
    snapshot = send(playback, draw("cell[1,2]=H"), draw("cell[1,2]=#"), draw("cell[0,1]=H"))
    assert drawn(snapshot) == ("SH.G", ".##G", "S..C")
    for _ in range(3):
        assert playback.state is State.REBUILDING
        playback.work()
        site.let_through(playback)
    assert playback.state is State.PAUSED
    assert journal(playback) == [edit("cell[1,2]=H"), edit("cell[1,2]=#"), edit("cell[0,1]=H")]
    assert_true_to_the_record(playback)


def test_what_waits_is_undone_as_if_it_had_not_been_drawn(site: Site) -> None:
    playback = live()
    send(playback, draw("cell[1,2]=H"))
    playback.work()
    snapshot = send(playback, UndoStroke())
    assert drawn(snapshot) == ("S..G", ".#.G", "S..C")
    assert (snapshot.editor.rebuilding, snapshot.editor.can_redo) == (False, True)
    playback.work()
    assert (playback.state, journal(playback)) == (State.PAUSED, [])
    snapshot = send(playback, RedoStroke())
    assert (drawn(snapshot)[1], snapshot.editor.rebuilding) == (".#HG", True)
    site.let_through(playback)
    assert (site.begun, journal(playback)) == (["EditWorld"], [edit("cell[1,2]=H")])
    assert_true_to_the_record(playback)


def test_one_world_is_built_at_a_time_also_one_that_nobody_waits_for(site: Site) -> None:
    playback = live()
    send(playback, draw("cell[1,2]=H"))
    playback.work()
    send(playback, UndoStroke(), draw("cell[0,1]=H"))
    playback.work()
    assert len(site.begun) == 1
    site.let_through(playback)
    assert (len(site.begun), journal(playback)) == (2, [])
    site.let_through(playback)
    assert journal(playback) == [edit("cell[0,1]=H")]
    assert_true_to_the_record(playback)


def test_undoing_what_was_made_waits_for_the_world_before_and_can_be_taken_back(site: Site) -> None:
    playback = live()
    send(playback, draw("cell[1,2]=H"))
    playback.work()
    site.let_through(playback)
    snapshot = send(playback, UndoStroke())
    assert (drawn(snapshot)[1], snapshot.editor.rebuilding) == (".#.G", True)
    assert (snapshot.editor.can_undo, snapshot.editor.can_redo) == (False, True)
    snapshot = send(playback, RedoStroke())
    assert (drawn(snapshot)[1], snapshot.editor.rebuilding) == (".#HG", False)
    send(playback, UndoStroke())
    playback.work()
    site.let_through(playback)
    assert [type(each).__name__ for each in journal(playback)] == ["EditWorld", "UndoEdit"]
    assert_true_to_the_record(playback)


def test_a_stroke_that_comes_to_no_world_waits_on_top_of_those_that_do(site: Site) -> None:
    playback = live()
    send(playback, draw("cell[1,2]=H"))
    snapshot = send(playback, draw("cell[0,0]=.;cell[2,0]=."))
    assert (drawn(snapshot)[1], len(snapshot.editor.unfinished)) == (".#HG", 1)
    send(playback, draw("cell[2,1]=S"))
    for _ in range(2):
        playback.work()
        site.let_through(playback)
    assert journal(playback) == [edit("cell[1,2]=H"), edit("cell[0,0]=.;cell[2,0]=.;cell[2,1]=S")]
    assert_true_to_the_record(playback)


def test_what_is_no_world_is_looked_through_once_not_for_every_picture() -> None:
    playback = live()
    first = send(playback, draw("cell[0,0]=.;cell[2,0]=.")).editor
    assert first.unfinished
    assert send(playback, Play()).editor.draft is first.draft
    assert send(playback, draw("cell[0,1]=H")).editor.draft is not first.draft
    assert send(playback, draw("cell[0,0]=S")).editor.unfinished == ()


def test_pausing_counts_at_once_and_going_back_waits(site: Site) -> None:
    playback = live()
    send(playback, Play(), draw("cell[1,2]=H"))
    assert send(playback, Pause()).playback.phase is Phase.PAUSED
    assert not playback.takes(StepBack())
    assert not playback.takes(GoTo(step=3))
    playback.work()
    site.let_through(playback)
    assert (playback.state, playback.group.current.run.step) == (State.PAUSED, 40)
    send(playback, GoTo(step=3))
    assert drawn(playback.snapshot())[1] == ".#.G"


def test_starting_again_forgets_what_waits(site: Site) -> None:
    playback = live()
    send(playback, draw("cell[1,2]=H"))
    playback.work()
    snapshot = send(playback, Restart(playback.group.current.recipe))
    assert (drawn(snapshot)[1], snapshot.editor.rebuilding) == (".#.G", False)
    site.let_through(playback)
    assert (playback.state, journal(playback)) == (State.PAUSED, [])


def left_and_opened(playback: Playback) -> Playback:
    record = playback.record
    return begin(record.lanes[record.shown].recipe, record)


@pytest.mark.parametrize("goes_back", [False, True])
def test_a_session_that_ends_meanwhile_has_what_waits(site: Site, goes_back: bool) -> None:
    playback = live()
    if goes_back:
        send(playback, Apply(SetParameter("alpha", 0.9)), GoTo(step=20))
        while playback.on_the_way:
            playback.work()
    send(playback, draw("cell[1,2]=H"), draw("cell[0,1]=H"))
    assert playback.table is None, "that is of another world than the session's"
    again = left_and_opened(playback)
    for _ in range(2):
        playback.work()
        site.let_through(playback)
    assert journal(playback)[-2:] == [edit("cell[1,2]=H"), edit("cell[0,1]=H")]
    assert stand(again.group.current.run) == stand(playback.group.current.run)
    assert again.record.lanes == playback.record.lanes
    assert left_and_opened(playback).record.lanes == playback.record.lanes


def test_with_pins_it_has_what_is_in_force_since_they_are_of_that_world(site: Site) -> None:
    playback = live()
    send(playback, ToggleBreakpoint(state=3), draw("rows=+1@0"))
    again = left_and_opened(playback)
    assert (journal(again), again.breakpoints) == ([], playback.breakpoints)


def test_what_cannot_be_made_is_said_and_no_more_waits(site: Site, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(change: object) -> None:
        raise UserError("there is no room")

    playback = live()
    monkeypatch.setattr(playback.group, "apply", refuse)
    send(playback, Play(), draw("cell[1,2]=H"), draw("cell[0,1]=H"))
    playback.work()
    site.let_through(playback)
    snapshot = playback.snapshot()
    assert (snapshot.playback.phase, snapshot.playback.paused_by) == (Phase.PAUSED, "there is no room")
    assert (snapshot.editor.rebuilding, journal(playback)) == (False, [])
    assert drawn(snapshot) == ("S..G", ".#.G", "S..C")


def test_in_a_small_world_a_stroke_is_made_at_once() -> None:
    playback = live()
    snapshot = send(playback, draw("cell[1,2]=H"))
    assert (snapshot.editor.rebuilding, journal(playback)) == (False, [edit("cell[1,2]=H")])
