"""What README and tutorial say of the script that they watch, counted again."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from program_watching import watched

from rl_tui.live import commands
from rl_tui.programs.evidence.verdict import step_number

pytestmark = pytest.mark.process

FIRST_GOAL = 376
ROOT = Path(__file__).parents[2]
README = " ".join((ROOT / "README.md").read_text(encoding="utf-8").split())


def test_after_how_many_steps_the_fault_is_told() -> None:
    found = re.search(r"after some ([\d,]+) steps the panel reports a bug", README)
    assert found
    said = int(found[1].replace(",", ""))
    with watched(ROOT / "docs/lake.py") as watcher:
        seen = 0
        while not watcher.playback.verdicts.newest.findings and seen < 2 * said:
            seen = watcher.do(commands.Train(50)).counters.step
        (finding,) = watcher.playback.verdicts.newest.findings
        assert step_number(finding.step) == FIRST_GOAL
    assert seen == pytest.approx(said, rel=0.05)
