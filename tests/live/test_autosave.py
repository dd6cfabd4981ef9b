"""Sessions save themselves, with one program per file."""

from __future__ import annotations

import errno
import os
import subprocess
import sys
import threading
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from autosaving import OPENED, at, kept, notices_of, only
from recipes import recipe
from session_samples import after, fresh

from rl_tui.common.files import FileLock, draft_of, write_atomically
from rl_tui.live.record import LearnedTable, Record
from rl_tui.live.sessions import writer as held_file
from rl_tui.live.sessions.autosave import Autosave
from rl_tui.live.sessions.place import session_folder
from rl_tui.live.sessions.session import digest_of, encoded, read_session, sessions_in
from rl_tui.runs.recipe import EditWorld, SetParameter
from rl_tui.worlds.editing.edit import read_edits


def resumed(path: Path, folder: Path) -> tuple[Autosave, Record]:
    session = read_session(path)
    record = session.record()
    return Autosave(record, folder, session), record


def test_merely_looking_begins_no_file(tmp_path: Path) -> None:
    kept(tmp_path / "sessions", OPENED, replace(OPENED, speed=None), OPENED)
    assert not (tmp_path / "sessions").exists()


def test_the_first_action_begins_a_file_and_the_last_one_is_in_it(tmp_path: Path) -> None:
    kept(tmp_path, OPENED, at(1), at(2), at(3))
    session = only(tmp_path)
    assert session.step == 3
    assert session.path.name.startswith("student-")
    assert not session.document.kept


def test_without_a_step_there_is_nothing_to_keep(tmp_path: Path) -> None:
    changed = after(OPENED, 0, (0, SetParameter("alpha", 0.5)))
    another_seed = fresh(replace(OPENED.lanes[0].recipe, seed=7))
    kept(tmp_path / "sessions", changed, another_seed)
    assert not (tmp_path / "sessions").exists()


def test_what_was_set_before_the_first_step_is_kept_with_it(tmp_path: Path) -> None:
    change = (0, SetParameter("alpha", 0.5))
    kept(tmp_path, after(OPENED, 0, change), after(OPENED, 1, change))
    assert (only(tmp_path).step, only(tmp_path).changes) == (1, 1)


def test_a_world_that_was_drawn_is_kept_without_a_step_once_however_often_it_starts_again(
    tmp_path: Path,
) -> None:
    drawn = after(OPENED, 0, (0, EditWorld(read_edits("world.time_limit=50"))))
    autosave = Autosave(OPENED, tmp_path)
    autosave.offer(drawn)
    for _ in range(3):
        autosave.begin_anew(drawn)
    autosave.close()
    assert (only(tmp_path).step, only(tmp_path).changes, only(tmp_path).is_blank) == (0, 1, False)


def test_one_saved_by_name_goes_on_without_a_step(tmp_path: Path) -> None:
    autosave = Autosave(OPENED, tmp_path)
    autosave.save_as("lesson")
    autosave.offer(after(OPENED, 0, (0, SetParameter("alpha", 0.5))))
    autosave.close()
    assert (only(tmp_path).step, only(tmp_path).changes) == (0, 1)


def test_it_is_written_while_the_program_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    written = threading.Event()
    write = held_file.write_atomically

    def note(path: Path, content: bytes) -> None:
        write(path, content)
        written.set()

    monkeypatch.setattr(held_file, "write_atomically", note)
    autosave = Autosave(OPENED, tmp_path)
    autosave.offer(at(5))
    assert written.wait(30)
    assert sessions_in(tmp_path)[0][0].step == 5
    written.clear()
    autosave.offer(at(6))
    assert written.wait(30)
    assert sessions_in(tmp_path)[0][0].step == 6
    autosave.close()


def test_offering_never_waits_for_the_disk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    disk_hangs = threading.Event()
    monkeypatch.setattr(held_file, "write_atomically", lambda *_: disk_hangs.wait(30))
    autosave = Autosave(OPENED, tmp_path)
    for step in range(1, 50):
        autosave.offer(at(step))
    disk_hangs.set()
    autosave.close()


def test_a_resumed_session_goes_on_in_its_file(tmp_path: Path) -> None:
    kept(tmp_path, at(3))
    path = only(tmp_path).path
    autosave, opened = resumed(path, tmp_path)
    autosave.offer(after(opened, 9))
    autosave.close()
    assert only(tmp_path).path == path
    assert only(tmp_path).step == 9
    assert notices_of(autosave) == []


