"""Whether a task is passed by who does nothing but let the run go on."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final

from rl_tui.common.errors import UserError
from rl_tui.common.findings import Finding, Location
from rl_tui.lab.experiments.training import Goal, train
from rl_tui.lab.lessons.judging.conditions import JudgedTask, verdict
from rl_tui.lab.lessons.judging.moment import Kept
from rl_tui.lab.lessons.judging.replays import OnEnd, ignore_end
from rl_tui.lab.lessons.judging.verdicts import Panels
from rl_tui.lab.run.library import episodes_of
from rl_tui.lab.run.recipe import begin
from rl_tui.lab.run.run import Run

EVERY_STEP: Final = 100
"""So many steps are judged one by one."""
EVERY_EPISODE: Final = 200
"""So many episodes are judged where they end: some conditions hold at no other step."""
ROUND: Final = (1_000, 10_000, 100_000)
MOST_STEPS: Final = 10_000_000
"""Further nobody waits."""
MOST_STEPPED: Final = 20_000
"""Nor so far where an environment is stepped for real, which takes its time."""


def waiting_findings(
    task: JudgedTask, where: Location, ends: Sequence[int], panels: Panels, on_end: OnEnd = ignore_end
) -> Iterator[Finding]:
    """Yield that the task is passed with its setup as it is and nothing done.

    It is judged at the start, at each of the first steps, at the end of each of the first episodes, after
    1,000 steps and more, after the usual number of episodes, and at the steps at which attempts ended:
    ``ends``. ``on_end`` hears of the run, and may raise.
    """
    beginning = begin(task.setup)
    run, kept = Run(task.setup, beginning, evaluate=False, episode_limit=beginning.world.budget), Kept()
    try:
        for _ in _moments(run, ends):
            if verdict(task, run, panels, kept).passed is not None:
                found = f"a pass after {run.step:,} steps in which nothing was done"
                yield Finding(where, found, "a task that cannot be passed by waiting")
                return
    except UserError:
        return  # it breaks down, as where an episode never ends: nobody waits any longer
    finally:
        on_end(run, _most(run))


def _moments(run: Run, ends: Sequence[int]) -> Iterator[None]:
    """Advance ``run`` from one moment to the next at which it is to be judged."""
    yield
    episodes = episodes_of(run.recipe.scenario)
    most = _most(run)
    wanted = {*range(1, EVERY_STEP + 1), *ROUND, *ends}
    targets = sorted(each for each in wanted if each <= most)
    while not run.over:
        target = next((each for each in targets if each > run.step), None)
        if target is None:
            break
        if run.learner.episodes < EVERY_EPISODE:
            run.advance(steps=target - run.step, episodes=1)
        else:
            train(run, Goal(steps=target))
        yield
    if run.learner.episodes < episodes and not run.over and _goes_on(run, Goal(episodes=episodes), most):
        yield


def _most(run: Run) -> int:
    """Return how far anybody waits."""
    return MOST_STEPS if run.learner.rewindable else MOST_STEPPED


class _TooLongError(Exception):
    """Nobody waits so long."""


def _goes_on(run: Run, goal: Goal, most: int) -> bool:
    """Advance ``run`` to ``goal``, and return whether it got there within ``most`` steps."""

    def on_progress(done: int, wanted: int) -> None:
        if run.step > most:
            raise _TooLongError

    try:
        train(run, goal, on_progress)
    except _TooLongError:
        return False
    return True
