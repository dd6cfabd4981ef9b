"""Session files load unchanged or are refused."""

from __future__ import annotations

import json
import os
import stat
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from recipes import recipe
from session_samples import after, fresh, records

from rl_tui.common import files as atomic_file
from rl_tui.common.errors import UserError
from rl_tui.common.files import write_atomically
from rl_tui.common.limits import LARGEST_SESSION
from rl_tui.live.record import LearnedTable, Record
from rl_tui.live.sessions.document import MOST_PAIRS_KEPT
from rl_tui.live.sessions.session import (
    SessionError,
    StoredSession,
    checksum_of,
    digest_of,
    encoded,
    read_session,
)
from rl_tui.runs.recipe import JournalEntry, SetParameter, SwitchAlgorithm, TakeAction
from rl_tui.runs.timeline.branches import Branch, RunRecord

SOUND = after(
    fresh(recipe("student", seed=3)),
    40,
    (12, SetParameter("alpha", 0.5)),
    (12, SwitchAlgorithm("sarsa")),
    (30, TakeAction(1)),
)


def stored(path: Path, record: Record = SOUND, **how: Any) -> StoredSession:
    path.write_bytes(encoded(record, **how))
    return read_session(path)


def same_scenario(record: Record, like: Record) -> Record:
    """Return the record with the scenario of the original: scenarios are equal only to themselves."""
    scenario = like.lanes[0].recipe.scenario
    lanes = (replace(lane, recipe=replace(lane.recipe, scenario=scenario)) for lane in record.lanes)
    return replace(record, lanes=tuple(lanes))


def rewritten(path: Path, **changes: Any) -> None:
    fields = json.loads(encoded(SOUND))
    del fields["checksum"]
    fields.update(changes)
    path.write_text(json.dumps({**fields, "checksum": checksum_of(fields)}), encoding="utf-8")


def lane(**changes: Any) -> list[Any]:
    fields = json.loads(encoded(SOUND))["lanes"][0]
    return [{**fields, **changes}]


def branch(**changes: Any) -> list[Any]:
    fields = json.loads(encoded(SOUND))["lanes"][0]["branches"][0]
    return lane(branches=[{**fields, **changes}])


def fault(path: Path) -> str:
    before = path.read_bytes() if path.is_file() else b""
    with pytest.raises(SessionError) as refused:
        read_session(path).record()
    assert path.name in str(refused.value)
    assert "\n" not in str(refused.value)
    assert not path.is_file() or path.read_bytes() == before
    return str(refused.value)


@settings(max_examples=60, deadline=None)
@given(records())
def test_what_goes_in_comes_out(tmp_path_factory: pytest.TempPathFactory, record: Record) -> None:
    path = tmp_path_factory.getbasetemp() / "any.json"
    assert same_scenario(stored(path, record).record(), record) == record


@settings(max_examples=60, deadline=None)
@given(
    st.lists(st.tuples(st.floats(allow_nan=False, allow_infinity=False), st.integers(0, 10**15)), max_size=9),
    st.integers(0, 10**15),
    st.integers(0, 10**12),
)
def test_a_table_comes_out_to_the_last_bit(
    tmp_path_factory: pytest.TempPathFactory, pairs: list[tuple[float, int]], episodes: int, state: int
) -> None:
    path = tmp_path_factory.getbasetemp() / "any.json"
    q, visits = np.array([each[0] for each in pairs]), np.array([each[1] for each in pairs], np.int64)
    record = replace(SOUND, table=LearnedTable(q, visits, episodes, state))
    table = stored(path, record).record().table
    assert (table.q.dtype, table.q.tobytes()) == (np.dtype(float), q.tobytes())
    assert (table.visits.dtype, table.visits.tolist()) == (np.dtype(np.int64), visits.tolist())
    assert (table.episodes, table.state) == (episodes, state)


@pytest.mark.parametrize("hidden", [None, True, False])
def test_whether_the_answer_is_hidden_is_kept_where_somebody_has_said(
    tmp_path: Path, hidden: bool | None
) -> None:
    record = replace(SOUND, answer_is_hidden=hidden)
    assert json.loads(encoded(record)).get("answer_hidden") is hidden
    assert ("answer_hidden" in json.loads(encoded(record))) is (hidden is not None)
    assert stored(tmp_path / "a.json", record).record().answer_is_hidden is hidden


def test_a_session_need_not_have_a_table(tmp_path: Path) -> None:
    assert "table" not in json.loads(encoded(SOUND))
    assert stored(tmp_path / "a.json").record().table is None


@pytest.mark.parametrize("q", [np.zeros(MOST_PAIRS_KEPT + 1), np.array([1.0, np.nan]), np.array([np.inf])])
def test_a_large_table_and_one_that_ran_away_are_left_out(tmp_path: Path, q: np.ndarray) -> None:
    record = replace(SOUND, table=LearnedTable(q, np.zeros(len(q), np.int64), 0, 0))
    assert stored(tmp_path / "a.json", record).document.table is None


