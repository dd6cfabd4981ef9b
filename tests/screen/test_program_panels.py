"""The panels of a watched program."""

from __future__ import annotations

from dataclasses import replace

import pytest
from program_samples import AFTER_END, KNOWN, TABLE, TIES, drawn, failed, program, unknown, watched
from samples import lake, look
from snapshots import changed

from rl_tui.agents.catalogue import OWN_PROGRAM
from rl_tui.agents.last_step import Author
from rl_tui.live.last_step.step_report import story_of
from rl_tui.live.program_view import ProgramView
from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.programs.evidence.verdict import (
    CodeFault,
    MovedCell,
    ProgramVerdict,
    Rule,
    UpdateFound,
    UpdateTarget,
)
from rl_tui.programs.watched.program_log import FoundTable, OutputLine
from rl_tui.screen.draw.canvas import length
from rl_tui.screen.panels.last_step.last_step import NOTHING_EVER, LastStepPanel, last_step_lines
from rl_tui.screen.panels.microscope.backup import AFTER_END as AFTER_THE_END
from rl_tui.screen.panels.microscope.backup import NOT_KNOWN
from rl_tui.screen.panels.microscope.microscope import page
from rl_tui.screen.panels.microscope.update import return_section
from rl_tui.screen.panels.program.findings import FindingsPanel
from rl_tui.screen.panels.program.output import OutputPanel
from rl_tui.screen.panels.program.program import UNKNOWN, ProgramPanel
from rl_tui.screen.panels.program.words import IN_SHORT, ranked, share_text, update_texts
from rl_tui.screen.panels.status_line import PROGRAM_ENDED, StatusLine

BOTH = ProgramVerdict(update=KNOWN, findings=(TIES, AFTER_END))


def story(snapshot: Snapshot, width: int = 56, height: int = 8) -> str:
    lines = last_step_lines(snapshot, look(), width, height)
    assert all(length(line) <= width for line in lines[1:])
    return "\n".join("".join(piece.text for piece in line).rstrip() for line in lines)


def title(snapshot: Snapshot) -> str:
    panel = LastStepPanel(look())
    panel.picture(snapshot, 80, 7)
    return panel.heading


def microscope(snapshot: Snapshot) -> str:
    return " ".join(" ".join(row.text for row in page(snapshot, 0, look(), 90, 20)).split())


# The panel in place of the sliders


def test_table_and_update_with_the_numbers_that_fit() -> None:
    lines = drawn(ProgramPanel, watched(), height=6).splitlines()
    assert lines[0] == " FrozenLake-v1 · table q: array 16×4, float64"
    assert lines[1] == " Q(s,a) ← Q(s,a) + .1·(r + .99·max Q(s′,·) − Q(s,a))"
    assert lines[2] == " Q-learning fits 99.93 % of steps · departs at step 812"


def test_where_there_is_little_room_the_update_and_the_worst_finding_are_left() -> None:
    lines = drawn(ProgramPanel, watched(program(verdict=BOTH)), 80, 2).splitlines()
    assert lines[0].startswith(" Q-learning:  Q(s,a) ←")
    assert "1 bug, 1 risk: bootstraps after the end (line 15)" in lines[1]


def test_what_it_raised_comes_before_all_else() -> None:
    assert "IndexError (line 15): index 16" in drawn(ProgramPanel, failed(), 80, 1)


def test_an_update_that_is_not_known_says_why_and_nothing_else() -> None:
    text = drawn(ProgramPanel, unknown("several cells moved"), height=6)
    assert f"{UNKNOWN}: several cells moved" in text
    for claim in ("α", "γ", "fits", "max Q"):
        assert claim not in text
    assert "but the update is not known" in drawn(ProgramPanel, unknown("several cells moved"), 80)


