"""The page of a lesson."""

from __future__ import annotations

import re
from dataclasses import replace
from itertools import product
from pathlib import Path

import pytest
from lesson_texts import HALF_THE_WAY, LESSON, ONE_CELL, SET_INITIAL_Q, TEXT
from rich.cells import cell_len
from samples import look, student
from snapshots import changed

from rl_tui.lessons.file.view import ConditionView, Given, LessonRecord, LessonView, Passed, TaskView, begun
from rl_tui.lessons.lesson import lesson_folder, lesson_of, read_lesson
from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.screen.panels.lesson.lesson import LessonPanel, Spotlight
from rl_tui.screen.panels.lesson.words import NOT_COUNTED, PageStage, keeping_page, next_keys, stage_of

CONDITIONS = (ConditionView("study is greedy", False, "check phone"), ConditionView("no step by you", True))
SAID = Given("predict", -2.0, is_right=False, step=3, digest="x")
RIGHT = Given("predict", -1.5, is_right=True, step=3, digest="x")


def at(page: str, *given: Given, step: int = 0, task: TaskView | None = None, **more: object) -> Snapshot:
    record = replace(begun(LESSON).open(page), given=given, **more)  # type: ignore[arg-type]
    start = student(0)
    return changed(
        replace(start, lesson=LessonView(record, task)), counters=replace(start.counters, step=step)
    )


def panel_of(snapshot: Snapshot, *, ascii: bool = False) -> LessonPanel:  # noqa: A002
    panel = LessonPanel(look(ascii))
    panel.snapshot = snapshot
    return panel


def drawn(snapshot: Snapshot, width: int = 42, height: int = 40, *, ascii: bool = False) -> list[str]:  # noqa: A002
    rows = panel_of(snapshot, ascii=ascii).picture(snapshot, width, height)
    assert [row.cell_length for row in rows] == [width] * height
    return [row.text.rstrip() for row in rows]


def text(snapshot: Snapshot, width: int = 42) -> str:
    return " ".join(" ".join(drawn(snapshot, width)).split())


def stage(snapshot: Snapshot) -> PageStage:
    assert snapshot.lesson is not None
    return stage_of(snapshot.lesson, snapshot)


def test_who_went_on_is_told_the_truth_though_the_run_was_set_up_again() -> None:
    later = Given("quiz", 0, is_right=False, step=0)
    assert stage(at("predict", SAID)) is PageStage.LOCKED
    assert stage(at("predict", SAID, later)) is PageStage.TOLD
    assert stage(at("predict", SAID, finished=True)) is PageStage.TOLD


def test_a_page_of_text_has_its_title_and_its_place() -> None:
    panel = panel_of(at("start"))
    rows = panel.picture(at("start"), 42, 20)
    assert panel.heading == "One cell a step"
    assert panel.footing.startswith("page 1 of 6 ━")
    assert [row.text.strip() for row in rows if row.text.strip()][-1] == "enter next page"
    assert "[bold]this[/bold] is no markup" in text(at("start"))


def test_an_open_prediction_names_its_key_and_tells_nothing() -> None:
    said = text(at("predict"))
    assert stage(at("predict")) is PageStage.TO_PREDICT
    assert said.endswith("┃ enter your prediction")
    assert HALF_THE_WAY not in said
    assert "−1.5" not in said


def test_a_locked_prediction_waits_for_its_steps() -> None:
    for step, to_go in ((3, ""), (4, ", 1 to go")):
        said = text(at("predict", SAID, step=step))
        assert stage(at("predict", SAID, step=step)) is PageStage.LOCKED
        assert "You said −2 (locked at step 3)" in said
        assert said.endswith(f"s to the result: 2 steps{to_go}")
        assert "−1.5" not in said
        assert "forgotten" not in said
        assert "right" not in said


def test_the_truth_stands_beside_a_wrong_prediction_with_the_reply_to_it() -> None:
    said = text(at("predict", SAID, step=5))
    assert "✗ not right – it is −1.5" in said
    assert "That is the target: α was forgotten." in said
    assert "0 of 1 prediction right so far." in said
    assert HALF_THE_WAY in said


def test_a_guess_is_told_that_it_does_not_count() -> None:
    taught = lesson_of(TEXT.replace('id = "predict"', 'id = "predict"\nguess = true'), Path("sample.toml"))
    snapshot = at("predict", RIGHT, step=5)
    assert snapshot.lesson is not None
    said = text(replace(snapshot, lesson=LessonView(replace(snapshot.lesson.record, lesson=taught))))
    assert NOT_COUNTED in said
    assert "right so far" not in said