def test_the_largest_table_that_is_kept_can_be_read(tmp_path: Path) -> None:
    q = np.full(MOST_PAIRS_KEPT, -1.2345678901234567e-300)
    table = LearnedTable(q, np.full(len(q), 10**15), episodes=10**15, state=MOST_PAIRS_KEPT)
    session = stored(tmp_path / "a.json", replace(SOUND, table=table))
    assert session.path.stat().st_size < 150_000
    assert session.record().table is not None


def test_the_world_comes_out_of_the_file_alone(tmp_path: Path) -> None:
    scenario = stored(tmp_path / "a.json").record().lanes[0].recipe.scenario
    assert (scenario.id, scenario.title) == ("student", SOUND.lanes[0].recipe.scenario.title)
    assert scenario.text == SOUND.lanes[0].recipe.scenario.text
    assert scenario.defaults == SOUND.lanes[0].recipe.scenario.defaults


def test_an_environment_of_gymnasium_is_kept_by_its_id(tmp_path: Path) -> None:
    record = fresh(recipe("gym:FrozenLake-v1"))
    session = stored(tmp_path / "a.json", record)
    assert session.document.scenario.text == ""
    assert session.record().lanes[0].recipe.scenario.id == "gym:FrozenLake-v1"


def test_facts_of_a_session(tmp_path: Path) -> None:
    session = stored(tmp_path / "a.json", title="my evening", kept=True)
    assert (session.title, session.step, session.algorithm) == ("my evening", 40, "sarsa")
    assert session.changes == 3
    assert stored(tmp_path / "b.json").title == SOUND.lanes[0].recipe.scenario.title


def test_what_branches_share_is_written_once(tmp_path: Path) -> None:
    first = SOUND.lanes[0].branches[0]
    other = Branch("2", (*first.journal[:2], JournalEntry(25, SetParameter("epsilon", 0.0))), 0, 25, 90, 20)
    forked = Record((RunRecord(SOUND.lanes[0].recipe, (first, other), 1),))
    session = stored(tmp_path / "a.json", forked)
    written = session.document.lanes[0].branches[1]
    assert (written.shared, len(written.journal)) == (2, 1)
    assert session.changes == 4
    assert session.algorithm == "sarsa"  # from the part that it shares
    assert same_scenario(session.record(), forked) == forked


def test_the_algorithm_is_the_one_in_force_where_it_stands(tmp_path: Path) -> None:
    rewound = replace(SOUND.lanes[0].branches[0], here=11)
    record = Record((replace(SOUND.lanes[0], branches=(rewound,)),))
    assert stored(tmp_path / "a.json", record).algorithm == "q-learning"


@pytest.mark.parametrize(
    ("content", "line"),
    [
        (b"", "is empty"),
        (b"hello", "not JSON"),
        (b"\xff\xfe", "not JSON"),
        (b"[1, 2]", "not a session; choose a file that rl-tui saved"),
        (b'{"format": "something else"}', "not a session; choose a file that rl-tui saved"),
        (b"{" * 100_000, "not JSON"),
        (b'{"a": NaN}', "not JSON"),
        (b'{"format": "rl-tui session", "version": 3}', "newer rl-tui (file format 3, not 2); update"),
        (b'{"format": "rl-tui session", "version": 1}', "damaged or edited (wrong checksum)"),
    ],
)
def test_a_file_that_is_no_session(tmp_path: Path, content: bytes, line: str) -> None:
    path = tmp_path / "a.json"
    path.write_bytes(content)
    assert line in fault(path)


def test_a_file_that_is_not_there(tmp_path: Path) -> None:
    assert "no such file" in fault(tmp_path / "a.json")
    assert "a folder" in fault(tmp_path)


def test_a_file_that_is_too_large(tmp_path: Path) -> None:
    path = tmp_path / "a.json"
    with path.open("wb") as stream:
        stream.truncate(LARGEST_SESSION + 1)
    with pytest.raises(SessionError, match="at most 64 MB"):
        read_session(path)


def test_every_truncation_is_told(tmp_path: Path) -> None:
    whole, path = encoded(SOUND), tmp_path / "a.json"
    for length in range(1, len(whole), 41):
        path.write_bytes(whole[:length])
        message = fault(path)
        assert ("incomplete or damaged" if length > 40 else "not JSON") in message


def test_every_flipped_byte_is_told(tmp_path: Path) -> None:
    whole, path = encoded(SOUND), tmp_path / "a.json"
    for place in range(0, len(whole), 97):
        flipped = bytearray(whole)
        flipped[place] ^= 0x01
        path.write_bytes(flipped)
        with pytest.raises(SessionError):
            read_session(path)


