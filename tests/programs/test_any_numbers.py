"""Any numbers lead to a verdict."""

from __future__ import annotations

import numpy as np
import pytest

from rl_tui.programs.diagnosis.diagnosis import verdict_of
from rl_tui.programs.watched.program_log import FoundTable, ProgramLog

STATES, ACTIONS, STEPS = 5, 3, 400
ODD = (0.0, 1.0, -1.0, np.nan, np.inf, -np.inf, 1e305, -1e300, 1e-320)


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("rewards", [(0.0, 1.0, -1.0), ODD], ids=["plain rewards", "odd rewards"])
def test_odd_numbers_are_judged_in_silence(
    rewards: tuple[float, ...], seed: int, capfd: pytest.CaptureFixture[str]
) -> None:
    rng = np.random.default_rng(seed)
    log = ProgramLog(table=FoundTable("Q", "array", (STATES, ACTIONS), "float64"))
    log.numbers |= {"alpha": 0.1, "gamma": 0.9, "none": np.nan, "endless": np.inf}
    log.recording.find_table(0, ACTIONS, rng.choice(ODD, STATES * ACTIONS))
    number = np.arange(STEPS)
    state, action = rng.integers(0, STATES, STEPS), rng.integers(0, ACTIONS, STEPS)
    reward, flags = rng.choice(rewards, STEPS), rng.choice((0, 0, 0, 1, 2), STEPS)
    following, episode = rng.integers(0, STATES, STEPS), np.sort(rng.integers(0, 90, STEPS))
    steps = np.column_stack((0 * number, state, action, reward, following, flags, episode, number))
    table, changes = rng.choice(ODD, STATES * ACTIONS), []
    for at, cell in enumerate(state * ACTIONS + action):
        with np.errstate(all="ignore"):
            after = table[cell] + 0.1 * (reward[at] - table[cell]) if at % 9 else rng.choice(ODD)
        changes.append((at, cell, table[cell], after))
        table[cell] = after
    log.recording.add(steps, np.array(changes))
    verdict_of(log)
    assert capfd.readouterr() == ("", "")