def test_a_resumed_session_that_is_only_looked_at_is_not_written(tmp_path: Path) -> None:
    kept(tmp_path, at(3))
    before = only(tmp_path).written
    autosave, opened = resumed(only(tmp_path).path, tmp_path)
    autosave.offer(opened)
    autosave.close()
    assert only(tmp_path).written == before


def test_the_second_program_gets_a_copy(tmp_path: Path) -> None:
    first = Autosave(OPENED, tmp_path)
    first.save_as("evening")
    path = tmp_path / "evening.json"
    second, opened = resumed(path, tmp_path)
    assert any("evening.json is open in another program" in notice for notice in notices_of(second))
    second.offer(after(opened, 77))
    second.close()
    first.offer(at(8))
    first.close()
    sessions, broken = sessions_in(tmp_path)
    assert broken == []
    assert {(each.title, each.step, each.document.kept) for each in sessions} == {
        ("evening", 8, True),
        ("evening (copy)", 77, False),
    }


@pytest.mark.process
def test_a_killed_program_leaves_no_lock(tmp_path: Path) -> None:
    path = tmp_path / "evening.json"
    hold = (
        "import sys, time; from pathlib import Path; from rl_tui.common.files import FileLock\n"
        "lock = FileLock(Path(sys.argv[1])); print(lock.acquire(), flush=True); time.sleep(600)"
    )
    with subprocess.Popen(
        [sys.executable, "-c", hold, str(path)], stdout=subprocess.PIPE, text=True
    ) as other:
        assert other.stdout.readline() == "True\n"
        assert not FileLock(path).acquire()
        other.kill()
    lock = FileLock(path)
    assert lock.acquire()
    lock.release()
    assert os.listdir(tmp_path) == []


def test_a_file_that_somebody_else_wrote_is_left_alone(tmp_path: Path) -> None:
    autosave = Autosave(OPENED, tmp_path)
    path = autosave.save_as("evening")
    path.write_text("mine now", encoding="utf-8")
    autosave.offer(at(5))
    autosave.close()
    assert path.read_text(encoding="utf-8") == "mine now"
    assert any("changed by another program" in notice for notice in notices_of(autosave))
    assert [each.step for each in sessions_in(tmp_path)[0]] == [5]


def test_a_file_that_was_removed_is_there_again(tmp_path: Path) -> None:
    autosave = Autosave(OPENED, tmp_path)
    autosave.save_as("evening").unlink()
    autosave.offer(at(5))
    autosave.close()
    assert only(tmp_path).step == 5