@pytest.mark.parametrize(
    ("given", "told"), [(RIGHT, "✓ right – it is −1.5"), (replace(SAID, answer=-1.9), "✗ not right")]
)
def test_a_right_prediction_and_an_unknown_wrong_one_have_no_reply(given: Given, told: str) -> None:
    said = text(at("predict", given, step=5))
    assert told in said
    assert "forgotten" not in said


def test_a_question_replies_to_a_choice_and_may_be_tried_again() -> None:
    assert "enter your answer" in text(at("quiz"))
    wrong = text(at("quiz", Given("quiz", 0.0, is_right=False)))
    assert "That one is only looked up." in wrong
    assert "enter try again" in wrong
    assert ONE_CELL not in wrong
    right = text(at("quiz", Given("quiz", 0.0, is_right=False), Given("quiz", 1.0, is_right=True)))
    assert f"✓ right – That of the state left Yes. {ONE_CELL}" in right


def test_a_task_has_a_sign_beside_each_condition_and_what_was_found() -> None:
    said = text(at("learn", task=TaskView((*CONDITIONS, ConditionView("later", None)), waits="3 of 20")))
    assert "○ study is greedy (check phone)" in said
    assert "✓ no step by you" in said
    assert "… later" in said
    assert "3 of 20" in said
    assert "h hint 1 of 2" in said
    assert "optimist" not in said


def test_hints_come_one_by_one_and_the_solution_last() -> None:
    shown = [text(at("learn", hints=(("learn", asked),))) for asked in range(5)]
    assert [("Hint 1 of 2" in each, "Hint 2 of 2" in each, "Solution" in each) for each in shown] == [
        (False, False, False),
        (True, False, False),
        (True, True, False),
        (True, True, True),
        (True, True, True),
    ]
    assert "h solution" in shown[2]
    assert SET_INITIAL_Q not in shown[2]
    assert " h " not in shown[3]


def test_a_passed_task_explains_itself() -> None:
    passed = Passed("learn", student(0).recipe)
    said = text(at("learn", passed=(passed,), task=TaskView(CONDITIONS)))
    assert "✓ PASSED" in said
    assert "An optimist tries everything." in said


def test_once_passed_the_conditions_stand_as_they_did_whatever_the_run_does_later() -> None:
    passed = Passed("learn", student(0).recipe)
    for stands in (None, TaskView(CONDITIONS)):
        said = text(at("learn", passed=(passed,), task=stands))
        assert "✓ study is greedy in Class ✓ no step by you" in said
        assert "✗" not in said
        assert "check phone" not in said


def test_of_a_task_rightly_called_impossible_no_condition_is_said_to_hold() -> None:
    claimed = Passed("never", student(0).recipe, claim=True)
    said = text(
        at("never", passed=(claimed,), task=TaskView((ConditionView("an evening earns 100", False),)))
    )
    assert "○ an evening earns 100" in said
    assert "✓ PASSED" in said


@pytest.mark.parametrize("page", ["learn", "never"])
def test_the_way_to_call_a_task_impossible_is_the_same_on_each_and_stands_last(page: str) -> None:
    rows = [row.strip() for row in drawn(at(page, task=TaskView(CONDITIONS))) if row.strip()]
    assert rows[-1].endswith("enter your task")


def test_where_its_row_replaces_the_header_it_says_first_why_nothing_goes_on() -> None:
    now = at("start")
    stopped = replace(now, playback=replace(now.playback, phase=Phase.STOPPED, message="it failed"))
    panel = panel_of(stopped)

    def row(snapshot: Snapshot) -> str:
        return panel.picture(snapshot, 80, 1)[0].text

    assert "One cell a step" in row(stopped), "the header says it"
    panel.replaces_header = True
    assert "stopped: it failed" in row(stopped)
    assert "One cell a step" in row(now)
    panel.show_unanswered(12)
    assert "the environment has not answered for 12 s" in row(now)


def offered(panel: LessonPanel, width: int = 60, height: int = 40) -> list[str]:
    panel.picture(panel.snapshot, width, height)
    return ["  ".join(f"{key}: {does}" for key, does in form) for form in panel.offers]


def test_where_the_page_hides_the_world_it_names_the_way_to_it() -> None:
    for page, keys in (
        ("start", "enter: next page  esc: world"),
        ("learn", "enter: do it  esc: world"),
        ("quiz", "enter: your answer  esc: world"),
    ):
        panel = panel_of(at(page, task=TaskView(CONDITIONS)))
        panel.takes_turns = True
        assert offered(panel)[0] == keys


