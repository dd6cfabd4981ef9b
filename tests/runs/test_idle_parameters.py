"""Parameters called idle really change nothing."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from rl_tui.agents.hyperparameters import PARAMETERS, SAMPLE_AVERAGE, Hyperparameters, why_idle
from rl_tui.runs.library import recipe_for
from rl_tui.runs.run import Run
from rl_tui.worlds.files.catalogue import find

pytestmark = pytest.mark.unit


@pytest.mark.parametrize(
    ("name", "changes"),
    [
        ("gamma", {}),
        ("lambda", {}),
        ("n", {}),
        ("traces", {}),
        ("alpha_min", {"alpha_decay": 0.0}),
        ("epsilon_decay", {"epsilon_schedule": "constant"}),
        ("step_size_schedule", {"alpha": SAMPLE_AVERAGE}),
    ],
)
def test_what_is_called_idle_changes_no_estimate(name: str, changes: dict[str, Any]) -> None:
    algorithm = "n-step-sarsa" if name == "n" else "sarsa-lambda"
    values = replace(Hyperparameters(epsilon_decay=0.01, alpha_decay=0.01), **changes)
    recipe = recipe_for(find("bandit"), {"algorithm": algorithm}, 0)
    parameter = PARAMETERS[name]
    others = [*parameter.words, *([] if parameter.range is None else [1.0 if parameter.whole else 0.5])]
    assert why_idle(name, algorithm, values, is_bandit=True)
    learned = set()
    for each in (values, *(values.changed(name, other) for other in others)):
        assert why_idle(name, algorithm, each, is_bandit=True)
        run = Run(replace(recipe, hyperparameters=each))
        run.advance(steps=300)
        learned.add(run.learner.q.tobytes())
    assert len(learned) == 1


@pytest.mark.parametrize("name", ["alpha", "epsilon", "initial_q", "ties", "policy"])
def test_what_counts_everywhere_is_never_idle(name: str) -> None:
    assert not why_idle(name, "q-learning", Hyperparameters(), is_bandit=True)


def test_what_looks_ahead_counts_where_episodes_go_on() -> None:
    for name, algorithm in (("gamma", "sarsa"), ("lambda", "sarsa-lambda"), ("n", "n-step-sarsa")):
        assert not why_idle(name, algorithm, Hyperparameters(), is_bandit=False)
    assert not why_idle("gamma", "value-iteration", Hyperparameters(), is_bandit=True)
