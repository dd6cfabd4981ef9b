"""Grading sessions by a lesson: only the replayed runs count."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from lesson_sessions import TEXT, all_done, digest_at, entries, guess, lesson, run_of, setup, taken, write
from shipped import shipped_lessons

from rl_tui.common.errors import UserError
from rl_tui.lessons.file.view import Given, LessonRecord, Passed, begun
from rl_tui.lessons.judging.seed_panel import passes
from rl_tui.lessons.lesson import Lesson, read_lesson
from rl_tui.live.sessions.grade import GradedSession, LessonGrading, grade_report
from rl_tui.live.sessions.session import SessionError
from rl_tui.runs.recipe import EditWorld, JournalEntry, SetParameter, TakeAction
from rl_tui.runs.timeline.branches import Branch, RunRecord
from rl_tui.worlds.editing.edit import read_edits

LESSON = lesson()
BEGUN = begun(LESSON)
EVENING, LAKE = setup(LESSON), setup(LESSON, "lake")
DRAWN = EditWorld(read_edits("world.cell[1,1]=."))


@pytest.fixture
def grading(tmp_path: Path) -> LessonGrading:
    path = tmp_path / "evening.toml"
    path.write_text(TEXT, encoding="utf-8")
    return LessonGrading(str(path))


def passed(graded: GradedSession) -> list[str]:
    return [task.id for task in graded.tasks if task.passed]


def test_everything_done(grading: LessonGrading, tmp_path: Path) -> None:
    graded = grading.grade(write(tmp_path, "a.json", all_done(LESSON)))
    assert passed(graded) == ["go", "never", "lake"]
    assert graded.passed
    assert graded.predictions == (1, 1, 1)
    assert grade_report(grading.lesson, graded) == {
        "lesson": "evening",
        "passed": True,
        "tasks": [
            {
                "id": "go",
                "passed": True,
                "conditions": [
                    {"text": "two steps by hand", "holds": True},
                    {"text": "two steps in all", "holds": True},
                    {"text": "α is large", "holds": True},
                ],
            },
            {"id": "never", "passed": True, "conditions": [{"text": "a million", "holds": False}]},
            {"id": "lake", "passed": True, "conditions": [{"text": "fifty steps", "holds": True}]},
        ],
        "predictions": {"right": 1, "made": 1, "locked": 1},
        "remarks": [],
    }


def test_nothing_done(grading: LessonGrading, tmp_path: Path) -> None:
    graded = grading.grade(write(tmp_path, "a.json", BEGUN))
    assert passed(graded) == []
    assert graded.predictions == (0, 0, 0)


FORGED = {
    "no run at all": Passed("go", EVENING),
    "steps of the agent": Passed("go", EVENING, (), 2),
    "one step too many": Passed("go", EVENING, taken(0, 1), 3),
    "another seed": Passed("go", replace(EVENING, seed=1), taken(0, 1), 2),
    "another world": Passed("go", replace(LAKE, hyperparameters=EVENING.hyperparameters), taken(0, 1), 2),
    "settings that the task refuses": Passed("go", setup(LESSON, alpha=0.1), taken(0, 1), 2),
    "a change just before": Passed(
        "go", EVENING, (JournalEntry(0, SetParameter("alpha", 0.1)), *taken(0, 1)), 2
    ),
    "a claim": Passed("go", EVENING, claim=True),
    "a program": Passed("go", EVENING, program="print('passed')"),
    "an action that is not there": Passed(
        "go", EVENING, (JournalEntry(0, TakeAction(10**9)), JournalEntry(1, TakeAction(0))), 2
    ),
    "a task that cannot be done": Passed("never", EVENING, (), 500),
    "a world that was drawn in": Passed("lake", LAKE, entries((0, DRAWN)), 60),
    "too few steps": Passed("lake", LAKE, (), 49),
    "the evening for the lake": Passed("lake", EVENING, (), 60),
    "more steps than are replayed": Passed("lake", LAKE, (), 10**15),
}


@pytest.mark.parametrize("name", FORGED)
def test_a_forged_pass_is_refused(name: str, grading: LessonGrading, tmp_path: Path) -> None:
    forged = replace(BEGUN, passed=(FORGED[name],), finished=True)
    assert passed(grading.grade(write(tmp_path, "a.json", forged))) == []


def test_a_run_whose_world_was_drawn_in_does_nothing_for_a_lesson(
    grading: LessonGrading, tmp_path: Path
) -> None:
    graded = grading.grade(write(tmp_path, "a.json", BEGUN, run_of(LAKE, 60, entries((5, DRAWN)))))
    assert passed(graded) == []
    assert graded.remarks == (
        "branch 1 cannot be replayed: the world was changed, but this task needs the world of the lesson",
    )
    assert passed(grading.grade(write(tmp_path, "b.json", BEGUN, run_of(LAKE, 60)))) == ["lake"]


def test_initial_settings_are_the_learners_to_change(grading: LessonGrading, tmp_path: Path) -> None:
    evidence = Passed("go", setup(LESSON, alpha=0.9, epsilon=1.0), taken(0, 1), 2)
    assert passed(grading.grade(write(tmp_path, "a.json", BEGUN.passes(evidence)))) == ["go"]


def test_the_lesson_of_the_teacher_counts_not_the_one_in_the_session(
    grading: LessonGrading, tmp_path: Path
) -> None:
    easy = lesson(text=TEXT.replace("at_least = 50", "at_least = 1").replace("answer = -1.5", "answer = 7"))
    taking = begun(easy).give(Given("guess", 7.0, True)).passes(Passed("lake", setup(easy, "lake"), (), 3))
    graded = grading.grade(write(tmp_path, "a.json", taking))
    assert passed(graded) == []
    assert graded.predictions == (0, 1, 0)


def test_of_another_lesson_only_the_runs_count(grading: LessonGrading, tmp_path: Path) -> None:
    other = all_done(lesson("morning.toml"))
    path = write(tmp_path, "a.json", replace(other, passed=other.passed), run_of(LAKE, 51))
    graded = grading.grade(path)
    assert passed(graded) == ["lake"]
    assert graded.predictions == (0, 0, 0)
    assert "morning" in graded.remarks[0]


@pytest.mark.parametrize("taking", [None, BEGUN], ids=["a plain session", "a lesson without evidence"])
def test_without_evidence_the_runs_are_looked_at(
    taking: LessonRecord | None, grading: LessonGrading, tmp_path: Path
) -> None:
    forked = RunRecord(
        EVENING, (Branch("branch 1", (), None, 0, 9, 9), Branch("branch 2", taken(0, 1), 0, 0, 30, 30))
    )
    graded = grading.grade(write(tmp_path, "a.json", taking, forked))
    assert passed(graded) == ["go"], "after the second step by hand, of a branch that went on"
    stands = RunRecord(EVENING, (Branch("branch 1", taken(0), None, 0, 30, 30),))
    assert passed(grading.grade(write(tmp_path, "b.json", taking, stands))) == []


def test_a_branch_without_end_is_left_out(grading: LessonGrading, tmp_path: Path) -> None:
    graded = grading.grade(write(tmp_path, "a.json", None, run_of(LAKE, 10**15)))
    assert passed(graded) == []
    assert graded.remarks == ("branch 1 was not judged: it has too many steps.",)


def test_it_says_which_variant_a_session_is_graded_as(tmp_path: Path) -> None:
    text = TEXT.replace("[figures]", "[variants]\nsteps = [50, 70]\n[figures]", 1)
    path = tmp_path / "evening.toml"
    path.write_text(text.replace("at_least = 50", "at_least = ${steps}"), encoding="utf-8")
    for variant, expected in (("1", ["lake"]), ("2", [])):
        taken_up = begun(read_lesson(path, variant))
        graded = LessonGrading(str(path)).grade(write(tmp_path, "a.json", taken_up, run_of(LAKE, 60)))
        assert passed(graded) == expected
        assert graded.remarks == (f"It is graded as variant {variant}.",)


def test_only_so_many_settings_are_worked_out_under_many_seeds(tmp_path: Path) -> None:
    luck = '{ text = "fifty", measure = "steps", seeds = 1, hold = 1, steps = 50, at_least = 51 }'
    (tmp_path / "evening.toml").write_text(
        TEXT.replace('conditions = [{ text = "fifty', f'conditions = [{luck}, {{ text = "fifty')
    )
    tried = tuple(
        Branch(f"branch {n}", (JournalEntry(0, SetParameter("gamma", n / 100)),), None, 0, 60, 60)
        for n in range(40)
    )
    path = write(tmp_path, "a.json", None, RunRecord(LAKE, tried))
    remarks = LessonGrading(str(tmp_path / "evening.toml")).grade(path).remarks
    assert remarks == ("Only the first 30 settings were tried under many seeds. The session has more.",)
    path = write(tmp_path, "b.json", None, RunRecord(LAKE, tried[:20]))
    assert LessonGrading(str(tmp_path / "evening.toml")).grade(path).remarks == ()


def test_not_every_branch_without_end_has_a_remark(grading: LessonGrading, tmp_path: Path) -> None:
    endless = tuple(Branch(f"branch {n}", (), None, 0, 10**15, 10**15) for n in range(40))
    remarks = grading.grade(write(tmp_path, "a.json", None, RunRecord(LAKE, endless))).remarks
    assert len(remarks) == 11
    assert remarks[-1] == "30 more remarks are not shown."


def locked(grading: LessonGrading, folder: Path, given: Given, *runs: RunRecord) -> int:
    return grading.grade(write(folder, "a.json", BEGUN.give(given), *runs)).predictions.locked


def test_a_prediction_is_locked_where_a_run_has_been(grading: LessonGrading, tmp_path: Path) -> None:
    by_hand = run_of(EVENING, 5, taken(0, 1))
    at_two = replace(guess(LESSON), step=2, digest=digest_at(EVENING, 2, taken(0, 1)))
    assert locked(grading, tmp_path, at_two, by_hand) == 1
    assert locked(grading, tmp_path, replace(at_two, step=3), by_hand) == 0
    assert locked(grading, tmp_path, at_two, run_of(EVENING, 5, taken(0))) == 0
    assert locked(grading, tmp_path, at_two, run_of(EVENING, 1, taken(0))) == 0
    assert locked(grading, tmp_path, replace(at_two, step=-1, digest=""), by_hand) == 0


def test_evidence_locks_a_prediction_too(grading: LessonGrading, tmp_path: Path) -> None:
    given = replace(guess(LESSON), step=1, digest=digest_at(EVENING, 1, taken(0)))
    assert locked(grading, tmp_path, given) == 0
    taking = BEGUN.give(given).passes(Passed("go", EVENING, taken(0, 1), 2))
    assert grading.grade(write(tmp_path, "a.json", taking)).predictions.locked == 1


def test_the_first_answer_counts_whatever_is_said_of_it(grading: LessonGrading, tmp_path: Path) -> None:
    wrong, right = replace(guess(LESSON, 3.0), is_right=True), guess(LESSON)
    taking = replace(BEGUN, given=(wrong, right))
    assert grading.grade(write(tmp_path, "a.json", taking)).predictions == (0, 1, 1)


def test_a_damaged_session_is_told(grading: LessonGrading, tmp_path: Path) -> None:
    (tmp_path / "a.json").write_text("{")
    with pytest.raises(SessionError, match="not JSON"):
        grading.grade(tmp_path / "a.json")


def test_a_lesson_without_tasks_grades_nothing(tmp_path: Path) -> None:
    path = tmp_path / "bare.toml"
    path.write_text(TEXT[: TEXT.index('[[pages]]\nid = "go"')], encoding="utf-8")
    with pytest.raises(UserError, match="sets no task"):
        LessonGrading(str(path))


@pytest.mark.exhaustive("trains as every lesson asks", but=["q-by-hand"])
@pytest.mark.parametrize("of", shipped_lessons(), ids=lambda of: of.id)
def test_what_a_shipped_lesson_accepts_passes_from_a_session_too(of: Lesson, tmp_path: Path) -> None:
    taking, tasks = begun(of), [page for page in of.tasks if page.task and not page.task.program]
    for page in tasks:
        evidence = passes(of, page.id, page.task.accepts[0]).passed
        assert evidence is not None
        taking = taking.passes(evidence)
    start = run_of(setup(of, next(iter(of.setups))))
    graded = LessonGrading(of.id).grade(write(tmp_path, "a.json", taking, start))
    assert passed(graded) == [page.id for page in tasks]
    nothing = LessonGrading(of.id).grade(write(tmp_path, "b.json", begun(of), start))
    assert passed(nothing) == []
