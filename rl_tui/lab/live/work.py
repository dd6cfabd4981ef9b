"""What is done in each state of a playback, for some milliseconds: a table, and a function for each."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Final

from rl_tui.lab.live.handlers import make_changes_that_waited
from rl_tui.lab.live.speed.compilation import LOOK_AGAIN
from rl_tui.lab.live.speed.pacing import AT_ONCE, CHUNK
from rl_tui.lab.live.state import State
from rl_tui.lab.live.stop_condition import until_in_words
from rl_tui.lab.live.until import Event

if TYPE_CHECKING:
    from rl_tui.lab.live.playback import Playback


def continue_seek(playback: Playback) -> float:
    """Bring runs nearer to where they have to be; where all are there, do again what was done before."""
    transport = playback.transport
    playback.waits = playback.compilation.waits(transport.steps_to_seek)
    if not playback.waits and transport.continue_seek(AT_ONCE):
        playback.go_on()
    elif transport.has_news():
        playback.changed = True
    return LOOK_AGAIN if playback.waits else 0.0


def _build(playback: Playback) -> float:
    playback.build()
    playback.changed = True
    return 0.0


def _continue_training(playback: Playback) -> float:
    if playback.compilation.waits(playback.steps_to_train):
        return LOOK_AGAIN
    playback.steps_to_train -= playback.transport.take_steps(playback.steps_to_train)
    if playback.steps_to_train == 0 or playback.group.current.run.over:
        playback.end_training()
    return 0.0


def _continue_rebuild(playback: Playback) -> float:
    """Make the changes whose world has come; with the last of them learning goes on."""
    if make_changes_that_waited(playback):
        return LOOK_AGAIN
    if playback.group.seeking:
        playback.seek()
    else:
        playback.go_on()
    return 0.0


def _continue_until(playback: Playback) -> float:
    """Go on until what is waited for has happened, or some milliseconds are over."""
    condition, until, run = playback.condition, playback.clock() + CHUNK, playback.group.current.run
    while condition is not None and playback.condition is condition:
        before = run.step
        steps = min(condition.stride or condition.steps, condition.steps - before)
        playback.transport.take_steps(steps, condition.episodes - run.learner.episodes)
        playback.changed = True
        playback.keep_pins()
        playback.stop_if_due()
        if run.step > before and condition.is_over(run) and not run.over:
            playback.rest()
            if condition.until.event is Event.EPISODE:
                playback.group.current.begun_at = run.step
            if condition.until.event is not Event.EPISODE_END:
                playback.paused_by = until_in_words(condition.until, run.world)
        if playback.clock() >= until:
            break
    return 0.0


def _continue_running(playback: Playback) -> float | None:
    if not playback.automatic:
        return _stand_still(playback)
    run, before = playback.group.current.run, playback.group.current.run.step
    wait = playback.transport.keep_pace()
    if run.step > before or run.over:
        playback.changed = True
        playback.stop_if_due()
    return wait


def _stand_still(playback: Playback) -> float | None:
    """Find out how the episodes under way went, then what was asked beside."""
    if not playback.automatic:
        return None
    group = playback.group
    had_news = not group.trails_are_whole
    if had_news:
        group.find_trails(CHUNK)
    goes_on = not group.trails_are_whole or playback.questions.work(group, playback.pins_beside.drawn)
    playback.changed = playback.changed or had_news or goes_on
    return 0.0 if goes_on else None


WORK: Final[Mapping[State, Callable[[Playback], float | None]]] = {
    State.BUILDING: _build,
    State.SEEKING: continue_seek,
    State.TRAINING: _continue_training,
    State.REBUILDING: _continue_rebuild,
    State.UNTIL: _continue_until,
    State.RUNNING: _continue_running,
    State.PAUSED: _stand_still,
    State.SPENT: _stand_still,
    State.DONE: _stand_still,
    State.STOPPED: _stand_still,
}
"""What a playback does in each state; in how many seconds to do more is returned, None for never."""