def test_the_last_page_names_the_next_lesson() -> None:
    panel = panel_of(at("lake"))
    assert offered(panel)[0] == "esc: the lessons"
    panel.following = "Explore or exploit"
    assert offered(panel) == ["enter: next lesson: Explore or exploit", "enter: next lesson"]


@pytest.mark.parametrize(
    ("snapshot", "row"),
    [
        (at("start"), " 1/6 One cell a step · enter reads"),
        (at("predict"), " 2/6 The second update  your prediction · enter reads"),
        (at("predict", SAID, step=3), " 2/6 The second update  you said −2; 2 steps · enter reads"),
        (at("predict", RIGHT, step=5), " 2/6 The second update  ✓ right · enter reads"),
        (at("learn", task=TaskView(CONDITIONS)), " 4/6 Make it learn to study.  ○✓ · enter reads"),
    ],
)
def test_in_one_row_it_says_how_the_page_stands(snapshot: Snapshot, row: str) -> None:
    assert drawn(snapshot, 76, 1) == [row]


def beside_run(given: Given, in_run: float | str, page: str = "predict") -> Snapshot:
    snapshot = at(page, given, step=5)
    assert snapshot.lesson is not None
    return replace(snapshot, lesson=replace(snapshot.lesson, in_run=in_run))


ANOTHER_WAY = "Your run went another way: b goes back, r p restarts it."


def test_the_run_stands_beside_what_was_said_and_what_is_so() -> None:
    said = text(beside_run(SAID, -1.5))
    assert "You said −2 (locked at step 3) ✗ not right – it is −1.5 In your run: −1.5" in said
    assert ANOTHER_WAY not in said


@pytest.mark.parametrize(
    ("in_run", "told"), [(-1.0, "−1"), ("no step has been taken yet", "no step has been taken yet")]
)
def test_a_run_that_went_another_way_is_told_of(in_run: float | str, told: str) -> None:
    said = text(beside_run(RIGHT, in_run))
    assert f"✓ right – it is −1.5 In your run: {told} {ANOTHER_WAY}" in said
    assert HALF_THE_WAY in said
    assert drawn(beside_run(RIGHT, in_run), 90, 1)[0].startswith(
        f" 2/6 The second update  ✓ right; in your run {told}"
    )


@pytest.mark.parametrize(
    ("steps", "step", "is_manual", "ways"),
    [
        (2, 3, False, ("s: to the result: 2 steps", "s: to the result")),
        (2, 3, True, ("act: to the result: 2 steps", "act: to the result")),
        (2, 4, False, ("s: to the result: 2 steps, 1 to go", "s: to the result: 1 to go", "s: 1 to go")),
        (
            1866,
            669,
            True,
            (
                "space or u: to the result: 1,866 steps, 1,200 to go",
                "space or u: to the result: 1,200 to go",
                "space or u: 1,200 to go",
            ),
        ),
    ],
)
def test_a_locked_page_names_the_way_to_the_truth(
    steps: int, step: int, is_manual: bool, ways: tuple[str, ...]
) -> None:
    taught = lesson_of(TEXT.replace("steps = 2", f"steps = {steps}"), Path("sample.toml"))
    snapshot = at("predict", RIGHT, step=step)
    assert snapshot.lesson is not None
    record = replace(snapshot.lesson.record, lesson=taught)
    panel = panel_of(replace(snapshot, lesson=LessonView(record)))
    panel.is_manual = is_manual
    assert offered(panel) == [*ways]


def test_of_a_planner_it_names_the_key_of_a_sweep() -> None:
    start = at("predict", RIGHT, step=3)
    snapshot = replace(start, agent=replace(start.agent, algorithm="value-iteration"))
    assert offered(panel_of(snapshot))[0] == "e or s: to the result: 2 steps"


@pytest.mark.parametrize(
    ("is_manual", "way"), [(False, "y then 1: to the result: 2 steps"), (True, "1: to the result: 2 steps")]
)
def test_it_names_the_keys_that_the_page_asks_for(is_manual: bool, way: str) -> None:
    taught = lesson_of(TEXT.replace("steps = 2", 'steps = 2\nkeys = ["y", "1"]'), Path("sample.toml"))
    record = replace(begun(taught).open("predict"), given=(RIGHT,))
    panel = panel_of(replace(at("predict", RIGHT, step=3), lesson=LessonView(record)))
    panel.is_manual = is_manual
    assert offered(panel)[0] == way


