"""Correct, realistic programs: no fault is reported."""

from __future__ import annotations

from pathlib import Path

import pytest
from corpus import CORRECT, expected, watched

pytestmark = pytest.mark.process


@pytest.mark.exhaustive(
    "watches every program",
    but=[
        *("alpha_by_episode", "dyna_q", "n_step_sarsa", "optimistic_lists", "potential_shaping"),
        *("replay_buffer", "sarsa_cliff", "single_precision"),
    ],
)
@pytest.mark.parametrize("script", CORRECT, ids=lambda script: script.stem)
def test_a_correct_program_is_understood_and_not_blamed(script: Path) -> None:
    wanted = expected(script)
    log, verdict = watched(script, seed=CORRECT.index(script))
    assert log.error is None, log.error
    assert verdict.findings == ()
    if "table" in wanted:
        assert (log.table.name if log.table else None) == wanted.pop("table")
    found = {name: getattr(verdict.update, name) for name in wanted}
    assert found == {
        name: pytest.approx(value, rel=1e-6) if isinstance(value, float) else value
        for name, value in wanted.items()
    }, verdict.update
    assert bool(verdict.update.reason) == (verdict.update.rule == "unknown" and log.table is not None)
