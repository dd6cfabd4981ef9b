"""The Bellman equation of a planner's current state."""

from __future__ import annotations

from functools import cache
from itertools import product

import pytest
from samples import look
from seams import sized
from snapshots import changed, snapshot_of

from rl_tui.agents.catalogue import SweepPhase
from rl_tui.live.last_step.step_report import StateBackup, state_backup_of
from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.runs.library import find, recipe_for
from rl_tui.runs.recipe import OrderSweep, SetParameter, SwitchAlgorithm
from rl_tui.runs.run import Run
from rl_tui.screen.draw.precision import last_digit, parsed
from rl_tui.screen.kit.value_scale import ValueScale
from rl_tui.screen.panels.grid.grid import GridView
from rl_tui.screen.panels.last_step.last_step import LastStepPanel
from rl_tui.screen.panels.last_step.state_backup_text import BackupText, backup_text
from rl_tui.screen.panels.microscope.microscope import Microscope
from rl_tui.screen.panels.world.shown_policy import state_values
from rl_tui.screen.panels.world_views import make_world_view
from rl_tui.screen.theme.glyphs import UNICODE

WORLDS = ("frozenlake", "frozenlake-slippery", "book", "student", "bridge", "taxi", "bandit")


def run_of(scenario: str, algorithm: str, **settings: float) -> Run:
    return Run(recipe_for(find(scenario), {"algorithm": algorithm, **settings}, 0), evaluate=False)


def swept(scenario: str, *phases: SweepPhase, steps: int = 0) -> Run:
    run = run_of(scenario, "policy-iteration")
    for phase in phases:
        run.apply(OrderSweep(phase))
        run.advance(episodes=1)
    run.advance(steps)
    return run


@cache
def on_the_lake() -> Snapshot:
    return snapshot_of(swept("frozenlake-slippery", *["evaluation"] * 4, steps=9))


def backup_in(shown: Snapshot) -> StateBackup | None:
    last = shown.counters.last_step
    return None if last is None else state_backup_of(shown.world, shown.agent, last)


def text_of(shown: Snapshot) -> BackupText:
    backup = backup_in(shown)
    assert backup is not None
    return backup_text(shown.world, backup, UNICODE)


def last_step(shown: Snapshot, width: int, height: int, *, ascii: bool = False) -> list[str]:  # noqa: A002
    rows = LastStepPanel(look(ascii)).picture(shown, width, height)
    assert [row.cell_length for row in rows] == [width] * height
    return [row.text.rstrip() for row in rows]


def below(shown: Snapshot, width: int, height: int = 8) -> str:
    view = make_world_view(shown.world, look())
    view.snapshot = shown
    view.picture(shown, width, height)
    return view.footing


@pytest.mark.parametrize("scenario", WORLDS)
@pytest.mark.parametrize("algorithm", ["value-iteration", "policy-iteration"])
def test_what_is_printed_can_be_worked_out(scenario: str, algorithm: str) -> None:
    run, kinds = run_of(scenario, algorithm), set()
    for number in range(60):
        if algorithm == "policy-iteration" and number % 4 == 2:
            run.apply(OrderSweep("improvement"))
        run.advance(1 if number % 5 else 7)
        shown = snapshot_of(run)
        backup, text = backup_in(shown), text_of(shown)
        assert backup is not None
        kinds.add(text.kind)
        estimates = [parsed(each.q, UNICODE) for each in text.actions]
        digit = max((last_digit(each.q) for each in text.actions if "." in each.q), default=1.0)
        counted = [parsed(each.q, UNICODE) for each in text.actions if each.counts]
        if text.kind == "evaluation":
            assert abs(sum(counted) / len(counted) - parsed(text.result, UNICODE)) <= digit
        else:
            assert max(estimates) - min(counted) <= 1e-9
            if text.kind == "optimality":
                assert parsed(text.result, UNICODE) == max(estimates)
        for action in text.actions:
            if action.worked_out:
                reward, _, product = action.worked_out.partition(" + ")
                gamma, _, value = product.partition("·")
                worked_out = parsed(reward, UNICODE) + backup.gamma * parsed(value.strip("()"), UNICODE)
                assert abs(worked_out - parsed(action.q, UNICODE)) <= 1.01 * digit
                assert gamma
    assert kinds <= ({"optimality"} if algorithm == "value-iteration" else {"evaluation", "improvement"})


