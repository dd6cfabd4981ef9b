"""Programs that are right, as people write them: the update is found, and nothing is found fault with."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from watched_scripts import watched

from rl_tui.lab.detective.detective import verdict_of

pytestmark = pytest.mark.process

SCRIPTS = sorted((Path(__file__).parent / "scripts" / "correct").glob("*.py"))


@pytest.mark.parametrize("path", SCRIPTS, ids=lambda path: path.stem)
def test_a_correct_program_is_understood_and_not_blamed(path: Path) -> None:
    expected = json.loads(path.read_text(encoding="utf-8").splitlines()[0].removeprefix("# expect: "))
    log = watched(path, seed=SCRIPTS.index(path))
    assert log.error is None, log.error
    verdict = verdict_of(log)
    assert verdict.findings == (), verdict.findings
    if "table" in expected:
        assert (log.table.name if log.table else None) == expected.pop("table")
    found = {name: getattr(verdict.update, name) for name in expected}
    assert found == {
        name: pytest.approx(value, rel=1e-6) if isinstance(value, float) else value
        for name, value in expected.items()
    }, verdict.update
    assert bool(verdict.update.reason) == (verdict.update.rule == "unknown" and log.table is not None)