@pytest.mark.parametrize("lesson", [path.stem for path in lesson_folder().glob("*.toml")])
def test_no_page_names_a_key_that_it_forbids_or_does_not_ask_for(lesson: str) -> None:
    taught, start = read_lesson(lesson_folder() / f"{lesson}.toml"), student(0)
    for page in taught.pages:
        forbidden = set(re.findall(r"[Nn]ot `([^`]+)`", page.text))
        asked = {key.strip("`") for key in re.findall(r"`[^`]+`|[↑→↓←]|arrows", page.text)} - forbidden
        opened = begun(taught).open(page.id)
        given = replace(opened, given=(Given(page.id, 0, is_right=False, step=0),))
        for record, is_manual, takes_turns in product((opened, given), (False, True), (False, True)):
            view = LessonView(record)
            snapshot = replace(start, lesson=view)
            is_locked = stage_of(view, snapshot) is PageStage.LOCKED
            for form in next_keys(view, snapshot, takes_turns=takes_turns, is_manual=is_manual):
                keys = {key for part, _ in form for key in re.split(" then | or ", part)}
                assert not keys & forbidden, page.id
                assert not is_locked or keys - {"enter"} <= asked, page.id


def test_the_spotlight_names_the_key_of_a_panel_that_has_no_place() -> None:
    panel = panel_of(at("predict"))
    for spotlight, said in (
        (Spotlight("Q"), "▸ look at Q"),
        (Spotlight("Microscope", is_seen=False, key="d"), "▸ look at Microscope: d shows it"),
    ):
        panel.spotlight = spotlight
        rows = (row.text.strip(" ┃│█") for row in panel.picture(panel.snapshot, 42, 20))
        assert next(filter(None, rows)) == said


def long(page: str) -> Snapshot:
    taught = lesson_of(TEXT.replace("Study failed once.", "Word. " * 300), Path("sample.toml"))
    return replace(at(page), lesson=LessonView(begun(taught).open(page)))


def test_what_is_asked_is_in_view_below_a_text_of_any_length() -> None:
    rows = drawn(long("predict"), 42, 16)
    assert rows[0].startswith("  Word.")
    asked = [row.removeprefix("┃ ") for row in rows if row.startswith("┃")]
    assert asked[0] == "Predict"
    assert "".join(asked[1:]).startswith("What will Q(Class, study) be after two")
    assert asked[-1] == "enter your prediction"
    assert rows[-1].startswith("┃"), "it stands last"
    assert drawn(long("predict"), 42, 8)[-1] == "┃ Predict  enter your prediction"


def test_no_line_of_text_is_wider_than_sixty_columns() -> None:
    assert max(len(row.strip(" │█")) for row in drawn(long("predict"), 140, 16)) <= 60


def test_what_is_below_is_announced_and_news_come_into_view() -> None:
    panel = panel_of(at("learn", task=TaskView(CONDITIONS)))
    panel.picture(panel.snapshot, 30, 5)
    assert re.match(r"\d+ more lines? · .*page 4 of 6", panel.footing)
    hinted = at("learn", task=TaskView(CONDITIONS), hints=(("learn", 1),))
    assert "Hint 1 of 2" in " ".join(row.text for row in panel.picture(hinted, 30, 6))
    turned = at("quiz")
    assert panel.picture(turned, 30, 6)[0].text.strip(" │█") == "Look at it."


@pytest.mark.parametrize("ascii", [False, True])
@pytest.mark.parametrize("page", [page.id for page in LESSON.pages])
def test_no_page_fails_at_any_size(page: str, ascii: bool) -> None:  # noqa: A002
    task = None if LESSON.page(page).task is None else TaskView(CONDITIONS)
    for width, height in ((1, 1), (3, 2), (12, 5), (38, 30), (78, 20)):
        rows = drawn(at(page, task=task), width, height, ascii=ascii)
        assert not ascii or all(row.isascii() for row in rows), (width, height)
        assert all(cell_len(row) <= width for row in rows), (width, height)


def test_a_page_says_which_page_keeps_something_back() -> None:
    record: LessonRecord = begun(LESSON)
    for what in ("answer", "model"):
        page = keeping_page(record, what)
        assert page is not None
        assert page.id == "predict"
    assert keeping_page(record, "run") is None
    assert keeping_page(record.open("predict"), "run") is LESSON.page("predict")
    assert keeping_page(replace(record, given=(SAID,)), "answer") is None