def test_where_the_whole_reason_does_not_fit_its_details_are_left_out() -> None:
    few = "Too few numbers of the table have changed so far: 1 step changed a number, after 0 rewards."
    gamma = "γ is not known yet: the values of the next states were 0, or always the same."
    text = drawn(ProgramPanel, unknown(few), 44, 6)
    assert f"{UNKNOWN}: too few numbers of the table have changed so far" in " ".join(text.split())
    assert "…" not in text
    view = program(verdict=ProgramVerdict(update=KNOWN, notes=(gamma,)))
    text = drawn(ProgramPanel, watched(view), 44, 5)
    assert text.splitlines()[-1].rstrip() == " note: γ is not known yet   a f shows it"
    assert gamma in " ".join(drawn(ProgramPanel, watched(view), 44, 6).split())


def test_an_update_of_which_the_numbers_fit_but_no_step_decides_the_rule() -> None:
    reason = "No step yet tells Q-learning from SARSA: the next actions were greedy ones."
    open_rule = UpdateFound(alpha=0.1, alpha_schedule="constant", gamma=0.99, reason=reason)
    view = program(verdict=ProgramVerdict(update=open_rule, notes=(reason,)))
    text = " ".join(drawn(ProgramPanel, watched(view), 110, 6).split())
    assert "known in part, α .1, γ .99: no step yet tells Q-learning from SARSA: the next actions" in text
    assert "max Q" not in text
    assert "note" not in text


def test_without_a_table_it_says_what_was_looked_for() -> None:
    view = program(table=None, verdict=ProgramVerdict(), looked_for=("an array of 16×4", "a dict"))
    text = " ".join(drawn(ProgramPanel, watched(view), 80, 4).split())
    assert "an array of 16×4; a dict" in text


def test_a_program_that_ended_without_a_step_looks_for_nothing_more() -> None:
    ended = watched(program(table=None, verdict=ProgramVerdict(), ended=True))
    ended = changed(ended, step=0, last_step=None, phase=Phase.SPENT)
    assert "FrozenLake-v1 · no table found" in drawn(ProgramPanel, ended, 80)
    assert story(ended) == f" {NOTHING_EVER}"


def test_a_table_that_was_wanted_is_named() -> None:
    view = program(table=None, verdict=ProgramVerdict(), looked_for=("a dict",), wanted="foo")
    assert "no table found named foo where env.step was called" in drawn(ProgramPanel, watched(view), 80, 4)
    assert "No table named foo was found" in drawn(FindingsPanel, watched(view), 80)


def test_beside_a_target_of_no_rule_nothing_wrong_is_not_said() -> None:
    update = replace(KNOWN, target=UpdateTarget.OWN_STATE)
    view = program(verdict=ProgramVerdict(update=update, notes=("The target uses max Q(s).",)))
    for kind in (ProgramPanel, FindingsPanel):
        text = drawn(kind, watched(view), 80)
        assert "1 note, no bug proved in" in text
        assert "nothing wrong" not in text
    for width in range(20, 60, 4):
        assert "nothing wrong" not in drawn(ProgramPanel, watched(view), width)


def test_a_dictionary_has_no_shape_for_it_grows() -> None:
    view = program(table=FoundTable("agent.q", "dict-of-arrays", (1,), ""))
    assert " FrozenLake-v1 · table agent.q: dict of arrays\n" in drawn(ProgramPanel, watched(view))


def test_other_tables_are_named_with_the_key_that_chooses() -> None:
    view = program(table=replace(TABLE, others=("visits", "best")))
    assert "a b chooses another table: visits, best" in drawn(ProgramPanel, watched(view), height=6)


def test_what_is_cut_off_ends_with_a_sign() -> None:
    view = program(
        verdict=ProgramVerdict(update=KNOWN, notes=("a note that is longer than one row of it has room for",))
    )
    lines = drawn(ProgramPanel, watched(view), 40, 5).splitlines()
    assert lines[-1].endswith("… a f shows it")
    reason = replace(KNOWN, rule=Rule.UNKNOWN, reason="a reason that takes more than two rows " * 3)
    lines = drawn(ProgramPanel, watched(program(verdict=ProgramVerdict(update=reason))), 60, 3).splitlines()
    assert lines[1].endswith("…")


