"""Background work leaves the processor to others."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

pytestmark = pytest.mark.process

WORK = """
import json, os
from rl_tui.runs.background.child import let_others_go_first
let_others_go_first()
total = sum(number * number for number in range(500_000))
print(json.dumps([total > 0, os.sched_getscheduler(0), os.getpriority(os.PRIO_PROCESS, 0)]))
"""


@pytest.mark.skipif(sys.platform != "linux", reason="other systems have no scheduling classes")
def test_it_is_the_last_of_the_usual_class_and_ends_beside_two_that_never_rest() -> None:
    busy = [
        subprocess.Popen([sys.executable, "-c", "while True: pass"], start_new_session=True) for _ in range(2)
    ]
    try:
        work = subprocess.run(
            [sys.executable, "-c", WORK], capture_output=True, text=True, check=True, start_new_session=True
        )
    finally:
        for each in busy:
            each.kill()
            each.wait()
    assert work.stdout.strip() == f"[true, {os.SCHED_OTHER}, 19]"
