"""Tables, episodes and new files."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest
from export_samples import recipe_of

from rl_tui.common.errors import UserError
from rl_tui.common.files import free_name, new_path, write_new
from rl_tui.runs.export.tables import estimates_again, q_array, write_q_array, write_q_csv, write_returns
from rl_tui.runs.recipe import JournalEntry, SetParameter
from rl_tui.runs.run import Run

JOURNAL = (JournalEntry(200, SetParameter("epsilon", 0.5)), JournalEntry(300, SetParameter("alpha", 0.4)))


@pytest.fixture(scope="module")
def run() -> Run:
    made = Run(recipe_of("student"), evaluate=False)
    made.follow(JOURNAL, 500)
    return made


def test_q_as_an_array_has_nan_where_nothing_can_be_done(run: Run, tmp_path: Path) -> None:
    space, q = run.world.space, run.learner.q
    path = tmp_path / "q.npy"
    write_q_array(path, space, q)
    table = np.load(path, allow_pickle=False)
    assert (table.shape, table.dtype) == ((space.states, len(space.action_names)), np.float64)
    assert np.count_nonzero(~np.isnan(table)) == space.pairs
    np.testing.assert_array_equal(table, q_array(space, q))
    for pair in range(space.pairs):
        assert table[space.state_of(pair), space.pair_action[pair]] == q[pair]


def test_q_as_csv_names_states_and_actions_and_keeps_all_digits(run: Run, tmp_path: Path) -> None:
    space, q, visits = run.world.space, run.learner.q, run.learner.visits
    path = tmp_path / "q.csv"
    write_q_csv(path, space, q, visits)
    with path.open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert [row["state"] for row in rows] == ["Class", "Phone", "Pass"]  # Sleep is terminal
    cells = {(row["state"], name): row for row in rows for name in space.action_names}
    for pair in range(space.pairs):
        state, action = (
            space.state_names[space.state_of(pair)],
            space.action_names[int(space.pair_action[pair])],
        )
        row = cells.pop((state, action))
        assert float(row[action]) == q[pair]
        assert int(row[f"visits of {action}"]) == visits[pair]
    assert all(row[action] == "" for (_, action), row in cells.items())


def test_returns_are_those_of_every_episode_also_after_changes(run: Run, tmp_path: Path) -> None:
    path = tmp_path / "returns.csv"
    seen: list[tuple[int, int]] = []
    write_returns(
        path, run.recipe, JOURNAL, 500, on_progress=lambda done, wanted: seen.append((done, wanted))
    )
    with path.open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert len(rows) == run.learner.episodes
    assert [int(row["episode"]) for row in rows] == list(range(1, len(rows) + 1))
    last = [float(row["return"]) for row in rows[-100:]]
    assert np.mean(last) == pytest.approx(run.history.last_100[0], abs=1e-12)
    assert seen[-1] == (500, 500)


def test_estimates_done_again_are_the_same_bits(run: Run) -> None:
    q, visits = estimates_again(run.recipe, JOURNAL, 500)
    assert q.tobytes() == run.learner.q.tobytes()
    assert visits.tobytes() == run.learner.visits.tobytes()


def test_a_run_that_broke_down_has_its_episodes(tmp_path: Path) -> None:
    # Accumulating traces with α = 1 run away
    recipe = recipe_of("cliff", algorithm="sarsa-lambda", alpha=1.0, traces="accumulating", **{"lambda": 1.0})
    run = Run(recipe, evaluate=False)
    run.advance(100_000)
    assert run.stop_reason
    path = tmp_path / "returns.csv"
    write_returns(path, recipe, (), run.step)
    assert len(path.read_text(encoding="utf-8").splitlines()) == run.learner.episodes + 1


def test_what_is_broken_off_leaves_no_file(run: Run, tmp_path: Path) -> None:
    def break_off(done: int, wanted: int) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        write_returns(tmp_path / "returns.csv", run.recipe, JOURNAL, 500, on_progress=break_off)
    assert list(tmp_path.iterdir()) == []


def test_nothing_is_written_over(tmp_path: Path) -> None:
    path = tmp_path / "there.txt"
    path.write_text("mine", encoding="utf-8")
    with pytest.raises(UserError, match="already exists"):
        new_path(str(path))
    with pytest.raises(UserError, match="already exists"):
        write_new(path, "other")
    assert path.read_text(encoding="utf-8") == "mine"


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("  ", "type the name of a new file"),
        (".", "is a folder"),
        ("no/such/folder/a.txt", "there is no folder"),
        ("a\x07b", "cannot have control characters"),
        ("a" * 300, "File name too long"),
    ],
)
def test_names_that_cannot_be_are_refused_in_a_line(
    text: str, fault: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(UserError, match=fault) as refused:
        new_path(text)
    assert "\n" not in str(refused.value)


def test_a_folder_that_cannot_be_written_is_told_in_a_line(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"cannot be written \(No such file or directory\)"):
        write_new(tmp_path / "gone" / "a.txt", "text")


@pytest.mark.parametrize(("name", "said"), [("a\0b", r"a\u0000b"), ("a\ud800b", r"a\ud800b")])
def test_a_name_that_no_file_can_have_is_told_in_a_line(name: str, said: str, tmp_path: Path) -> None:
    with pytest.raises(UserError, match="cannot be written") as refused:
        write_new(tmp_path / name, "text")
    assert said in str(refused.value)
    assert str(refused.value).isprintable()


def test_the_name_offered_is_free(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert free_name("gym:CartPole-v1-sarsa", ".py") == "gym-CartPole-v1-sarsa.py"
    Path("frozenlake.py").touch()
    assert free_name("frozenlake", ".py") == "frozenlake-2.py"
