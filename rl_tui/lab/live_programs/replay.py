"""Forward through what was recorded: from a moment of the past to a later one."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rl_tui.lab.live.until import Event, Until
from rl_tui.lab.live_programs.progress import steps_between

if TYPE_CHECKING:
    from rl_tui.lab.live_programs.history_of_program import ProgramHistory


def recorded_step(until: Until, history: ProgramHistory) -> int | None:
    """Return after how many steps ``until`` happened, from the moment shown on.

    None where the recording has nothing of the kind, or it is no event of the steps alone.
    """
    shown, newest = history.shown, history.newest
    match until.event:
        case Event.STEP if shown.step < until.number <= newest.step:
            return until.number
        case Event.EPISODE if shown.episodes < until.number - 1 <= newest.episodes:
            return history.begin_of_episode(until.number)
        case Event.EPISODE_END if shown.episodes + until.number < newest.episodes:
            return history.begin_of_episode(shown.episodes + until.number + 2)
        case Event.REWARD:
            rewards = steps_between(history.recording, shown.step, newest.step).reward
            rewarded = np.flatnonzero(rewards)
            return shown.step + int(rewarded[0]) + 1 if len(rewarded) else None
    return None
