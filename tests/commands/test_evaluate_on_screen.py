"""The screen and ``rl-tui evaluate`` report the same numbers."""

from __future__ import annotations

import itertools
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from called import document

from rl_tui.live.commands import DrawAction, StudyPolicy, Train
from rl_tui.live.playback import Playback
from rl_tui.runs.answers.policy_kind import PolicyKind
from rl_tui.runs.answers.policy_values import PolicyAnswer
from rl_tui.runs.library import find, recipe_for

STEPS = 3_000
SCENARIOS = ("frozenlake-slippery", "student", "cliff")


def on_screen(scenario: str) -> Playback:
    playback = Playback(
        recipe_for(find(scenario), {}, 0),
        speed=None,
        automatic=False,
        clock=itertools.count(0.0, 0.01).__next__,
        on_exact=lambda: None,
    )
    while playback.on_the_way:
        playback.work()
    for command in (StudyPolicy(PolicyKind.UNIFORM), DrawAction(0, 1), Train(STEPS)):
        playback.handle(command)
        while playback.on_the_way:
            playback.work()
    return playback


def assert_same(answer: PolicyAnswer, printed: dict[str, Any]) -> None:
    for name in ("value_at_start", "expected_return", "steps"):
        shown = getattr(answer, name)
        assert shown == (None if printed[name] is None else pytest.approx(printed[name], rel=1e-12)), name
    if printed["V"] is not None:
        assert answer.v is not None
        values = np.array([np.nan if each is None else each for each in printed["V"].values()])
        assert answer.v == pytest.approx(values, rel=1e-12, abs=1e-15, nan_ok=True)


@pytest.mark.parametrize("scenario", SCENARIOS)
def test_every_policy_has_the_figures_of_the_command(scenario: str, tmp_path: Path) -> None:
    playback = on_screen(scenario)
    answers, run = playback.snapshot().answers.policies, playback.group.current.run
    assert_same(answers[PolicyKind.UNIFORM], document("evaluate", scenario, "--policy", "uniform"))
    assert_same(answers[PolicyKind.OPTIMAL], document("evaluate", scenario, "--policy", "optimal"))
    greedy = ("--policy", "greedy", "--steps", str(STEPS))
    assert_same(answers[PolicyKind.GREEDY], document("evaluate", scenario, *greedy))
    epsilon = str(run.learner.hyperparameters.epsilon)
    assert_same(answers[PolicyKind.BEHAVIOUR], document("evaluate", scenario, *greedy, "--epsilon", epsilon))
    space, file = run.world.space, tmp_path / "drawn.json"
    file.write_text(json.dumps({space.state_names[0]: space.action_names[1]}), encoding="utf-8")
    assert_same(answers[PolicyKind.DRAWN], document("evaluate", scenario, "--policy", str(file)))
