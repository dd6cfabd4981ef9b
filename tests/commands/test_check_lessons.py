"""``rl-tui check`` of lessons."""

from __future__ import annotations

from pathlib import Path
from typing import Final

import pytest
from click.testing import CliRunner
from lessons.lesson_samples import SOUND, changed, written
from lessons.task_samples import HEAD

from rl_tui.commands.main import program
from rl_tui.lessons.check import SPOTLIGHTS, check_lesson
from rl_tui.lessons.figures.step_budget import FIGURE_STEPS, FILE_STEPS, StepBudget
from rl_tui.lessons.lesson import lesson_folder
from rl_tui.screen.kit.row import CAPTION, PROGRAM
from rl_tui.screen.panels.catalogue import PANELS
from rl_tui.worlds.files.scenario import PANEL_IDS
from rl_tui.worlds.files.shipped import shipped_folder

STUDY: Final = 'accepts = [{ name = "study", changes = ["0:take=study"] }]'
HANDS_OFF: Final = '    { name = "hands off", steps = 3 },\n'
SLEEP: Final = 'changes = ["0:take=sleep"]'
VARIANTS: Final = (
    ("[figures]", "[variants]\nalpha = [0.5, 0.25]\none = [-1, -0.5]\ntwo = [-1.5, -0.875]\n\n[figures]"),
    ('value = "−1"', 'value = "${one}"'),
    ('value = "−1.5"', 'value = "${two}"'),
    ("alpha = 0.5,", "alpha = ${alpha},"),
    ("with α 0.5 and", "with α ${alpha} and"),
)


def check(folder: Path, text: str, *options: str) -> tuple[int, list[str], str]:
    path = written(folder, text)
    result = CliRunner().invoke(program, ["check", path, *options])
    return result.exit_code, result.stderr.replace(f"{path}: ", "").splitlines(), result.stdout


def test_a_sound_lesson(tmp_path: Path) -> None:
    code, told, out = check(tmp_path, SOUND)
    assert (code, told) == (0, [])
    assert out.endswith("sample.toml: ok\n")


@pytest.mark.parametrize(
    ("change", "place", "told"),
    [
        (('value = "−1.5"', 'value = "−1.4"'), "figures.second.value", "expected −1.5"),
        (("- first)", "- frist)"), "figures.second.by", 'did you mean "first"?'),
        (('by = "best_return()"', 'by = "1 +"'), "figures.best.by", "an expression of"),
        (('spotlight = "last_step"', 'spotlight = "laststep"'), "pages[0].spotlight", "last_step"),
        (("α 0.5 and", "α 0.7 and"), "pages[0].text", '"0.7"'),
        (("reward −2.", "reward −3."), "pages[0].text", '"−3"'),
        (("Press `2`,", "Press 22,"), "pages[0].text", '"22"'),
        (("see equation 6.8.", "see `x = 6.8`."), "pages[0].text", '"6.8"'),
        (('reply = "−2.5 is', 'reply = "−2.25 is'), "pages[0].prediction.wrong[0].reply", '"−2.25"'),
        (('title = "A question"', 'title = "20 questions"'), "pages[1].title", '"20"'),
        (('goals = ["Find faults"]', 'goals = ["Find 9 faults"]'), "goals[0]", '"9"'),
        (('reply = "No, not 17."', 'reply = "No, not 18."'), "pages[1].question.choices[1].reply", '"18"'),
        (('text = "this one"', 'text = "16 of them"'), "pages[1].question.choices[0].text", '"16"'),
        (('text = "this one"', 'text = "17 of them"'), "pages[1].question.choices[1].text", "twice"),
        (('answer = "{second}"', "answer = -1.5"), "pages[0].prediction.answer", "a computed figure"),
        (("tolerance = 0.005", "tolerance = 1.5"), "pages[0].prediction.wrong[0].answer", "is right"),
        (("in 3 steps or fewer", "in 4 steps or 5"), "pages[2].task.do", '"5"'),
        ((STUDY, ""), "pages[2].task.accepts", "missing; add at least one attempt"),
        ((STUDY, STUDY.replace("=study", "=check phone")), "pages[2].task.accepts[0]", "Q(Class, study)"),
        ((STUDY, STUDY.replace("] }", "], steps = 4 }")), "pages[2].task.accepts[0]", "3 steps"),
        (('steps = 4 },', "steps = 3 },"), "pages[2].task.rejects[1]", "passes; give"),
        ((HANDS_OFF, HANDS_OFF.replace("steps = 3", SLEEP)), "pages[2].task.rejects[2]", "sleep"),
        (("at_least = 8 }", "at_most = 8 }"), "pages[3].task.proof.best", "holds for"),
        (('= "Class", action', '= "Clas", action'), "pages[2].task.conditions[0].state", '"Class"'),
        (('scenario = "student"', 'scenario = "studnet"'), "setups.evening", "student"),
    ],
)  # fmt: skip
def test_each_fault_is_found_with_its_place(
    tmp_path: Path, change: tuple[str, str], place: str, told: str
) -> None:
    code, lines, out = check(tmp_path, changed(change))
    assert (code, out) == (1, "")
    assert [line.partition(": ")[0] for line in lines] == [place]
    assert told in lines[0]


