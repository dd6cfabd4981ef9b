"""Snapshots of a watched program made by hand."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from samples import lake, look
from seams import sized
from snapshots import changed

from rl_tui.agents.catalogue import OWN_PROGRAM
from rl_tui.live.program_view import ProgramView
from rl_tui.live.snapshot import Snapshot
from rl_tui.programs.evidence.verdict import (
    CodeFault,
    CodeFinding,
    ProgramVerdict,
    Rule,
    UpdateFound,
    UpdateTarget,
)
from rl_tui.programs.watched.program_log import FoundTable, OutputLine, ProgramError
from rl_tui.screen.kit.panel import Panel

SOURCE = """import gymnasium as gym
import numpy as np

env = gym.make("FrozenLake-v1")
q = np.zeros((16, 4))
for episode in range(5000):
    s, _ = env.reset()
    done = False
    while not done:
        if rng.random() < 0.1:
            a = env.action_space.sample()
        else:
            a = int(np.argmax(q[s]))
        s2, r, terminated, truncated, _ = env.step(a)
        q[s, a] += 0.1 * (r + 0.99 * q[s2].max() - q[s, a])
\ts, done = s2, terminated or truncated
print(q)
""".splitlines()

TABLE = FoundTable("q", "array", (16, 4), "float64")
KNOWN = UpdateFound(
    rule=Rule.Q_LEARNING,
    alpha=0.1,
    alpha_schedule="constant",
    gamma=0.99,
    fits=0.9993,
    informative=1_204,
    departs_at=811,
    target=UpdateTarget.BEST,
)
AFTER_END = CodeFinding(
    fault=CodeFault.BOOTSTRAPS_AFTER_END,
    certainty="proven",
    step=811,
    steps_for=34,
    steps_against=0,
    text="at 34 terminal steps the target held γ times the value of the next state",
    correction="after a terminal step the target is r alone: multiply the next value by (not terminated)",
    line=15,
)
TIES = CodeFinding(
    fault=CodeFault.FIRST_OF_TIES,
    certainty="proven",
    step=0,
    steps_for=1_980,
    steps_against=20,
    text="of equal best actions it took the first, ←, in 1,980 of 2,000 choices",
    correction="break ties at random: choose among all actions whose value is the largest",
    line=13,
)


def program(**changes: Any) -> ProgramView:
    view = ProgramView(
        title="frozen_lake.py",
        environment="FrozenLake-v1",
        table=TABLE,
        verdict=ProgramVerdict(update=KNOWN),
        source=tuple(SOURCE),
        path="/home/someone/frozen_lake.py",
        output=(
            OutputLine(0, "out", "training starts"),
            OutputLine(1_200, "out", "episode 100 return 0.0"),
            OutputLine(2_410, "err", "UserWarning: a warning of some library"),
        ),
    )
    return replace(view, **changes)


def watched(view: ProgramView | None = None, step: int = 12_400, **changes: Any) -> Snapshot:
    return replace(changed(lake(step), **changes), program=view or program())


def unknown(reason: str = "several cells moved in most steps", **changes: Any) -> Snapshot:
    picture = watched(program(verdict=ProgramVerdict(update=UpdateFound(reason=reason))))
    last = picture.counters.last_step
    moved = last.after - last.before
    # a playback's values for unknown parts: terms that follow the estimate
    open_step = replace(last, step_size=1.0, gamma=1.0, gathered=last.after, discount=0.0, bootstrap=0.0)
    open_step = replace(open_step, bootstrap_state=-1, **changes)
    assert moved
    return changed(picture, algorithm=OWN_PROGRAM.id, last_step=open_step)


def failed() -> Snapshot:
    error = ProgramError(
        "IndexError",
        "index 16 is out of bounds for axis 0 with size 16",
        "/home/someone/frozen_lake.py",
        15,
        'Traceback (most recent call last):\n  File "/home/someone/frozen_lake.py", line 15, in <module>\n'
        "    q[s, a] += 0.1 * (r + 0.99 * q[s2].max() - q[s, a])\nIndexError: index 16 is out of bounds",
    )
    return watched(program(error=error, ended=True))


def drawn(
    kind: type[Panel], snapshot: Snapshot | None, width: int = 56, height: int = 20, **options: Any
) -> str:
    panel = sized(kind(look(**options)), width, height)
    panel.snapshot = snapshot
    rows = panel.picture(snapshot, width, height)
    assert [row.cell_length for row in rows] == [width] * height
    return "\n".join(row.text.rstrip() for row in rows)
