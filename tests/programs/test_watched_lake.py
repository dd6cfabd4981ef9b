"""What the README says of the script that it watches, counted again."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from program_watching import watched

from rl_tui.live import commands

pytestmark = pytest.mark.process

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
    assert seen == pytest.approx(said, rel=0.05)
