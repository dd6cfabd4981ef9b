"""Realistic programs with one fault each."""

from __future__ import annotations

from pathlib import Path

import pytest
from corpus import FAULTY, expected, line_of, watched

from rl_tui.programs.evidence.verdict import CodeFault

pytestmark = pytest.mark.process


@pytest.mark.exhaustive(
    "watches every program",
    but=[
        *("last_reward", "always_the_first", "cut_off_cliff", "same_list", "updates_a_copy"),
        *("moves_first", "transposed", "discounted_twice"),
    ],
)
@pytest.mark.parametrize("script", FAULTY, ids=lambda script: script.stem)
def test_the_fault_of_a_program_is_found(script: Path) -> None:
    log, verdict = watched(script, 0)
    assert log.error is None
    assert [each.fault.value for each in verdict.findings] == expected(script)
    (finding,) = verdict.findings
    assert line_of(finding) == expected(script, "line")
    assert finding.kind == "risk" or finding.steps_against == 0


def test_every_fault_has_programs() -> None:
    assert {name for script in FAULTY for name in expected(script)} == {each.value for each in CodeFault}