def test_a_session_in_a_folder_that_is_read_only_goes_on_in_a_copy(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    elsewhere = tmp_path / "class" / "lesson.json"
    elsewhere.parent.mkdir()
    elsewhere.write_bytes(encoded(at(3)))
    monkeypatch.setattr(held_file.os, "access", lambda *_: False)  # root can write everywhere
    autosave, opened = resumed(elsewhere, tmp_path / "sessions")
    autosave.offer(after(opened, 4))
    autosave.close()
    assert read_session(elsewhere).step == 3
    assert only(tmp_path / "sessions").step == 4
    assert len(notices_of(autosave)) == 1


def test_a_session_from_elsewhere_goes_on_where_it_is(tmp_path: Path) -> None:
    elsewhere = tmp_path / "lesson.json"
    elsewhere.write_bytes(encoded(at(3)))
    autosave, opened = resumed(elsewhere, tmp_path / "sessions")
    autosave.offer(after(opened, 4))
    autosave.close()
    assert only(tmp_path).step == 4


def test_what_cannot_be_saved_is_told_once_and_the_program_goes_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    disk = FullDisk(monkeypatch)
    autosave = Autosave(OPENED, tmp_path)
    for step in range(1, 4):
        autosave.offer(at(step))
        autosave.write_due()
    assert notices_of(autosave) == ["this session is not being saved: No space left on device"]
    disk.full = False
    autosave.close()
    assert only(tmp_path).step == 3


class FullDisk:
    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.full = True
        self._write = held_file.write_atomically
        monkeypatch.setattr(held_file, "write_atomically", self._fail)

    def _fail(self, path: Path, content: bytes) -> None:
        if self.full:
            raise OSError(28, "No space left on device")
        self._write(path, content)


def test_it_is_tried_again_though_nothing_more_is_done(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    disk = FullDisk(monkeypatch)
    autosave = Autosave(OPENED, tmp_path)
    autosave.offer(at(3))
    autosave.write_due()
    disk.full = False
    assert autosave.has_work
    autosave.write_due()
    assert sessions_in(tmp_path)[0][0].step == 3
    assert not autosave.has_work
    assert [each.split(":")[0] for each in notices_of(autosave)] == [
        "this session is not being saved",
        "this session is being saved again",
    ]
    autosave.close()


def test_a_session_that_was_left_while_the_disk_was_full_is_not_lost(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    disk = FullDisk(monkeypatch)
    autosave = Autosave(OPENED, tmp_path)
    autosave.offer(at(4))
    autosave.begin_anew(OPENED)
    autosave.offer(at(9))
    autosave.write_due()
    disk.full = False
    autosave.close()
    assert sorted(each.step for each in sessions_in(tmp_path)[0]) == [4, 9]
    assert all(each.suffix == ".json" for each in tmp_path.iterdir()), "every lock is given back"


def learned(q: np.ndarray) -> LearnedTable:
    return LearnedTable(q, np.zeros(len(q), np.int64), episodes=0, state=0)


def digest(folder: Path) -> str:
    return only(folder).document.digest


def test_the_table_is_taken_as_it_was_when_offered(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    q, is_changed = np.zeros(5), threading.Event()

    def digest_later(table: np.ndarray) -> str:
        assert is_changed.wait(30)
        return digest_of(table)

    monkeypatch.setattr("rl_tui.live.sessions.autosave.digest_of", digest_later)
    autosave = Autosave(OPENED, tmp_path)
    autosave.offer(at(1), learned(q))
    q[:] = 1.0
    is_changed.set()
    autosave.close()
    assert digest(tmp_path) == digest_of(np.zeros(5))


def test_a_table_that_comes_later_is_told_too(tmp_path: Path) -> None:
    autosave = Autosave(OPENED, tmp_path)
    autosave.offer(at(1))
    autosave.offer(at(1), learned(np.ones(5)))
    autosave.offer(at(1), learned(np.ones(5)))
    autosave.close()
    assert digest(tmp_path) == digest_of(np.ones(5))
    table = only(tmp_path).record().table
    assert table.q.tolist() == [1.0] * 5


def test_a_table_goes_with_the_record_that_it_is_of(tmp_path: Path) -> None:
    autosave = Autosave(OPENED, tmp_path)
    autosave.offer(at(1), learned(np.ones(5)))
    autosave.offer(at(2))
    autosave.close()
    assert (digest(tmp_path), only(tmp_path).record().table) == ("", None)


def test_starting_again_begins_another_session(tmp_path: Path) -> None:
    autosave = Autosave(OPENED, tmp_path)
    autosave.offer(at(4))
    autosave.begin_anew(OPENED)
    autosave.close()
    assert only(tmp_path).step == 4, "nothing was done in the other one"
    autosave, _ = resumed(only(tmp_path).path, tmp_path)
    autosave.begin_anew(OPENED)
    autosave.offer(at(9))
    autosave.close()
    assert sorted(each.step for each in sessions_in(tmp_path)[0]) == [4, 9]


def test_starting_again_with_other_settings_is_an_action(tmp_path: Path) -> None:
    autosave = Autosave(OPENED, tmp_path)
    autosave.offer(at(4))
    autosave.begin_anew(fresh(recipe("student", seed=8)))
    again = fresh(recipe("student", seed=9))
    autosave.begin_anew(again)
    autosave.offer(after(again, 2))
    autosave.close()
    saved = {(each.step, each.document.lanes[0].seed) for each in sessions_in(tmp_path)[0]}
    assert saved == {(4, 0), (2, 9)}, "a session in which nothing was done yet gives way"


def test_a_named_session_stays_when_it_starts_again(tmp_path: Path) -> None:
    autosave = Autosave(OPENED, tmp_path)
    autosave.save_as("evening")
    autosave.begin_anew(OPENED)
    autosave.offer(at(2))
    autosave.close()
    saved = {(each.title, each.step) for each in sessions_in(tmp_path)[0]}
    assert saved == {("evening", 0), ("A student's evening", 2)}


def test_going_on_in_a_copy_on_purpose(tmp_path: Path) -> None:
    kept(tmp_path, at(3))
    autosave, opened = resumed(only(tmp_path).path, tmp_path)
    autosave.become_copy()
    autosave.offer(after(opened, 5))
    autosave.close()
    assert sorted(each.step for each in sessions_in(tmp_path)[0]) == [3, 5]


def test_a_folder_that_is_a_file_is_named(tmp_path: Path) -> None:
    (tmp_path / "sessions").write_text("")
    autosave = kept(tmp_path / "sessions", OPENED, at(1))
    assert notices_of(autosave) == [
        f"this session is not being saved: {tmp_path / 'sessions'}: Not a directory"
    ]
    assert (tmp_path / "sessions").read_text() == ""


def test_a_full_disk_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The system reports the cause, but not the file."""

    def full(descriptor: int) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr("rl_tui.common.files.os.fsync", full)
    (notice,) = notices_of(kept(tmp_path, OPENED, at(1)))
    assert notice.startswith(f"this session is not being saved: {tmp_path}")
    assert notice.endswith(".json: No space left on device")
    assert os.listdir(tmp_path) == []


def test_the_home_of_nobody_is_not_made(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def homeless(*_: object, **__: object) -> None:
        raise RuntimeError("could not determine the home directory")

    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("RL_TUI_SESSIONS_DIR")
    monkeypatch.setattr("rl_tui.live.sessions.place.platformdirs.user_state_path", homeless)
    autosave = kept(session_folder(), OPENED, at(1))
    (notice,) = notices_of(autosave)
    assert notice == (
        "this session is not being saved: there is no home folder; set HOME or RL_TUI_SESSIONS_DIR"
    )
    assert os.listdir(tmp_path) == []


def test_a_folder_that_is_gone_is_no_reason_to_fail(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    gone = tmp_path / "gone"
    gone.mkdir()
    monkeypatch.chdir(gone)
    gone.rmdir()
    autosave = kept(Path("sessions"), OPENED, at(1))
    (notice,) = notices_of(autosave)
    assert notice == "this session is not being saved: sessions: No such file or directory"


def test_a_link_in_the_place_of_the_draft_is_not_followed(tmp_path: Path) -> None:
    path, victim = tmp_path / "session.json", tmp_path / "victim"
    victim.write_text("untouched")
    draft_of(path).symlink_to(victim)
    with pytest.raises(OSError, match="symbolic links"):
        write_atomically(path, b"new")
    assert victim.read_text() == "untouched"
    write_atomically(path, b"new")
    assert path.read_bytes() == b"new"


def test_where_no_thread_can_be_started_it_says_so_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(thread: threading.Thread) -> None:
        raise RuntimeError("can't start new thread")

    autosave = Autosave(OPENED, tmp_path)
    notices = notices_of(autosave)
    with monkeypatch.context() as patch:
        patch.setattr(threading.Thread, "start", refuse)
        autosave.offer(at(1))
        autosave.offer(at(2))
    assert notices == ["this session is not being saved: can't start new thread"]
    autosave.offer(at(3))
    autosave.close()
    assert only(tmp_path).step == 3
    assert notices[1:] == ["this session is being saved again"]


def test_what_is_kept_is_the_last_session_that_is_on_the_disk(tmp_path: Path) -> None:
    autosave = Autosave(OPENED, tmp_path)
    assert autosave.kept is None
    autosave.offer(at(4))
    autosave.write_due()
    (first,), _ = sessions_in(tmp_path)
    assert autosave.kept == ("A student's evening", 4, first.path)
    autosave.begin_anew(fresh(recipe("student", seed=8)))
    autosave.write_due()
    assert autosave.kept == ("A student's evening", 4, first.path), "nothing was done since"
    autosave.save_as("evening")
    assert autosave.kept == ("evening", 0, tmp_path / "evening.json")
    (tmp_path / "evening.json").unlink()
    assert autosave.kept
    assert autosave.kept.step == 4
    autosave.close()


def test_where_nothing_can_be_written_nothing_is_kept(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way", encoding="utf-8")
    assert kept(tmp_path / "file", at(2)).kept is None
