"""Play commands as a player does, without its thread."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import fields
from functools import partial
from pathlib import Path
from types import FrameType
from typing import Any, Final

import numpy as np

import rl_tui
from rl_tui.live.commands import ChooseLane, Command, Step
from rl_tui.live.playback import Playback
from rl_tui.live.record import Record
from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.recipe import Recipe
from rl_tui.runs.run import Run

_PACKAGE: Final = Path(rl_tui.__file__).parent
_COMPILED: Final = tuple(str(_PACKAGE / "agents" / each) for each in ("algorithms", "kernels", "policies"))
"""Folders of code that is compiled in the program, and interpreted in most tests."""


class Ticking:
    def __init__(self) -> None:
        self.now = 0.0

    def __call__(self) -> float:
        self.now += 0.02
        return self.now


def begin(made_from: Recipe, record: Record | None = None, *, automatic: bool = False) -> Playback:
    playback = Playback(
        made_from, speed=None, automatic=automatic, clock=Ticking(), on_exact=lambda: None, record=record
    )
    while playback.on_the_way:
        playback.work()
    return playback


def do(playback: Playback, *commands: Command) -> Snapshot:
    for command in commands:
        assert playback.takes(command)
        playback.handle(command)
        while playback.on_the_way:
            playback.work()
    return playback.snapshot()


def note_function(found: set[tuple[str, str]], frame: FrameType, event: str, _: object = None) -> None:
    """Leave out kernels, lambdas, comprehensions and generated methods of dataclasses."""
    code = frame.f_code
    is_ours = code.co_filename.startswith(str(_PACKAGE)) and not code.co_filename.startswith(_COMPILED)
    if event == "call" and is_ours and not code.co_name.startswith("<"):
        found.add((code.co_filename, code.co_qualname))


def functions_in(call: Callable[[], object]) -> set[tuple[str, str]]:
    """Return the functions of the program that run for ``call``."""
    found = set[tuple[str, str]]()
    before = sys.getprofile()
    sys.setprofile(partial(note_function, found))
    try:
        call()
    finally:
        sys.setprofile(before)
    return found


def functions_of(playback: Playback, command: Command) -> set[tuple[str, str]]:
    """Return the functions of the program that run for ``command`` and its snapshot."""
    return functions_in(partial(do, playback, command))


def bits(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return (value.dtype.str, value.tobytes())
    if hasattr(value, "__dataclass_fields__"):
        return [bits(getattr(value, each.name)) for each in fields(value)]
    return [bits(each) for each in value] if isinstance(value, (tuple, list)) else value


def stand(run: Run) -> Any:
    learner = run.learner
    known = [learner.q, learner.visits, learner.counters, run.results]
    known += [learner.algorithm, learner.hyperparameters, run.journal, run.stop_reason, run.over]
    return bits([*known, *(str(each.bit_generator.state) for each in learner.streams)])


def assert_true_to_the_record(playback: Playback) -> None:
    record = playback.record
    for number, lane in enumerate(record.lanes):
        playback.handle(ChooseLane(number))
        branch = lane.branches[lane.branch]
        straight = Run(lane.recipe, episode_limit=playback.group.current.run.world.budget)
        straight.follow(branch.journal, branch.here)
        assert stand(playback.group.current.run) == stand(straight)
    playback.handle(ChooseLane(record.shown))


def busy(playback: Playback) -> bool:
    return not playback.takes(Step())