def test_a_task_that_is_passed_by_waiting(tmp_path: Path) -> None:
    at_least_one = '    { text = "at least 1 step was yours", measure = "taken", at_least = 1 },\n'
    passed_at_once = changed((at_least_one, ""), ("below = 0.0", "at_least = 0.0"), (STUDY, "accepts = []"))
    _, lines, _ = check(tmp_path, passed_at_once)
    assert any(line.startswith("pages[2].task: a run without changes passes after 0 steps") for line in lines)


def test_a_run_that_never_ends_is_waited_for_no_longer(tmp_path: Path) -> None:
    endless = f'''{HEAD}[setups.run]
settings = {{ epsilon = 0.0, ties = "first" }}
world = """
title = "Away from the goal"
[grid]
map = "S..G"
"""
[[pages]]
id = "only"
title = "P"
[pages.task]
do = "d"
hints = ["h"]
solution = "s"
conditions = [{{ text = "c", measure = "taken", equals = 1 }}]
accepts = [{{ name = "a step", changes = ["0:take=right"] }}]
rejects = [{{ name = "x", steps = 1 }}, {{ name = "y", steps = 2 }}, {{ name = "z", steps = 3 }}]
'''
    assert check(tmp_path, endless)[:2] == (0, [])


def test_a_task_that_only_the_end_of_an_episode_passes(tmp_path: Path) -> None:
    text = changed(
        ('"q", state = "Class", action = "study", below = 0.0', '"episode_length", equals = 2'),
        ('measure = "taken", at_least = 1', 'measure = "episode_by_agent", equals = 2'),
        ('measure = "steps", at_most = 3', 'measure = "steps", at_least = 200'),
        ("epsilon = 0.0,", "epsilon = 0.3,"),
    )
    _, lines, _ = check(tmp_path, text)
    assert any(line.startswith("pages[2].task: a run without changes passes after") for line in lines)


def test_what_is_warned_of(tmp_path: Path) -> None:
    text = changed(
        ('hints = ["Take the step yourself."]\n', ""), ('solution = "Take *study*."\n', ""), (HANDS_OFF, "")
    )
    code, lines, out = check(tmp_path, text)
    assert (code, out.endswith(": ok\n")) == (0, True)
    assert {": ".join(line.split(": ")[:2]) for line in lines} == {
        f"warning: pages[2].task.{key}" for key in ("hints", "solution", "rejects")
    }


def test_an_answer_of_who_knows_it_exactly_has_to_be_right(tmp_path: Path) -> None:
    exact = "optimal_value('Class')"
    text = changed(
        ("by = \"first + alpha * (reward('Class', 'study') - first)\"", f'by = "{exact}"'),
        ('value = "−1.5"', 'value = "6.34"'),
        ("tolerance = 0.005\n", "tolerance = 0.001\n"),
    )
    _, lines, _ = check(tmp_path, text)
    assert [line.partition(": ")[0] for line in lines] == ["pages[0].prediction.tolerance"]
    assert "6.34146" in lines[0]


def test_variants_are_lessons_of_their_own(tmp_path: Path) -> None:
    code, lines, _ = check(tmp_path, changed(*VARIANTS), "--quick")
    assert (code, lines) == (0, [])
    wrong = (VARIANTS[0][0], VARIANTS[0][1].replace("-0.875", "-0.885"))
    path = written(tmp_path, changed(wrong, *VARIANTS[1:]))
    report = check_lesson(path, quick=True)
    assert [(fault.file, fault.place) for fault in report.faults] == [
        (f"{path} (variant 2)", "figures.second.value")
    ]


