"""The prompt for a moment of the run: a step, an episode, a share of the way, one of the ends."""

from __future__ import annotations

import re
from typing import Final

from rl_tui.lab.live.commands import GoTo
from rl_tui.lab.live.snapshot import Snapshot
from rl_tui.tui.panels.snapshot_facts import episodes_begun
from rl_tui.tui.screens.dialogs.prompt import Prompt
from rl_tui.worlds.drawing import Arms

_GO_ON: Final = "esc, then space goes on from there"
_STEPS: Final = ("", "step", "steps", "pull", "pulls")  # a pull is a step
_EPISODES: Final = ("e", "ep", "episode", "episodes", "sweep", "sweeps")
_NUMBER: Final = r"\d{1,18}|\d{1,3}(?:,\d{3}){1,5}"
_SHARE: Final = re.compile(r"(\d{1,18}(?:\.\d+)?)\s*%", re.ASCII)
_MOMENT: Final = re.compile(rf"([a-z]*)\s*({_NUMBER})", re.ASCII)


def goto_prompt(snapshot: Snapshot) -> Prompt:
    """Return the prompt; it answers the text typed, out of which :func:`parse_goto` makes the command."""

    def read(text: str) -> str:
        parse_goto(text, snapshot)
        return text

    return Prompt("Go to", _expected(snapshot), str(snapshot.timeline.current.here), read, "go")


def parse_goto(text: str, snapshot: Snapshot) -> GoTo:
    """Return where ``text`` points to; raises ValueError saying what was expected."""
    end = snapshot.timeline.current.end
    text = text.strip().lower()
    if text in ("start", "end"):
        return GoTo(0 if text == "start" else end)
    share = _SHARE.fullmatch(text)
    if share:
        if float(share[1]) > 100.0:
            raise ValueError("a share goes from 0% to 100%")
        return GoTo(round(end * float(share[1]) / 100.0))
    moment = _MOMENT.fullmatch(text)
    if not moment or moment[1] not in _STEPS + _EPISODES:
        raise ValueError("that is none of these")
    number = int(moment[2].replace(",", ""))
    if moment[1] in _EPISODES:
        return _episode(number, snapshot)
    if number > end:
        raise ValueError(f"the run has come to step {end:,} so far; {_GO_ON}")
    return GoTo(number)


def _episode(number: int, snapshot: Snapshot) -> GoTo:
    """Return where an episode begins. How many there are is only known in the present, not in the past."""
    unit = unit_of(snapshot)
    begun = episodes_begun(snapshot)
    if number < 1:
        raise ValueError(f"{unit}s count from 1")
    if number > begun and not snapshot.timeline.in_past:
        raise ValueError(f"the run has come to {unit} {begun:,} so far; {_GO_ON}")
    return GoTo(episode=number)


def unit_of(snapshot: Snapshot) -> str:
    """Return what the steps of this run come in: episodes, or the sweeps of a planner."""
    return "sweep" if snapshot.agent.row.planner else "episode"


def _expected(snapshot: Snapshot) -> str:
    """Return what may be typed, naming the range."""
    end = snapshot.timeline.current.end
    if snapshot.agent.row.planner:
        first = f"a step from 0 to {end:,}, sweep 12"
    elif isinstance(snapshot.world.drawing, Arms):
        first = f"a pull from 0 to {end:,}"
    else:
        first = f"a step from 0 to {end:,}, e12 for episode 12"
    return f"{first}, 50%, start or end"