@pytest.mark.parametrize("phase", ["evaluation", "improvement"])
def test_the_value_told_is_the_one_drawn(phase: SweepPhase) -> None:
    shown = snapshot_of(swept("student", "evaluation", phase))
    backup = backup_in(shown)
    assert state_values(shown.world.space, shown, ValueScale()).value[backup.state] == backup.value


def test_an_evaluation_is_the_mean_over_the_policy() -> None:
    shown = snapshot_of(swept("frozenlake", "evaluation", "evaluation"))
    assert last_step(shown, 70, 8) == [
        " end of a sweep   backs up state 14   row 3, column 2, counted from 0",
        " policy 1, evaluation sweep 2: largest change 0.093",
        " evaluation   V(s) ← Σ π(a|s) Σ p [r + γ V(s′)]",
        "   ↑  0 + .99·.06 = .06",
        "   →  1 + .99·0 = 1",
        "   ↓  0 + .99·.25 = .25",
        "   ←  0 + .99·.06 = .06",
        " V(14) ← .25·(.06 + 1 + .25 + .06) = .34",
    ]


def test_of_a_policy_of_one_action_its_own_terms_are_told() -> None:
    shown = snapshot_of(swept("student", "evaluation", "improvement", "evaluation"))
    assert last_step(shown, 80, 1) == [" V(Pass) ← 10 + .90·0 = 10  evaluation  end of a sweep"]


def test_an_improvement_names_the_actions_it_chooses() -> None:
    shown = snapshot_of(swept("student", "evaluation", "evaluation", steps=0))
    assert shown.agent.sweep == "evaluation"
    shown = snapshot_of(swept("student", "evaluation", "improvement"))
    assert last_step(shown, 80, 1) == [" π(Pass) ← argmax{sleep 10} = sleep  improvement  end of a sweep"]
    assert text_of(shown).law == "π(s) ← argmax Σ p [r + γ V(s′)]"


def test_value_iteration_takes_the_best() -> None:
    run = run_of("frozenlake", "value-iteration")
    run.advance(episodes=2)
    lines = last_step(snapshot_of(run), 70, 8)
    assert lines[2] == " optimality   V(s) ← max Σ p [r + γ V(s′)]"
    assert lines[-1] == " V(14) ← max{↑.98 →1 ↓.99 ←.98} = 1"


@pytest.mark.parametrize("ascii", [False, True])
def test_in_any_room_nothing_is_cut(ascii: bool) -> None:  # noqa: A002
    shown = on_the_lake()
    for size in product([9, 14, 20, 28, 36, 44, 52, 60, 80], range(1, 10)):
        text = "\n".join(last_step(shown, *size, ascii=ascii))
        assert not ascii or text.isascii(), size
        assert text_of(shown).result in text, size


def test_where_there_is_no_room_for_each_action_there_is_one_line_of_all() -> None:
    run = run_of("taxi", "value-iteration")
    run.advance(30)
    assert last_step(snapshot_of(run), 60, 8)[3] == " V(0,1 in→G) ← max{−1, −1, −1, −1.99, −10, −10} = −1"


def test_below_the_picture_it_stands_in_the_longest_form_that_fits() -> None:
    shown = on_the_lake()
    forms = text_of(shown).lines("←")
    assert [below(shown, width) for width in (80, 18)] == [forms[0], forms[-1]]
    seen = [below(shown, width) for width in range(10, 80)]
    assert set(seen) - {""} <= set(forms)
    assert [len(each) for each in seen] == sorted(len(each) for each in seen)