def test_an_edited_file_is_told(tmp_path: Path) -> None:
    path = tmp_path / "a.json"
    path.write_bytes(encoded(SOUND).replace(b'"seed": 3', b'"seed": 4'))
    assert "damaged or edited" in fault(path)


@pytest.mark.parametrize(
    ("changes", "line"),
    [
        ({"colour": "red"}, "colour"),
        ({"shown": 1}, "there is no run 1"),
        ({"lanes": []}, "lanes"),
        ({"lanes": lane() * 5}, "lanes"),
        ({"lanes": lane(seed=-1)}, "lanes[0].seed"),
        ({"lanes": lane(seed=True)}, "lanes[0].seed"),
        ({"lanes": lane(branch=1)}, "there is no branch 1"),
        ({"lanes": lane(algorithm="q-lerning")}, 'lanes[0].algorithm is "q-lerning"'),
        ({"lanes": lane(hyperparameters={"alpha": 7})}, "alpha is 7"),
        ({"lanes": lane(hyperparameters={"alfa": 0.1})}, 'did you mean "alpha"'),
        ({"lanes": branch(name="\x1b[2J")}, "lanes[0].branches[0].name: U+001B is a control character"),
        ({"lanes": branch(name="x" * 81)}, "lanes[0].branches[0].name"),
        ({"lanes": branch(parent=0)}, "parent"),
        ({"lanes": branch(shared=1)}, "shared is 1"),
        ({"lanes": branch(here=41)}, "after the last step"),
        ({"lanes": branch(end=10**15 + 1)}, "lanes[0].branches[0].end"),
        ({"lanes": branch(journal=[{"step": 9, "take": 1}, {"step": 8, "take": 1}])}, "out of order"),
        ({"lanes": branch(journal=[{"step": 41, "take": 1}])}, "beyond the end of the branch"),
        ({"lanes": branch(journal=[{"step": 4}])}, "journal[0]: not a change"),
        ({"lanes": branch(journal=[{"step": 4, "set": "alpha"}])}, "journal[0]: not a change"),
        ({"lanes": branch(journal=[{"step": 4, "set": "alpha", "to": 2}])}, "expected a number in (0, 1]"),
        ({"lanes": branch(journal=[{"step": 4, "algorithm": "magic"}])}, "which is not known"),
        ({"lanes": branch(journal=[{"step": "4", "take": 1}])}, "journal[0].step"),
        (
            {"scenario": {"id": "x", "kind": "file", "title": "", "text": "[mdp]"}},
            "the scenario in it cannot",
        ),
        ({"scenario": {"id": "gym:No-v0", "kind": "gymnasium", "title": ""}}, "gym:No-v0"),
        ({"saved": "yesterday"}, "saved"),
        ({"saved": "0001-01-01T00:00:00+23:00"}, "saved"),
        ({"speed": 0}, "speed"),
        ({"answer_hidden": 1}, "answer_hidden"),
        ({"digest": "abc"}, "digest"),
        ({"title": "a\nb"}, "title: U+000A is a control character"),
    ],
)
def test_a_file_whose_parts_do_not_fit(tmp_path: Path, changes: dict[str, Any], line: str) -> None:
    path = tmp_path / "a.json"
    rewritten(path, **changes)
    assert line in fault(path)


def test_a_scenario_without_a_file_cannot_be_saved() -> None:
    made_from = recipe("student")
    nameless = replace(made_from, scenario=replace(made_from.scenario, text=""))
    with pytest.raises(UserError, match="the file of scenario student is not known"):
        encoded(fresh(nameless))


def test_a_digest_tells_tables_apart_to_the_last_bit() -> None:
    q = np.linspace(0.0, 1.0, 12)
    assert digest_of(q) == digest_of(q.copy())
    assert digest_of(q) != digest_of(np.nextafter(q, 2.0))
    assert digest_of(np.zeros(100_001)) == ""


def test_a_file_is_its_owners_alone(tmp_path: Path) -> None:
    path = tmp_path / "a.json"
    write_atomically(path, b"one")
    write_atomically(path, b"two")
    assert path.read_bytes() == b"two"
    assert stat.S_IMODE(path.stat().st_mode) == 0o600
    assert [each.name for each in tmp_path.iterdir()] == ["a.json"]


@pytest.mark.parametrize("failing", ["fsync", "replace"])
def test_a_failing_write_leaves_the_old_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, failing: str
) -> None:
    path = tmp_path / "a.json"
    write_atomically(path, b"one")

    def fail(*_: object) -> None:
        raise OSError(28, "No space left on device")

    if failing == "fsync":
        monkeypatch.setattr(atomic_file.os, "fsync", fail)
    else:
        monkeypatch.setattr(Path, "replace", fail)
    with pytest.raises(OSError, match="No space left"):
        write_atomically(path, b"two")
    assert path.read_bytes() == b"one"
    assert os.listdir(tmp_path) == ["a.json"]
