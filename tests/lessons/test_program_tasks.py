"""Tasks that ask for a program."""

from __future__ import annotations

import json
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest
from click.testing import CliRunner
from lessons.lesson_sessions import run_of, write
from lessons.program_tasks import SKELETON, program_lesson, program_text, updating

from rl_tui.commands.main import program
from rl_tui.common.errors import UserError
from rl_tui.lessons.file.schema import LONGEST_PROGRAM
from rl_tui.lessons.file.view import LessonRecord, Passed, TaskView, begun
from rl_tui.lessons.judging.conditions import judged_task
from rl_tui.lessons.judging.judge import TaskJudge
from rl_tui.lessons.judging.seed_panel import judged_program
from rl_tui.lessons.judging.seen_program import read_code, watched_code
from rl_tui.lessons.lesson import lesson_of
from rl_tui.runs.run import Run

pytestmark = pytest.mark.process

LONGEST = 120.0
RIGHT = updating()
RUNS_FOR_EVER = "while True:\n    pass\n"
LATE = updating(more="        if episode > 200 and reward: Q[state][action] = 3.0\n")


def judged(code: str) -> TaskView:
    return judged_program(judged_task(program_lesson(), "write"), code)


def holds(view: TaskView) -> list[bool | None]:
    return [each.holds for each in view.conditions]


def test_a_program_that_is_right_passes_and_is_the_evidence() -> None:
    view = judged(RIGHT)
    assert holds(view) == [True] * 5
    assert view.remarks == ()
    assert (view.passed.page, view.passed.program, view.passed.step) == ("write", RIGHT, 0)


@pytest.mark.exhaustive("watches every wrong program", but=["the wrong cell", "after the end", "no Python"])
@pytest.mark.parametrize(
    ("code", "failing", "told"),
    [
        (updating(cell="Q[next_state][action]"), [3], "line 24: At step"),
        (updating("reward + (0 if terminated else max(Q[next_state]))"), [1], ""),
        (updating("reward + gamma * max(Q[next_state])"), [3], "if terminated else"),
        (
            updating("reward + (0 if terminated or truncated else gamma * max(Q[next_state]))"),
            [3],
            "time limit",
        ),
        (updating("reward + (0 if terminated else gamma * max(Q[state]))"), [0, 3], "max Q(s)"),
        (LATE, [2], "line 24: step"),
        (SKELETON, [0, 1, 2], "the table has not changed yet"),
        (RIGHT.replace("range(400)", "range(299)"), [4], ""),
        (RIGHT.replace("alpha * (", "alhpa * ("), [0, 1, 2, 3, 4], "line 24: NameError"),
        (RIGHT.replace("while not over:", "while not over"), [0, 1, 2, 3, 4], "my_agent.py, line 20"),
    ],
    ids=[
        *("the wrong cell", "γ forgotten", "after the end", "cut off is not ended", "its own state"),
        *("a reward set by hand", "no update", "too few episodes", "a wrong name", "no Python"),
    ],
)
def test_a_program_that_is_wrong_is_told_where(code: str, failing: list[int], told: str) -> None:
    view = judged(code)
    assert [place for place, each in enumerate(holds(view)) if not each] == failing
    assert view.passed is None
    assert told in " ".join(view.remarks)
    assert all("/" not in each for each in view.remarks), "no folder of this machine is named"


def test_a_program_that_never_ends_is_ended() -> None:
    seen = watched_code(RUNS_FOR_EVER, "x.py", seconds=1.0)
    assert "TimeLimit" in seen.error


def test_what_stands_in_a_file_is_bounded(tmp_path: Path) -> None:
    path = tmp_path / "x.py"
    path.write_text("#" * (LONGEST_PROGRAM + 1))
    with pytest.raises(UserError, match=r"^x\.py: found 200,001 characters"):
        read_code(path)
    with pytest.raises(UserError, match=r"^none\.py: no such file"):
        read_code(tmp_path / "none.py")


# In a live run


class News:
    def __init__(self) -> None:
        self.event = threading.Event()

    def __call__(self) -> None:
        self.event.set()


class Watcher:
    def __init__(self) -> None:
        self.news = News()
        self.judge = TaskJudge(self.news, automatic=True)
        self.lesson = program_lesson()
        self.run = Run(judged_task(self.lesson, "write").setup)
        self.record: LessonRecord = begun(self.lesson)

    def view(self) -> TaskView:
        task = self.judge.view(self.record, self.run).task
        assert task is not None
        return task

    def known(self) -> TaskView:
        while self.view().waits:
            assert self.news.event.wait(LONGEST)
            self.news.event.clear()
        return self.view()


@pytest.fixture
def watcher() -> Iterator[Watcher]:
    made = Watcher()
    yield made
    made.judge.close()


