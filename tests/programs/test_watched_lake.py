"""Claims of README and tutorial about the watched script."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from click.testing import CliRunner
from program_watching import watched

from rl_tui.commands.main import program
from rl_tui.live import commands

pytestmark = pytest.mark.process

ROOT = Path(__file__).parents[2]
PAGES = ("README.md", "docs/tutorial/debug-your-script.md", "docs/explanation/how-a-bug-is-proved.md")
TEXTS = " ".join(" ".join((ROOT / page).read_text(encoding="utf-8").split()) for page in PAGES)


def test_after_how_many_steps_the_fault_is_told_and_which_step_proves_it() -> None:
    (said,) = {int(each.replace(",", "")) for each in re.findall(r"about ([\d,]+) steps\b", TEXTS)}
    (proof,) = re.findall(r"Step (\d+) is the first step onto the goal", TEXTS)
    with watched(ROOT / "docs/lake.py") as watcher:
        seen = 0
        while not watcher.playback.lead.verdicts.newest.findings and seen < 2 * said:
            seen = watcher.do(commands.Train(50)).counters.step
        (finding,) = watcher.playback.lead.verdicts.newest.findings
    assert seen == pytest.approx(said, rel=0.05)
    assert finding.step + 1 == int(proof)  # on screen steps count from 1


def test_nothing_is_found_in_the_script_that_the_tutorial_corrects(tmp_path: Path) -> None:
    early = "        state = next_state\n"
    source = (ROOT / "docs/lake.py").read_text(encoding="utf-8")
    assert source.count(early) == 1
    script = tmp_path / "my_lake.py"
    script.write_text(source.replace(early, "") + early, encoding="utf-8")
    result = CliRunner().invoke(program, ["watch", str(script), "--json"])
    document = json.loads(result.stdout)
    assert (document["update"]["rule"], document["findings"]) == ("q-learning", [])


def test_the_line_is_named_wherever_the_script_lies(tmp_path: Path) -> None:
    folder = tmp_path / "lib" / "site-packages"
    folder.mkdir(parents=True)
    script = folder / "lake.py"
    script.write_text((ROOT / "docs/lake.py").read_text(encoding="utf-8"), encoding="utf-8")
    result = CliRunner().invoke(program, ["watch", str(script), "--steps", "2000", "--json"])
    (finding,) = json.loads(result.stdout)["findings"]
    lines = script.read_text(encoding="utf-8").splitlines()
    assert finding["file"] == str(script)
    assert lines[finding["line"] - 1].strip().startswith("q[state, action] +=")
    assert finding["correction"].startswith("update q[state, action], ")