def test_a_task_of_variants_has_to_be_solved_under_any_seed(tmp_path: Path) -> None:
    settings = (
        ('measure = "taken", at_least = 1', 'measure = "changed_settings", equals = 1'),
        ("seed = 0", "seed = 1"),
        ("steps = 4 }", "steps = 2 }"),
    )
    lucky = STUDY, 'accepts = [{ name = "lucky", settings = { epsilon = 1.0 }, steps = 1 }]'
    path = written(tmp_path, changed(*VARIANTS, *settings, lucky))
    faults = check_lesson(path).faults
    assert {fault.place for fault in faults} == {"pages[2].task.accepts[0]"}
    assert "passes under" in faults[0].found
    assert not check_lesson(path, quick=True).faults


@pytest.mark.exhaustive("plays every attempt")
def test_what_tasks_are_tried_by_counts_for_the_file(tmp_path: Path) -> None:
    path, free = written(tmp_path, changed(*VARIANTS)), StepBudget()
    assert not check_lesson(path, budget=free).faults
    assert not check_lesson(path, budget=StepBudget(file=free.taken)).faults
    for too_few in (free.taken - 1, 0):
        budget = StepBudget(file=too_few)
        faults = check_lesson(path, budget=budget).faults
        assert faults
        assert all("].task" in fault.place for fault in faults)
        assert all(f"at most {too_few:,} steps in a file" in fault.expected for fault in faults)
        assert budget.taken == too_few


def test_what_takes_seeds_is_left_out_of_a_quick_check(tmp_path: Path) -> None:
    share = "share('policy_in', equals='study', state='Class', episodes=20)"
    text = changed(("[figures]", f'[figures]\nlearned = {{ value = "1 %", by = "{share}" }}'))
    assert check(tmp_path, text)[0] == 1
    assert check(tmp_path, text, "--quick")[0] == 0


def test_several_files_of_both_sorts(tmp_path: Path) -> None:
    lesson = written(tmp_path, changed(('value = "−1.5"', 'value = "−1.4"')))
    scenario, missing = str(shipped_folder() / "student.toml"), str(tmp_path / "none.toml")
    result = CliRunner().invoke(program, ["check", scenario, lesson, missing])
    assert (result.exit_code, result.stdout) == (1, f"{scenario}: ok\n")
    assert [line.split(": ")[0] for line in result.stderr.splitlines()] == [lesson, missing]


def test_a_lesson_that_is_no_toml(tmp_path: Path) -> None:
    code, lines, _ = check(tmp_path, SOUND.replace("minutes = 5", "minutes ="))
    assert code == 1
    assert lines == ["line 3, column 10: not valid TOML (Invalid value)"]


def test_a_spotlight_may_fall_on_any_panel() -> None:
    assert set(SPOTLIGHTS) <= {panel.id for panel in PANELS}
    always = {panel.id for panel in PANELS if not (panel.opened_by or panel.of_lesson or panel.of_drawing)}
    assert always - {PROGRAM, CAPTION} == set(PANEL_IDS), (
        "one has the place of the settings, one comes by itself"
    )


@pytest.mark.parametrize("lesson", ["bandits", "frozen-lake", "mdp", "q-by-hand", "return"])
def test_shipped_lessons_have_no_quick_faults(lesson: str) -> None:
    report = check_lesson(lesson_folder() / f"{lesson}.toml", quick=True)
    assert [str(fault) for fault in (*report.faults, *report.warnings)] == []


@pytest.mark.process
@pytest.mark.slow
@pytest.mark.exhaustive("trains under many seeds", but=["loop"])
@pytest.mark.parametrize("path", sorted(lesson_folder().glob("*.toml")), ids=lambda path: path.stem)
def test_shipped_lessons_have_no_faults(path: Path) -> None:
    budget = StepBudget()
    report = check_lesson(path, budget=budget)
    assert [str(fault) for fault in (*report.faults, *report.warnings)] == []
    assert 5 * max(budget.of_figures.values(), default=0) <= FIGURE_STEPS, "a budget with room"
    assert 5 * budget.taken <= FILE_STEPS