def test_what_it_raised_stands_there_whole_and_comes_before_that_it_stopped() -> None:
    text = drawn(ProgramPanel, failed(), 40, 8)
    assert "index 16 is out of bounds for axis 0 with size 16" in " ".join(text.split())
    said = "your program stopped: line 15: IndexError: index 16 is out of bounds for axis 0"
    picture = changed(failed(), phase=Phase.STOPPED, message=said)
    row = drawn(StatusLine, picture, 80, 1)
    assert row.endswith("line 15: IndexError: index 16 is out of bounds for axis 0")


@pytest.mark.parametrize("reason", ["", "Too few numbers of the table have moved yet."])
def test_as_long_as_the_update_is_open_nothing_is_judged(reason: str) -> None:
    view = program(verdict=ProgramVerdict(update=UpdateFound(reason=reason)))
    for kind in (ProgramPanel, FindingsPanel):
        text = drawn(kind, watched(view), 80)
        assert "nothing can be judged yet" in text
        assert "nothing wrong" not in text


@pytest.mark.parametrize(
    "view",
    [
        program(),
        program(verdict=BOTH, notes=("one", "two")),
        program(table=None, looked_for=("an array",)),
        program(refused="it steps in several threads"),
        failed().program,
        program(title="\x1b[31m", environment="\x07", output=(OutputLine(1, "out", "\x1b[2J" * 90),)),
    ],
)
def test_every_panel_fits_any_size_and_shows_nothing_a_terminal_obeys(view: ProgramView) -> None:
    for options in ({}, {"ascii": True}):
        for width in (1, 9, 34, 80):
            for height in (1, 2, 6):
                for kind in (ProgramPanel, FindingsPanel, OutputPanel):
                    text = drawn(kind, watched(view), width, height, **options)
                    assert text.replace("\n", "").isprintable()
                    assert not options or text.isascii()


@pytest.mark.parametrize("kind", [ProgramPanel, FindingsPanel, OutputPanel])
def test_without_a_program_they_are_blank(kind: type[ProgramPanel | FindingsPanel | OutputPanel]) -> None:
    assert drawn(kind, None).split() == drawn(kind, lake()).split() == []


# Its words


@pytest.mark.parametrize(
    ("update", "equation"),
    [
        (KNOWN, "Q(s,a) ← Q(s,a) + .1·(r + .99·max Q(s′,·) − Q(s,a))"),
        (replace(KNOWN, gamma=None), "Q(s,a) ← Q(s,a) + .1·(r + γ·max Q(s′,·) − Q(s,a))"),
        (
            replace(
                KNOWN, rule=Rule.SARSA, target=UpdateTarget.NEXT_ACTION, alpha=None, alpha_schedule="1/N"
            ),
            "Q(s,a) ← Q(s,a) + 1/N·(r + .99·Q(s′,a′) − Q(s,a))",
        ),
        (
            replace(KNOWN, alpha=None, alpha_schedule="by-episode"),
            "Q(s,a) ← Q(s,a) + α·(r + .99·max Q(s′,·) − Q(s,a))",
        ),
        (replace(KNOWN, target=UpdateTarget.NOTHING), "Q(s,a) ← Q(s,a) + .1·(r − Q(s,a))"),
        (
            replace(KNOWN, place=MovedCell.MOVED, reward="own"),
            "Q(s′,a) ← Q(s′,a) + .1·(own r + .99·max Q(s′,·) − Q(s′,a))",
        ),
        (UpdateFound(rule=Rule.MONTE_CARLO, alpha_schedule="1/N"), "Q(s,a) ← Q(s,a) + 1/N·(G − Q(s,a))"),
    ],
)
def test_an_update_is_written_with_what_is_known_of_it(update: UpdateFound, equation: str) -> None:
    assert update_texts(update, look().glyphs)[1] == equation


def test_an_unknown_update_is_not_written() -> None:
    assert update_texts(UpdateFound(alpha=0.1, gamma=0.9), look().glyphs) == ()


@pytest.mark.parametrize(
    ("share", "text"),
    [(1.0, "100 %"), (0.99995, "99.99 %"), (0.5, "50 %"), (0.0, "0 %"), (0.9993, "99.93 %")],
)
def test_not_all_steps_are_never_all(share: float, text: str) -> None:
    assert share_text(share) == text


