"""A replay reaches the run's exact state."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any
from unittest.mock import patch

import pytest
from click.testing import CliRunner, Result
from hypothesis import given, settings
from hypothesis import strategies as st
from recipes import recipe
from session_samples import after, fresh

from rl_tui.commands.main import program
from rl_tui.common.errors import UserError
from rl_tui.live.record import Record
from rl_tui.live.sessions.replay import replay_target, replayed
from rl_tui.live.sessions.session import digest_of, encoded, read_session
from rl_tui.runs.recipe import JournalEntry, SetParameter, TakeAction
from rl_tui.runs.run import Run
from rl_tui.runs.timeline.branches import Branch, RunRecord
from rl_tui.runs.training.compile_or_interpret import Patience
from rl_tui.runs.training.seeded_runs import Goal, train

ALPHA = JournalEntry(12, SetParameter("alpha", 0.5))
EPSILON = JournalEntry(60, SetParameter("epsilon", 0.0))
GREEDY = JournalEntry(40, SetParameter("epsilon", 0.0))
FIRST = Branch("1", (ALPHA, EPSILON), end=90, here=80)
FORKED = Branch("2", (ALPHA, GREEDY), 0, 40, 120, 110)
TREE = Record(
    (
        RunRecord(recipe("student", seed=3), (FIRST, FORKED), 1),
        RunRecord(recipe("student", seed=3, alpha=0.9), (replace(FIRST, journal=()),)),
    )
)


def followed(lane: RunRecord, branch: Branch) -> Run:
    run = Run(lane.recipe)
    run.follow(branch.journal, branch.here)
    return run


def saved(path: Path, record: Record = TREE, digest: str | None = None) -> Path:
    lane = record.lanes[record.shown]
    right = digest_of(followed(lane, lane.branches[lane.branch]).learner.q)
    path.write_bytes(encoded(record, title="evening", kept=True, digest=right if digest is None else digest))
    return path


def replay(*args: object) -> Result:
    return CliRunner().invoke(program, ["replay", *map(str, args)])


def figures(*args: object) -> dict[str, Any]:
    result = replay(*args, "--json")
    assert (result.exit_code, result.stderr) == (0, "")
    document: dict[str, Any] = json.loads(result.stdout)
    return document


@pytest.mark.parametrize(("lane", "branch"), [(0, 0), (0, 1), (1, 0)])
def test_every_branch_of_every_lane_is_what_follow_makes_of_it(lane: int, branch: int) -> None:
    chosen = TREE.lanes[lane].branches[branch]
    run, _ = replayed(replay_target(TREE, lane + 1, chosen.name))
    straight = followed(TREE.lanes[lane], chosen)
    assert (run.step, run.journal) == (straight.step, straight.journal)
    assert run.learner.q.tobytes() == straight.learner.q.tobytes()


def test_what_is_set_at_the_step_of_an_action_comes_after_it() -> None:
    journal = [JournalEntry(5, TakeAction(0)), JournalEntry(5, SetParameter("alpha", 0.5))]
    trained, straight = Run(recipe("frozenlake")), Run(recipe("frozenlake"))
    train(trained, Goal(steps=20), journal=journal)
    straight.follow(journal, 20)
    assert trained.journal == straight.journal == (journal[0], replace(journal[1], step=6))
    assert trained.learner.q.tobytes() == straight.learner.q.tobytes()


def test_training_refuses_an_action_after_the_end() -> None:
    journal = [JournalEntry(10, TakeAction(0))]
    run = Run(recipe("bandit"), episode_limit=10)
    with pytest.raises(UserError, match="the run is over: no step can be taken"):
        train(run, Goal(steps=20), journal=journal)


@settings(max_examples=25, deadline=None)
@given(st.lists(st.integers(0, 100), max_size=5), st.integers(0, 120), st.integers(1, 150))
def test_how_it_is_cut_makes_no_difference(steps: list[int], step: int, chunk: int) -> None:
    journal = [
        JournalEntry(at, SetParameter("alpha", 0.1 + number / 10)) for number, at in enumerate(sorted(steps))
    ]
    run, straight = Run(recipe("student")), Run(recipe("student"))
    with patch.object(Patience, "chunk", lambda *_: chunk):
        train(run, Goal(steps=step), journal=journal)
    straight.follow(journal, step)
    assert (run.step, run.journal) == (straight.step, straight.journal)
    assert run.learner.q.tobytes() == straight.learner.q.tobytes()


def test_what_is_meant_where_nothing_is_said() -> None:
    target = replay_target(TREE)
    assert (target.number, target.branch.name, target.left) == (0, "2", True)
    assert not replay_target(TREE, branch="1").left
    assert not replay_target(TREE, lane=2).left
    with pytest.raises(UserError, match="there is no run 3: the session has 2 runs"):
        replay_target(TREE, lane=3)
    with pytest.raises(UserError, match='run 1 has no branch "x": its branches are 1, 2'):
        replay_target(TREE, branch="x")


def test_figures_as_json(tmp_path: Path) -> None:
    path = saved(tmp_path / "a.json")
    replayed = figures(path)
    assert (replayed["session"], replayed["lane"], replayed["branch"], replayed["steps"]) == (
        str(path),
        1,
        "2",
        110,
    )
    assert replayed["journal"] == [
        {"step": 12, "name": "alpha", "value": 0.5},
        {"step": 40, "name": "epsilon", "value": 0.0},
    ]
    assert replayed["scenario"] == "student"
    run = followed(TREE.lanes[0], FORKED)
    assert [q for row in replayed["q"] for q in row if q is not None] == run.learner.q.tolist()
    assert figures(path, "--branch", "1")["steps"] == 80
    assert figures(path, "--lane", "2")["hyperparameters"]["alpha"] == 0.9


def test_it_is_the_run_of_train(tmp_path: Path) -> None:
    path = saved(tmp_path / "a.json", after(fresh(recipe("student", seed=5)), 3000))
    trained = CliRunner().invoke(program, ["train", "student", "--seed", "5", "--steps", "3000", "--json"])
    expected, replayed = json.loads(trained.stdout), figures(path)
    for name in ("session", "lane", "branch", "journal"):
        del replayed[name]
    for each in (expected, replayed):
        del each["seconds"], each["steps_per_second"]
    assert replayed == expected


def test_the_report_for_people(tmp_path: Path) -> None:
    result = replay(saved(tmp_path / "a.json"))
    assert result.exit_code == 0
    assert result.stdout.startswith("evening, run 1 of 2, 2 of 2, at step 110\n")
    assert "after 12  alpha    0.5\n" in result.stdout
    assert "expected return" in result.stdout


def test_without_changes_the_report_has_no_list_of_them(tmp_path: Path) -> None:
    result = replay(saved(tmp_path / "a.json", after(fresh(recipe("student")), 30)))
    assert result.exit_code == 0
    assert "changed" not in result.stdout


def test_episodes_as_csv(tmp_path: Path) -> None:
    path, rows = saved(tmp_path / "a.json"), tmp_path / "rows.csv"
    replayed = figures(path, "--csv", rows)
    lines = rows.read_text(encoding="utf-8").splitlines()
    assert lines[0] == "run,episode,return,length"
    assert len(lines) == replayed["episodes"] + 1
    both = replay(path, "--csv", "-", "--json")
    assert both.exit_code == 2
    assert "both write to stdout" in both.stderr
    out = replay(path, "--csv", "-")
    assert out.stdout.splitlines() == lines
    assert "at step 110" in out.stderr


def test_a_session_is_never_written_over_by_its_episodes(tmp_path: Path) -> None:
    path = saved(tmp_path / "a.json")
    before = path.read_bytes()
    (tmp_path / "link.csv").symlink_to(path)
    for csv in (path, tmp_path / "link.csv"):
        result = replay(path, "--csv", csv)
        assert (result.exit_code, result.stdout) == (2, "")
        assert "--csv names the session file: choose another file" in result.stderr
        assert path.read_bytes() == before


def test_other_bits_are_a_warning(tmp_path: Path) -> None:
    path = saved(tmp_path / "a.json", digest="0" * 64)
    result = replay(path, "--json")
    assert result.exit_code == 0
    assert result.stderr.count("\n") == 1
    assert "Q differs from the saved one" in result.stderr
    assert json.loads(result.stdout)["steps"] == 110
    assert replay(path, "--branch", "1", "--json").stderr == ""


def test_a_faulty_file_is_one_line(tmp_path: Path) -> None:
    path = tmp_path / "half.json"
    path.write_bytes(encoded(TREE)[:-40])
    for command in ("replay", "screenshot"):
        args = [command, str(path)] + (["--out", "-"] if command == "screenshot" else [])
        result = CliRunner().invoke(program, args)
        assert (result.exit_code, result.stdout) == (1, "")
        assert result.stderr == f"rl-tui: {path}: incomplete or damaged; open an earlier copy\n"


def test_a_session_takes_no_options_of_a_run(tmp_path: Path) -> None:
    path = saved(tmp_path / "a.json")
    result = CliRunner().invoke(program, ["screenshot", str(path), "--out", "-", "--alpha", "0.5"])
    assert result.exit_code == 2
    assert "a session has its own settings" in result.stderr


def test_a_run_that_does_not_come_so_far(tmp_path: Path) -> None:
    spent = after(fresh(recipe("bandit")), 5000)  # its budget is 1,000 pulls
    path = tmp_path / "a.json"
    path.write_bytes(encoded(spent))
    assert read_session(path).step == 5000
    line = f"rl-tui: {path}: the run ends at step 1,000, but it was saved at step 5,000\n"
    assert replay(path).stderr == line


@pytest.mark.screen
def test_a_change_that_cannot_be_made_names_the_file(tmp_path: Path) -> None:
    path = tmp_path / "a.json"
    path.write_bytes(encoded(after(fresh(recipe("student")), 5, (2, TakeAction(7)))))
    why = "action 7 is not available in state Phone\n"
    assert replay(path).stderr == f"rl-tui: {path}: 2:take=action 7: {why}"
    line = f"rl-tui: {path}: {why}"
    shown = CliRunner().invoke(program, ["screenshot", str(path), "--out", "-"])
    assert (shown.exit_code, shown.stdout, shown.stderr) == (1, "", line)


def test_a_step_that_a_person_took_is_named(tmp_path: Path) -> None:
    path = tmp_path / "a.json"
    path.write_bytes(encoded(after(fresh(recipe("student")), 5, (0, TakeAction(0)))))
    assert figures(path)["journal"] == [{"step": 0, "name": "take", "value": "study"}]
    assert "after 0  take     study\n" in replay(path).stdout
