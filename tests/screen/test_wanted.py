"""A wish stays on screen until it is fulfilled."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

import pytest
import samples
from conftest import MakeApp
from seams import notes, on_screen, playground, press, show
from snapshots import changed

import rl_tui.agents.learner_memory
import rl_tui.runs.settings
from rl_tui.agents.compatibility import check_compatible
from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.live.commands import Apply, Command, HideAnswer, LookAt, Restart, SetSpeed, Step
from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.live.viewport import Viewport
from rl_tui.runs.recipe import SetParameter, SwitchAlgorithm, TakeAction
from rl_tui.runs.timeline.branches import Branch, Timeline
from rl_tui.screen.app.screenshot import settle
from rl_tui.screen.board.wanted import Wanted, in_force
from rl_tui.screen.panels.controls.slider import Slider
from rl_tui.worlds.mdp.space import FiniteSpace

BEGINNING = samples.student(0)


def shown(handled: int, here: int = 0, phase: Phase = Phase.PAUSED) -> Snapshot:
    timeline = Timeline((Branch("branch 1", end=100, here=here),))
    return changed(BEGINNING, handled=handled, timeline=timeline, phase=phase)


def wanted(*commands: Command) -> Wanted:
    made = Wanted(shown(0).recipe, 10.0)
    for command in commands:
        made.note(command)
    return made


def test_a_change_counts_until_all_that_was_sent_is_taken_in() -> None:
    kept = wanted(Apply(SetParameter("alpha", 0.7)), Apply(SwitchAlgorithm("sarsa")))
    kept.reconcile(shown(1))
    assert (kept.recipe.hyperparameters.alpha, kept.recipe.algorithm) == (0.7, "sarsa")
    kept.reconcile(shown(2))
    assert kept.recipe == in_force(shown(2))


def test_an_action_of_a_person_changes_no_recipe() -> None:
    assert wanted(Apply(TakeAction(1))).recipe == shown(0).recipe


def test_a_speed_and_a_hidden_answer_stay() -> None:
    kept = wanted(SetSpeed(None), HideAnswer(is_hidden=True))
    kept.reconcile(shown(0))
    assert kept.speed is None
    kept.reconcile(changed(shown(2), speed=None, is_hidden=True))
    assert kept.speed is None
    assert kept.is_hidden
    recipe = replace(kept.recipe, seed=7)
    kept.note(Restart(recipe))
    assert kept.recipe == recipe
    assert kept.is_hidden


def test_the_handle_stays_until_the_run_is_there_or_something_else_came_in_between() -> None:
    kept = wanted(Step())
    for now in (shown(0, 90), shown(1, 90, Phase.SEEKING)):
        kept.step = 40
        kept.reconcile(now)
        assert kept.step == 40
    for now in (shown(0, 40), shown(1, 90)):
        kept.step = 40
        kept.reconcile(now)
        assert kept.step is None


def test_to_look_is_no_deed() -> None:
    kept = wanted(Step(), LookAt(Viewport()))
    assert (kept.sent, kept.last_deed) == (2, 1)


async def test_a_tick_of_a_slider_is_checked_once(make_app: MakeApp, monkeypatch: pytest.MonkeyPatch) -> None:
    checks: Counter[str] = Counter()
    async with on_screen(make_app("student")) as pilot:
        for module in (rl_tui.runs.settings, rl_tui.agents.learner_memory):

            def check(
                space: FiniteSpace, algorithm: str, values: Hyperparameters, name: str = module.__name__
            ) -> None:
                checks[name] += 1
                check_compatible(space, algorithm, values)

            monkeypatch.setattr(module, "check_compatible", check)
        playground(pilot).query_one("#alpha", Slider).focus()
        for ticks in (1, 2, 3):
            await press(pilot, "right")
            assert checks == {"rl_tui.runs.settings": ticks}


async def test_a_run_in_preparation_has_no_journal_to_show(make_app: MakeApp) -> None:
    async with on_screen(make_app("student"), notifications=True) as pilot:
        screen = playground(pilot)
        assert screen.snapshot is not None
        preparing = changed(screen.snapshot, phase=Phase.PREPARING, step=0)
        show(screen, preparing)
        screen.action_do("time.show_branches")  # like the palette: the key would wait
        await settle(pilot)
        assert pilot.app.screen is screen
        assert notes(pilot.app)[-1].startswith("The run is being prepared")