def test_every_fault_has_a_name_of_its_own() -> None:
    assert set(IN_SHORT) == set(CodeFault)
    assert len(set(IN_SHORT.values())) == len(CodeFault)


def test_the_worst_comes_first() -> None:
    declared = replace(AFTER_END, certainty="declared", step=0)
    later = replace(AFTER_END, step=9_000)
    assert ranked([TIES, later, declared, AFTER_END]) == [AFTER_END, later, declared, TIES]


# Other panels for a program


def test_a_step_that_the_update_fits_has_its_equation_and_no_word_on_exploring() -> None:
    text = story(changed(watched(), algorithm="q-learning"))
    assert "·(r + γ  ·best" in text
    assert "ε" not in text
    assert "random" not in text
    assert "your program chose it" in title(watched())


def test_a_step_whose_update_is_not_known_tells_only_what_moved() -> None:
    picture = unknown("several cells moved in most steps")
    last = picture.counters.last_step
    assert last is not None
    text = story(picture, 80)
    assert "your program changed Q(6,←) from " in text
    assert "the update is not known: several cells moved in most steps" in text
    for invented in ("target", "α", "γ", "δ"):
        assert invented not in text
    assert "your program changed" in story(picture, 80, 1)


def test_a_step_that_moved_several_cells_says_how_many() -> None:
    assert "this step changed 5 cells" in story(unknown(others=4), 110)
    last = unknown().counters.last_step
    text = story(unknown(others=4, before=last.after), 110)  # the reported cell is unchanged, others are not
    assert "this step changed 5 cells" in text
    assert "changed nothing" not in text


def test_a_step_that_departs_says_so() -> None:
    picture = unknown()
    assert picture.program is not None
    picture = replace(picture, program=replace(picture.program, verdict=ProgramVerdict(update=KNOWN)))
    picture = changed(picture, author=Author(OWN_PROGRAM.id, picture.agent.hyperparameters))
    assert "this step does not fit the update rule of the other steps" in story(picture, 110)


def test_a_step_size_that_varies_is_that_of_the_step() -> None:
    by_visits = ProgramVerdict(update=replace(KNOWN, alpha=None, alpha_schedule="1/N"))
    picture = changed(watched(program(verdict=by_visits)), algorithm=OWN_PROGRAM.id)
    last = picture.counters.last_step
    seventh = replace(last, step_size=1 / 7, after=last.before + last.td_error / 7)
    assert " + 1/7·(" in story(changed(picture, last_step=seventh), 80)


def test_monte_carlo_departs_from_nothing() -> None:
    picture = unknown()
    assert picture.program is not None
    verdict = ProgramVerdict(update=UpdateFound(rule=Rule.MONTE_CARLO, alpha_schedule="1/N"))
    picture = replace(picture, program=replace(picture.program, verdict=verdict))
    picture = changed(picture, author=Author(OWN_PROGRAM.id, picture.agent.hyperparameters))
    text = story(picture, 110)
    assert "from the return of its steps" in text
    assert "departs" not in text


def test_a_step_that_changed_nothing() -> None:
    picture = unknown()
    last = picture.counters.last_step
    same = changed(picture, last_step=replace(last, before=last.after))
    assert "stays" in story(same, 80)
    none = changed(picture, last_step=replace(last, updated_pair=-1))
    assert "your program changed nothing" in story(none, 80)


def test_without_a_table_nothing_is_said_of_what_was_learned() -> None:
    picture = watched(program(table=None, verdict=ProgramVerdict()))
    last = picture.counters.last_step
    assert last is not None
    text = story(changed(picture, last_step=replace(last, updated_pair=-1)), 80)
    assert "no table was found, so no change is known" in text
    assert "greedy" not in text


