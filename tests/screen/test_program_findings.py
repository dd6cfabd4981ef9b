"""Findings, source and output of a watched program."""

from __future__ import annotations

from dataclasses import replace

import pytest
from program_samples import AFTER_END, KNOWN, SOURCE, TIES, drawn, failed, program, watched
from samples import look
from seams import sized

from rl_tui.programs.evidence.verdict import CodeFault, ProgramVerdict, Rule, UpdateFound
from rl_tui.programs.watched.notebook import CodeCell, Notebook
from rl_tui.programs.watched.program_log import OutputLine
from rl_tui.screen.panels.program import output
from rl_tui.screen.panels.program.findings import (
    EXAMINED,
    EXAMINED_WITHOUT_RULE,
    NO_STEP_YET,
    NOTHING,
    FindingsPanel,
)
from rl_tui.screen.panels.program.program import ProgramPanel
from rl_tui.screen.panels.program.words import IN_SHORT, is_own

BOTH = ProgramVerdict(update=KNOWN, findings=(TIES, AFTER_END))


# Findings


def test_the_chosen_finding_shows_line_evidence_and_correction() -> None:
    text = drawn(FindingsPanel, watched(program(verdict=BOTH)), 100)
    for said in (
        "▸ bug: bootstraps after the end   line 15",
        f"{AFTER_END.text}.",
        "Proven; 34 steps for it, none against; first at step 812.",
        " ▸ 15 ",
        SOURCE[14],
        "Fix: after a terminal step the target is r alone",
        f"  risk: {IN_SHORT[TIES.fault]}   line 13",
    ):
        assert said in text
    assert TIES.text not in text


def test_the_cursor_goes_to_the_next_finding() -> None:
    panel = sized(FindingsPanel(look()), 80, 20)
    panel.show(watched(program(verdict=BOTH)))
    assert panel.chosen == AFTER_END
    panel.action_choose(1)
    assert panel.chosen is TIES
    panel.action_choose(1)
    assert panel.chosen is TIES
    panel.action_choose(-1)
    assert panel.chosen is AFTER_END


def test_the_finding_chosen_is_in_view_where_there_is_little_room() -> None:
    panel = sized(FindingsPanel(look()), 34, 6)
    panel.show(watched(program(verdict=BOTH)))
    panel.action_choose(1)
    assert "risk: takes the first" in panel.picture(panel.snapshot, 34, 6)[0].text


def test_a_finding_in_another_file_shows_no_source_of_this_one() -> None:
    elsewhere = replace(AFTER_END, file="/home/someone/agent.py")
    text = drawn(FindingsPanel, watched(program(verdict=ProgramVerdict(findings=(elsewhere,)))), 80)
    assert "agent.py, line 15" in text
    assert SOURCE[14].strip() not in text


@pytest.mark.parametrize(
    ("path", "file", "is_own_one"),
    [
        ("agent.py", "/home/someone/agent.py", True),
        ("../work/agent.py", "/home/work/agent.py", True),
        ("/home/work/../someone/agent.py", "/home/someone/agent.py", True),
        ("/home/someone/agent.py", "/home/someone/agent.py", True),
        ("/home/someone/agent.py", "/home/other/agent.py", False),
        ("agent.py", "/home/someone/helper.py", False),
        ("agent.py", "", True),
    ],
)
def test_the_file_of_a_program_may_be_given_as_people_do(path: str, file: str, is_own_one: bool) -> None:
    assert is_own(file, program(path=path)) is is_own_one


def test_nothing_found_says_what_that_rests_on() -> None:
    text = " ".join(drawn(FindingsPanel, watched()).split())
    assert f"{NOTHING} in 12,400 steps and 1,033 ends of episodes. {EXAMINED}" in text
    assert "Only 1,204 steps reveal γ" in text


@pytest.mark.parametrize("rule", [Rule.UNKNOWN, Rule.MONTE_CARLO])
def test_where_the_target_is_not_known_it_was_not_examined(rule: Rule) -> None:
    view = program(verdict=ProgramVerdict(UpdateFound(rule=rule, reason="No step tells it.")))
    text = " ".join(drawn(FindingsPanel, watched(view)).split())
    assert EXAMINED_WITHOUT_RULE in text
    assert EXAMINED not in text
    assert "informative" not in text
    assert ("no step tells it" in text) is (rule is Rule.UNKNOWN)


def test_without_a_table_the_findings_say_all_that_was_looked_for() -> None:
    looked_for = ("an array of 16×4", "a dictionary of numbers, by (state, action)")
    view = program(table=None, verdict=ProgramVerdict(), looked_for=looked_for)
    text = " ".join(drawn(FindingsPanel, watched(view), 36).split())
    assert "nothing was examined" in text
    assert all(f"- {each}" in text for each in looked_for)


