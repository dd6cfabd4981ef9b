"""Risks that only several seeds prove."""

from __future__ import annotations

import pytest
from test_findings import often_the_first, standing

from rl_tui.programs.diagnosis.diagnosis import verdict_of
from rl_tui.programs.evidence.verdict import CodeFault, CodeFinding, SuspectedRisk
from rl_tui.programs.grading.grade import GradedRun, GradedSubmission

RISK = CodeFinding(
    CodeFault.FIRST_OF_TIES, "proven", 0, 900, 100, "900 of 1,000 choices.", "choose at random"
)


def graded(luck: float, dry: int, seeds: int, share: float = 0.01) -> GradedSubmission:
    suspected = [SuspectedRisk(RISK, luck)] * dry + [None] * (seeds - dry)
    runs = tuple(
        GradedRun(seed, share, share if each else 1.0, suspected=each) for seed, each in enumerate(suspected)
    )
    return GradedSubmission("mine.py", runs, 0.95)


def test_a_run_that_is_too_short_for_a_proof_leaves_a_suspicion() -> None:
    verdict = verdict_of(standing(50, often_the_first))
    assert verdict.findings == ()
    assert verdict.suspected is not None
    assert verdict.suspected.finding.fault is CodeFault.FIRST_OF_TIES
    assert 1e-4 < verdict.suspected.luck < 1.0
    assert verdict_of(standing(50, lambda number: number % 4)).suspected is None


@pytest.mark.parametrize(
    ("luck", "dry", "seeds", "is_told"),
    [
        (0.2, 20, 20, True),
        (0.2, 4, 20, False),  # as many are dry with random choices
        (0.2, 14, 20, True),
        (0.009, 2, 2, True),
        (0.02, 2, 2, False),
        (0.9, 20, 20, False),
        (1e-5, 1, 1, True),
        (0.0, 0, 20, False),
    ],
)
def test_the_luck_of_all_seeds_decides(luck: float, dry: int, seeds: int, is_told: bool) -> None:
    found = graded(luck, dry, seeds).findings
    assert [(each.fault, count) for each, count in found] == [(CodeFault.FIRST_OF_TIES, dry)] * is_told
    for each, _ in found:
        assert each.text == (
            f"{RISK.text} This happened in {dry} of {seeds} seeds. With random choices among equal "
            "values, the "
            "probability of that is below 0.0001."
        )


def test_what_did_not_make_it_fail_is_not_told() -> None:
    assert graded(0.2, 20, 20, share=1.0).findings == []
