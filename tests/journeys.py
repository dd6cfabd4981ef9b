"""The time to jump to any step of a long run."""

from __future__ import annotations

import random
import time
from collections.abc import Iterator

from rl_tui.live.commands import Apply, Command, GoTo, StepBack, Train
from rl_tui.live.playback import Playback
from rl_tui.runs.library import find, recipe_for
from rl_tui.runs.recipe import SetParameter


def journeys(scenario: str, steps: int, count: int = 100) -> Iterator[tuple[str, float]]:
    playback = Playback(
        recipe_for(find(scenario)),
        speed=None,
        automatic=False,
        clock=time.perf_counter,
        on_exact=lambda: None,
    )
    _carry_out(playback)
    _do(playback, Train(steps // 2))
    _do(playback, Apply(SetParameter("alpha", 0.2)))
    _do(playback, Train(steps - steps // 2))
    aims, episodes = random.Random(0), playback.snapshot().counters.episodes
    for _ in range(count):
        yield "anywhere", _do(playback, GoTo(aims.randrange(steps)))
    for _ in range(count):
        yield "episode", _do(playback, GoTo(episode=aims.randrange(1, episodes + 2)))
    _do(playback, GoTo(steps))
    for _ in range(count):
        yield "one step back", _do(playback, StepBack())


def _do(playback: Playback, command: Command) -> float:
    start = time.perf_counter()
    playback.handle(command)
    _carry_out(playback)
    playback.snapshot()
    return (time.perf_counter() - start) * 1e3


def _carry_out(playback: Playback) -> None:
    while playback.on_the_way:
        playback.work()
