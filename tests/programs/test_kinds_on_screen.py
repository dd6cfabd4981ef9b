"""Each kind of program on screen."""

from __future__ import annotations

from pathlib import Path

import pytest
import test_boxes
import test_old_gym
import test_own_worlds
from program_watching import watched
from test_notebooks import notebook_in
from test_program_playback import figures
from test_table_steps import CORRIDOR, GRID, LEARNER, TREASURE
from watched_scripts import LOOP, script_in

from rl_tui.live import commands
from rl_tui.live.last_step.step_report import program_terms
from rl_tui.live.pace.until import Event, Until
from rl_tui.programs.watched.child.worlds.first_steps import FEW_STEPS
from rl_tui.runs.recipe import SwitchAlgorithm

pytestmark = pytest.mark.process

_FIELD = test_own_worlds.field()
_UPDATE = "{0} += 0.1 * (r + 0.9 * max({1}) - {0})"
_KINDS = {
    "old gym": f"import gym\n{test_old_gym.MADE}\n{test_old_gym.LEARNING.format(**test_old_gym.OLD)}",
    "own class": _FIELD + test_own_worlds.learning("Q = np.zeros((16, 4))", "Q[s2]", "Q[s][a]"),
    "keys": _FIELD + test_own_worlds.learning("Q = defaultdict(lambda: [0.0] * 4)", "Q[s2]", "Q[s][a]"),
    "function": GRID,
    "function with names": TREASURE,
    "bins": test_boxes.cart_pole(test_boxes.ARRAY, "Q[$]", test_boxes.learning("Q[s][a]")),
    "loop": CORRIDOR.replace("{update}", _UPDATE.format("Q[place, a]", "Q[ahead]")),
    "learner": LEARNER.replace("{update}", "row[action] += 0.1 * (target - row[action])"),
}
_LATE = {"keys", "function with names"}
_REMADE = {"old gym", "notebook"}


def _script(kind: str, folder: Path) -> Path:
    return (
        notebook_in(folder, LOOP.format(episodes=300))
        if kind == "notebook"
        else script_in(folder, _KINDS[kind])
    )


@pytest.mark.parametrize("kind", [*_KINDS, "notebook"])
def test_time_goes_both_ways_and_runs_of_ours_are_offered_or_refused(kind: str, tmp_path: Path) -> None:
    with watched(_script(kind, tmp_path)) as watcher:
        watcher.do(commands.RunUntil(Until(Event.STEP, 300)))
        shown = {step: watcher.do(commands.GoTo(step=step)) for step in (3, 60, 120, 130)}
        for step in (60, 130, 3, 120):
            again = watcher.do(commands.GoTo(step=step))
            assert again.counters.step == step
            assert figures(again) == figures(shown[step])
            terms = program_terms(again.agent.row.update, again.program)
            is_late = kind in _LATE and step < FEW_STEPS
            assert ("changes are known after step 100" in terms.waiting) == is_late
            assert not (is_late and again.agent.q.any())
        assert watcher.do(commands.StepBack()).counters.step == 119
        assert (
            watcher.do(commands.EpisodeBack()).counters.episode_step <= 1
        )  # without a flag, an end is known by the next step

        aim = shown[130].counters.last_step.state
        watcher.do(commands.GoTo(step=300), commands.ToggleBreakpoint(state=aim))
        stopped = watcher.do(commands.RunUntil(Until(Event.EPISODE, 200)))
        assert (stopped.counters.state, stopped.counters.step > 300) == (aim, True)

        is_remade = kind in _REMADE
        assert stopped.world.is_remade == is_remade
        beside = watcher.do(commands.AddLane((SwitchAlgorithm("sarsa"),)))
        assert (beside.beside is not None) == is_remade
        assert is_remade or "only your program" in beside.playback.paused_by
        assert (beside.program.gamma is None) == (beside.world.mdp is None)

        first = figures(watcher.do(commands.GoTo(step=130)))
        watcher.do(commands.ClearBreakpoints(), commands.Restart(watcher.do().recipe))
        assert (
            figures(watcher.do(commands.RunUntil(Until(Event.STEP, 300)), commands.GoTo(step=130))) == first
        )