def test_the_microscope_has_the_update_that_fits_and_invents_nothing() -> None:
    text = "\n".join(row.text for row in page(watched(), 0, look(), 120, 20))
    assert "Q-learning:  Q(s,a) ←" in text or "Q(s,a) ← Q(s,a) + .1·(r + .99·max Q(s′,·) − Q(s,a))" in text
    assert "fits 99.93 % of steps" in text
    assert "departs at step 812" in text
    text = microscope(unknown("no step tells it"))
    assert NOT_KNOWN in text
    assert "your program changed" in text
    for invented in ("sampled", "expected", "α", "max Q", "G₀"):
        assert invented not in text
    open_update = unknown("no step tells it")
    assert open_update.program is not None
    declared = replace(open_update.program, gamma=0.95, gamma_source="declared")
    told = story_of(replace(open_update, program=declared))
    assert told is not None
    section = return_section(replace(told, rewards=(1.0,)), look())
    text = " ".join(piece.text for line in section.lines(200, look()) for piece in line)
    assert "no step shows it yet; exact values are for 0.95, read from your code" in text


def test_what_a_fault_puts_into_the_target_is_written_as_it_is() -> None:
    column = ProgramVerdict(update=replace(KNOWN, target=UpdateTarget.COLUMN, uses_reward_before=True))
    picture = watched(program(verdict=column))
    text = story(picture, 80)
    assert "·(r before + γ  ·max Q(·,a) − was" in text
    found = story_of(picture)
    assert found.sources == {}
    assert found.backup is None
    assert "your program looked up max Q(·,a)" in "\n".join(
        row.text for row in page(picture, 0, look(), 120, 20)
    )


def test_after_the_end_of_an_episode_there_is_nothing_to_look_up() -> None:
    text = microscope(unknown(terminated=True))
    assert AFTER_THE_END in text
    assert NOT_KNOWN not in text


def test_an_action_that_is_one_of_all_equal_ones_is_not_called_greedy() -> None:
    picture = unknown()
    last = picture.counters.last_step
    pairs, q = picture.world.space.pairs_of(last.state), picture.agent.q.copy()
    q[pairs.start : pairs.stop] = last.before
    q[last.updated_pair] = last.after
    assert title(changed(picture, q=q)) == "Last step · your program chose it: all 4 tied"
    q[next(each for each in pairs if each != last.pair)] = last.before - 1.0
    assert "greedy, one of 3 tied" in title(changed(picture, q=q))


def test_a_mean_over_actions_is_taken_apart_only_with_the_epsilon_that_is_known() -> None:
    mean = ProgramVerdict(
        update=replace(KNOWN, rule=Rule.EXPECTED_SARSA, target=UpdateTarget.EXPECTED, epsilon=0.1)
    )
    picture = changed(watched(program(verdict=mean)), algorithm="expected-sarsa")
    last = picture.counters.last_step
    assert last is not None
    known, other = (story_of(changed(picture, last_step=replace(last, epsilon=each))) for each in (0.1, 0.0))
    assert known.backup is not None
    assert other.backup is None


def test_a_target_that_bootstraps_after_the_end_is_no_luck() -> None:
    picture = watched()
    last = picture.counters.last_step
    over = changed(picture, last_step=replace(last, terminated=True, bootstrap_state=last.next_state))
    text = "\n".join(row.text for row in page(over, 0, look(), 120, 24))
    assert "it bootstraps after the end" in text


def test_a_product_in_a_finding_is_no_minus_in_ascii() -> None:
    finding = replace(AFTER_END, text="with γ · 5 it would be 4.25")
    text = drawn(FindingsPanel, watched(program(verdict=ProgramVerdict(findings=(finding,)))), 80, ascii=True)
    assert "with gamma * 5 it would be" in text


def status(snapshot: Snapshot, width: int = 110) -> str:
    return drawn(StatusLine, snapshot, width, 1)


def test_the_status_line_names_the_program_and_says_that_it_has_ended() -> None:
    assert "frozen_lake.py" in status(watched())
    assert "Q-learning" not in status(watched())
    assert "frozen_lake.py" in status(watched(), 70)
    assert PROGRAM_ENDED in status(watched(phase=Phase.SPENT))
    assert "budget" not in status(watched(phase=Phase.SPENT))