def test_in_less_room_a_sum_is_told_without_its_middle_and_an_improvement_with_its_best_actions() -> None:
    summed, improved = swept("cliff", "evaluation"), swept("frozenlake", *["evaluation"] * 2, "improvement")
    assert below(snapshot_of(summed), 60) == "V(36) ← .25·(−2.31 − 100 − 1 − 1) = −26.08"
    assert below(snapshot_of(summed), 40) == "V(36) ← .25·(−2.31 + … − 1) = −26.08"
    assert below(snapshot_of(improved), 60) == "π(14) ← argmax{↑.06 →1 ↓.34 ←.06} = →"
    assert below(snapshot_of(improved), 36) == "π(14) ← argmax{↑.06 →1 ↓.34 …} = →"
    assert below(snapshot_of(improved), 26) == "π(14) ← argmax{→1 …} = →"


@pytest.mark.parametrize("scenario", ["frozenlake", "cliff", "book"])
def test_below_the_picture_and_in_the_last_step_it_has_one_form(scenario: str) -> None:
    shown = snapshot_of(swept(scenario, "evaluation", steps=1))
    assert last_step(shown, 60, 8)[-1].strip() == below(shown, 60)


@pytest.mark.parametrize("scenario", ["frozenlake", "student"])
def test_while_steps_pass_too_fast_there_is_none(scenario: str) -> None:
    shown = snapshot_of(swept(scenario, "evaluation"))
    assert below(shown, 60, 20)
    fast = changed(shown, phase=Phase.RUNNING, speed=None)
    assert not below(fast, 60, 20)
    assert below(changed(fast, speed=10.0), 60, 20)


def test_a_cursor_and_a_lane_beside_come_before_it() -> None:
    shown = snapshot_of(swept("frozenlake", "evaluation"))
    for given in ({"cursor": 5}, {"lane": ("1 γ 0.9",)}):
        view = GridView(shown.world, look())
        for name, value in given.items():
            setattr(view, name, value)
        view.picture(shown, 60, 8)
        assert "V(" not in view.footing


def test_it_is_not_told_of_numbers_that_are_not_those_of_the_backup() -> None:
    run = swept("student", "evaluation")
    for algorithm in ("value-iteration", "policy-iteration"):
        run.apply(SwitchAlgorithm(algorithm))
        assert backup_in(snapshot_of(run)) is None
    run.advance(1)
    assert backup_in(snapshot_of(run)) is not None
    run.apply(SwitchAlgorithm("q-learning"))
    assert backup_in(snapshot_of(run)) is None
    run.advance(50)
    assert backup_in(snapshot_of(run)) is None


def test_another_discount_changes_nothing_in_what_was_done() -> None:
    run = swept("student", "evaluation")
    before = text_of(snapshot_of(run))
    run.apply(SetParameter("gamma", 0.5))
    after = text_of(snapshot_of(run))
    assert (after.lines("←"), after.actions) == (before.lines("←"), before.actions)


def test_rewards_that_drift_are_not_taken_apart() -> None:
    run = run_of("bandit-drifting", "q-learning")
    run.advance(100)
    run.apply(SwitchAlgorithm("value-iteration"))
    run.advance(1)
    text = text_of(snapshot_of(run))
    assert not any(each.worked_out for each in text.actions)
    assert text.left == "V"
    assert UNICODE.spelled(text.law)


@pytest.mark.parametrize("width", [40, 60, 120])
def test_the_microscope_tells_it_in_full(width: int) -> None:
    shown = on_the_lake()
    rows = sized(Microscope(look()), width, 40).picture(shown, width, 40)
    text = " ".join(" ".join(row.text for row in rows).split())
    told = text_of(shown).lines("←")[0]
    assert told in text or width < 120
    assert told.split(" = ")[-1] in text
