"""A killed sweep keeps its finished runs."""

from __future__ import annotations

import signal
import subprocess
import sys
from pathlib import Path

import pytest
from sweep_kills import ALLOWED_LOSS, kills

from rl_tui.common.errors import UserError
from rl_tui.studies.sweeps.store import Store


@pytest.mark.exhaustive("kills it again and again")
@pytest.mark.process
def test_a_kill_loses_what_runs_and_a_quarter_second_at_most() -> None:
    lost = []
    for _ in range(3):  # a busy machine may pause for a while, but not every time
        done = list(kills(4, seed=3, cells=60))
        assert sum(each.kept for each in done) > 0
        lost.append(max(each.lost for each in done))
        if lost[-1] <= ALLOWED_LOSS:
            return
    raise AssertionError(f"each time something older than {ALLOWED_LOSS} s was lost: {lost}")


@pytest.mark.process
def test_ctrl_c_says_how_to_go_on(tmp_path: Path) -> None:
    path = tmp_path / "sweep.sqlite"
    command = [sys.executable, "-m", "rl_tui", "sweep", "maze", "--vary", "alpha=0.001:1:900"]
    with subprocess.Popen(
        [*command, "--store", str(path), "--runs", "100"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as child:
        log = path.with_name(f"{path.name}-wal")  # an early reader may block the writer
        while child.poll() is None and not (log.exists() and rows_in(path)):
            pass
        child.send_signal(signal.SIGINT)
        printed, complained = child.communicate()
    assert (child.returncode, printed) == (130, "")
    assert complained.startswith("interrupted: ")
    assert f"kept in {path}: repeat the command to continue" in complained
    assert complained.strip().count("\n") == 0
    kept = rows_in(path)
    assert kept > 0
    assert f"interrupted: {kept:,} of 90,000 runs" in complained
    with Store.to_write(path):  # its lock is free
        pass


def rows_in(path: Path) -> int:
    try:
        with Store.to_read(path) as store:
            return store.count()
    except UserError:
        return 0