def test_it_is_watched_in_a_process_of_its_own(watcher: Watcher, tmp_path: Path) -> None:
    path = tmp_path / "my_agent.py"
    path.write_text(updating("reward + gamma * max(Q[next_state])"))
    assert holds(watcher.view()) == [None] * 5
    watcher.judge.watch(watcher.record, path)
    assert "my_agent.py" in watcher.view().waits
    first = watcher.known()
    assert (holds(first)[3], first.passed) == (False, None)
    assert "if terminated else" in first.remarks[0]
    path.write_text(RIGHT)
    watcher.judge.watch(watcher.record, path)
    second = watcher.known()
    assert second.passed.program == RIGHT
    watcher.record = watcher.record.passes(second.passed)
    assert holds(watcher.view()) == [True] * 5


def test_to_leave_the_page_ends_it(watcher: Watcher, tmp_path: Path) -> None:
    path = tmp_path / "endless.py"
    path.write_text(RUNS_FOR_EVER)
    watcher.judge.watch(watcher.record, path)
    assert watcher.view().waits
    watcher.record = watcher.record.open("after")
    assert watcher.judge.view(watcher.record, watcher.run).task is None
    watcher.record = watcher.record.open("write")
    view = watcher.view()
    assert (view.waits, holds(view)) == ("", [None] * 5)


def test_a_file_that_is_not_there(watcher: Watcher, tmp_path: Path) -> None:
    watcher.judge.watch(watcher.record, tmp_path / "none.py")
    view = watcher.known()
    assert holds(view) == [None] * 5
    assert "no such file" in view.remarks[0]


def test_no_step_passes_it(watcher: Watcher) -> None:
    watcher.run.advance(episodes=5)
    assert watcher.view().passed is None


# Checked and graded


def check(folder: Path, text: str) -> tuple[int, list[str]]:
    path = folder / "yours.toml"
    path.write_text(text, encoding="utf-8")
    result = CliRunner().invoke(program, ["check", str(path)])
    return result.exit_code, [line for line in result.stderr.splitlines() if "warning" not in line]


def test_check_watches_the_attempts(tmp_path: Path) -> None:
    wrong = (SKELETON, updating(cell="Q[next_state][action]"), RIGHT.replace("0.99", "0.9"))
    assert check(tmp_path, program_text(RIGHT, wrong)) == (0, [])
    code, told = check(tmp_path, program_text(wrong[1], (RIGHT,), RIGHT))
    assert code == 1
    assert [line.split(": ")[1] for line in told] == [
        "pages[0].task.program.skeleton",
        "pages[0].task.accepts[0]",
        "pages[0].task.rejects[0]",
    ]


def test_a_file_name_that_leads_elsewhere_is_refused(tmp_path: Path) -> None:
    code, told = check(tmp_path, program_text(RIGHT).replace("my_agent.py", "../my_agent.py"))
    assert code == 1
    assert "pages[0].task.program.file" in told[0]


@pytest.mark.parametrize(
    ("code", "options", "expected"),
    [
        (RIGHT, ["--programs"], (True, True)),
        (SKELETON, ["--programs"], (False, False)),
        (RIGHT, [], (False, False)),
    ],
    ids=["right", "the skeleton", "not asked for"],
)
def test_a_session_holds_the_program_and_is_graded_by_it(
    tmp_path: Path, code: str, options: list[str], expected: tuple[bool, bool]
) -> None:
    file = tmp_path / "yours.toml"
    file.write_text(program_text(RIGHT), encoding="utf-8")
    lesson = lesson_of(file.read_text(encoding="utf-8"), file)
    setup = judged_task(lesson, "write").setup
    record = begun(lesson).passes(Passed("write", setup, program=code))
    path = write(tmp_path, "a.json", record, run_of(setup))
    result = CliRunner().invoke(program, ["grade", str(path), str(file), *options, "--json"])
    report = json.loads(result.stdout)
    assert (report["passed"], report["tasks"][0]["passed"]) == expected
    assert ("sandbox" in result.stderr) == bool(options)


def test_without_being_asked_for_it_says_that_it_was_not_judged(tmp_path: Path) -> None:
    file = tmp_path / "yours.toml"
    file.write_text(program_text(RIGHT), encoding="utf-8")
    lesson = lesson_of(file.read_text(encoding="utf-8"), file)
    setup = judged_task(lesson, "write").setup
    record = begun(lesson).passes(Passed("write", setup, program=RIGHT))
    path = write(tmp_path, "a.json", record, run_of(setup))
    result = CliRunner().invoke(program, ["grade", str(path), str(file)])
    assert "--programs" in result.stdout
    assert CliRunner().invoke(program, ["grade", "x.py", "--scenario", "cliff", "--programs"]).exit_code == 2