def test_before_the_first_step_the_findings_say_how_to_begin() -> None:
    text = " ".join(drawn(FindingsPanel, watched(program(table=None), 0)).split())
    assert text == NO_STEP_YET


def test_the_name_of_a_finding_is_not_cut_off() -> None:
    limit = replace(AFTER_END, fault=CodeFault.NO_BOOTSTRAP_AFTER_TRUNCATION)
    lines = drawn(FindingsPanel, watched(program(verdict=ProgramVerdict(findings=(limit,)))), 30).splitlines()
    assert IN_SHORT[limit.fault] in " ".join(line[:-1].strip() for line in lines[:2])


def test_declared_is_said() -> None:
    declared = replace(AFTER_END, certainty="declared", fault=CodeFault.GAMMA_TWICE)
    text = drawn(FindingsPanel, watched(program(verdict=ProgramVerdict(findings=(declared,)))), 80)
    assert "relies on a value read from your code" in text
    assert "proven" not in text


# Source and output


def test_source_is_data() -> None:
    assert output.safe_line("\ta = 1\x1b[31m\n") == "    a = 1\\u001b[31m"
    lines = output.source_lines(["a = '[bold]'", "b", "c"], 1, look(), 30)
    assert "".join(piece.text for piece in lines[0]) == " ▸ 1 a = '[bold]'"
    assert output.source_lines(["a"], 2, look(), 30) == output.source_lines([], 1, look(), 30) == []


def test_the_line_that_is_meant_is_shown_whole() -> None:
    lines = output.source_lines(SOURCE, 15, look(), 30)
    code = "".join(piece.text for line in lines for piece in line if piece.style == look().palette.strong)
    assert "".join(code.split()) == "".join(SOURCE[14].split())


def test_the_last_lines_are_in_view_until_somebody_scrolls_up() -> None:
    lines = tuple(OutputLine(step, "out", f"line {step}") for step in range(30))
    panel = output.OutputPanel(look())

    def last(*more: OutputLine) -> str:
        return panel.picture(watched(program(output=(*lines, *more))), 40, 5)[-1].text

    assert "line 29" in last()
    panel.action_scroll_rows(-10)
    assert "line 19" in last(OutputLine(30, "out", "line 30"))
    panel.action_scroll_rows(999)
    assert "line 31" in last(OutputLine(31, "out", "line 31"))


def test_stderr_is_marked_and_steps_stand_before_the_lines() -> None:
    text = drawn(output.OutputPanel, watched(), 80)
    assert " 1,200 │ episode 100 return 0.0" in text
    assert " 2,410 ! UserWarning: a warning of some library" in text


def test_an_exception_stands_at_the_end_with_traceback_and_line() -> None:
    lines = drawn(output.OutputPanel, failed(), 80).splitlines()
    assert " Traceback (most recent call last):" in lines
    assert " ■ IndexError: index 16 is out of bounds for axis 0 with size 16 (line 15)" in lines
    assert any(line.startswith(" ▸ 15 ") for line in lines)
    assert sum("IndexError" in line for line in lines) == 1


def test_floods_are_bounded_and_silence_is_said() -> None:
    flood = tuple(OutputLine(step, "out", "x" * 5_000) for step in range(2_000))
    panel = output.OutputPanel(look())
    assert len(panel.rows(watched(program(output=flood)), 40, 10)) <= 8 * output.MOST_LINES
    assert output.NOTHING_WRITTEN in drawn(output.OutputPanel, watched(program(output=())))


def test_a_notebook_has_cells_and_their_lines() -> None:
    cells = (CodeCell(2, 10, ("import gymnasium",)), CodeCell(5, 20, ("for _ in range(9):", "    1 / 0")))
    source = program(notebook=Notebook("", cells, 0), path="/home/someone/course.ipynb")
    finding = replace(AFTER_END, line=22)
    error = replace(failed().program.error, file=source.path, line=22)
    found = watched(replace(source, verdict=ProgramVerdict(findings=(finding,))))
    broken = watched(replace(source, error=error))
    for panel, picture in ((FindingsPanel, found), (output.OutputPanel, broken), (ProgramPanel, broken)):
        assert "cell 5, line 2" in drawn(panel, picture, 100), panel
    for panel, picture in ((FindingsPanel, found), (output.OutputPanel, broken)):
        assert "▸ 2     1 / 0" in drawn(panel, picture, 100), panel
    elsewhere = replace(finding, file="/home/someone/helper.py")
    said = drawn(FindingsPanel, watched(replace(source, verdict=ProgramVerdict(findings=(elsewhere,)))), 100)
    assert "helper.py, line 22" in said
    assert "1 / 0" not in said
