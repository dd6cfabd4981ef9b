"""The folder of sessions."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

import pytest
from autosaving import OPENED, at, kept, notices_of, only
from session_samples import after

from rl_tui.common.errors import UserError
from rl_tui.common.files import FileLock, draft_of
from rl_tui.live.record import Record
from rl_tui.live.sessions import session as folder
from rl_tui.live.sessions.autosave import Autosave
from rl_tui.live.sessions.session import (
    MOST_UNNAMED,
    SUFFIX,
    encoded,
    file_stem,
    files_in,
    named_path,
    prune,
    read_session,
    remove,
    sessions_in,
)
from rl_tui.runs.recipe import SetParameter


def back_at(step: int, record: Record) -> Record:
    lane = record.lanes[0]
    branch = replace(lane.branches[0], here=step)
    return replace(record, lanes=(replace(lane, branches=(branch,)),))


def test_saving_under_a_name(tmp_path: Path) -> None:
    autosave = Autosave(OPENED, tmp_path)
    autosave.offer(at(4))
    autosave.write_due()
    assert len(sessions_in(tmp_path)[0]) == 1
    path = autosave.save_as("My evening!")
    assert path == tmp_path / "my-evening.json"
    assert [each.path for each in sessions_in(tmp_path)[0]] == [path], (
        "the unnamed one is not needed any more"
    )
    autosave.offer(at(6))
    autosave.close()
    session = only(tmp_path)
    assert (session.title, session.step, session.document.kept) == ("My evening!", 6, True)


def test_saving_before_anything_was_done(tmp_path: Path) -> None:
    autosave = Autosave(OPENED, tmp_path)
    autosave.save_as("start")
    autosave.close()
    assert only(tmp_path).step == 0


def test_a_named_session_stays_when_it_is_saved_under_another_name(tmp_path: Path) -> None:
    autosave = Autosave(OPENED, tmp_path)
    autosave.save_as("one")
    autosave.offer(at(2))
    autosave.save_as("two")
    autosave.save_as("two")
    autosave.close()
    assert {each.title: each.step for each in sessions_in(tmp_path)[0]} == {"one": 0, "two": 2}


def test_a_taken_name_is_refused(tmp_path: Path) -> None:
    first = Autosave(OPENED, tmp_path)
    first.save_as("evening")
    first.close()
    before = (tmp_path / "evening.json").read_bytes()
    other = Autosave(OPENED, tmp_path)
    other.offer(at(9))
    with pytest.raises(UserError, match="another session is called Evening"):
        other.save_as("Evening")
    other.close()
    assert (tmp_path / "evening.json").read_bytes() == before


@pytest.mark.parametrize("name", ["", "  ", "a\nb", "x" * 81])
def test_what_is_no_name(tmp_path: Path, name: str) -> None:
    with pytest.raises(UserError):
        named_path(tmp_path, name)


def test_no_name_leads_out_of_the_folder() -> None:
    assert file_stem("../../etc/passwd") == "etc-passwd"
    assert file_stem("gym:FrozenLake-v1") == "gym-frozenlake-v1"
    assert file_stem("Größe 2") == "größe-2"
    assert file_stem("!!!") == "session"


@pytest.mark.parametrize("letter", ["漢", "𝒜", "İ"])
def test_the_longest_name_is_not_too_long_for_a_file(tmp_path: Path, letter: str) -> None:
    autosave = Autosave(OPENED, tmp_path)
    autosave.save_as(letter * 80)
    autosave.close()
    assert only(tmp_path).title == letter * 80


def test_the_newest_unnamed_sessions_are_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(folder, "MOST_UNNAMED", 3)
    for number in range(7):
        path = tmp_path / f"student-{number}.json"
        path.write_bytes(encoded(at(number + 1), title="named" * (number == 0), kept=number == 0))
        os.utime(path, ns=(number, number))
    (tmp_path / "broken.json").write_text("{", encoding="utf-8")
    held = FileLock(tmp_path / "student-1.json")
    assert held.acquire()
    prune(tmp_path)
    held.release()
    left = sorted(each.name for each in tmp_path.iterdir())
    assert left == ["broken.json", *(f"student-{number}.json" for number in (0, 1, 4, 5, 6))]


def test_what_cannot_be_pruned_is_no_reason_to_keep_nothing_new(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    unlink = Path.unlink

    def refuse(path: Path, missing_ok: bool = False) -> None:
        if path.suffix == ".json":
            raise PermissionError(1, "Operation not permitted", str(path))
        unlink(path, missing_ok)

    monkeypatch.setattr(folder, "MOST_UNNAMED", 0)
    monkeypatch.setattr(Path, "unlink", refuse)
    (tmp_path / "old.json").write_bytes(encoded(at(1)))
    assert notices_of(kept(tmp_path, at(2))) == []
    assert sorted(each.step for each in sessions_in(tmp_path)[0]) == [1, 2]
    assert len(os.listdir(tmp_path)) == 2, "every lock is given back"


def test_a_session_that_was_gone_on_with_meanwhile_is_not_pruned(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "old.json"
    path.write_bytes(encoded(at(1)))
    before = sessions_in(tmp_path)
    path.write_bytes(encoded(at(200), title="evening", kept=True))
    monkeypatch.setattr(folder, "MOST_UNNAMED", 0)
    monkeypatch.setattr(folder, "all_sessions_in", lambda _: before)
    prune(tmp_path)
    assert read_session(path).step == 200


def test_one_in_which_nothing_was_done_is_none(tmp_path: Path) -> None:
    changed = after(OPENED, 0, (0, SetParameter("alpha", 0.5)))
    (tmp_path / "blank.json").write_bytes(encoded(changed))
    (tmp_path / "named.json").write_bytes(encoded(changed, title="lesson", kept=True))
    (tmp_path / "copy.json").write_bytes(encoded(changed, title="lesson (copy)"))
    (tmp_path / "gone-back.json").write_bytes(encoded(back_at(0, at(3))))
    listed = {session.path.name for session in sessions_in(tmp_path)[0]}
    assert listed == {"named.json", "copy.json", "gone-back.json"}
    held = FileLock(tmp_path / "blank.json")
    assert held.acquire()
    prune(tmp_path)
    assert len(files_in(tmp_path)) == 4, "somebody has it open"
    held.release()
    prune(tmp_path)
    assert {path.name for path in files_in(tmp_path)} == listed


def test_what_a_kill_left_half_written_is_taken_away(tmp_path: Path) -> None:
    for name in ("killed", "writing", "held"):
        draft = draft_of(tmp_path / f"{name}.json")
        draft.write_bytes(b"{")
        if name != "writing":
            os.utime(draft, ns=(0, 0))
    foreign = tmp_path / ".profile.new"
    foreign.write_bytes(b"somebody else's")
    os.utime(foreign, ns=(0, 0))
    held = FileLock(tmp_path / "held.json")
    assert held.acquire()
    kept(tmp_path, at(2))
    held.release()
    drafts = sorted(path.name for path in tmp_path.glob(f".*{SUFFIX}.new"))
    assert drafts == [".held.json.new", ".writing.json.new"]
    assert len(os.listdir(tmp_path)) == 1 + len(drafts) + 1
    assert foreign.exists()


def test_fifty_are_kept() -> None:
    assert MOST_UNNAMED == 50


def test_removing(tmp_path: Path) -> None:
    autosave = Autosave(OPENED, tmp_path)
    path = autosave.save_as("evening")
    with pytest.raises(UserError, match="evening is open in another program"):
        remove(read_session(path))
    autosave.close()
    remove(read_session(path))
    assert os.listdir(tmp_path) == []
