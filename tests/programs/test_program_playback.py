"""Playing a watched program."""

from __future__ import annotations

import time
from collections.abc import Callable, Container
from contextlib import closing
from pathlib import Path

import numpy as np
import pytest
from playing import functions_in, functions_of
from program_watching import LEARNS, Watcher, watched, written

from rl_tui.agents.catalogue import OWN_PROGRAM
from rl_tui.common.errors import UserError
from rl_tui.live import commands
from rl_tui.live.pace.until import Event, Until
from rl_tui.live.program_playback import ProgramPlayback
from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.live.state import State
from rl_tui.programs.diagnosis import verdicts
from rl_tui.programs.evidence.verdict import Rule
from rl_tui.programs.watched.program_process import ProgramRequest
from rl_tui.programs.watched.watched_program import WatchedProgram
from rl_tui.runs.recipe import SetParameter, SwitchAlgorithm

pytestmark = pytest.mark.process


def figures(snapshot: Snapshot) -> tuple[object, ...]:
    counters, results, last = snapshot.counters, snapshot.results, snapshot.counters.last_step
    moved = None if last is None else (last.pair, last.next_state, last.reward)
    return (
        *(counters.step, counters.episodes, counters.state, counters.episode_step, moved),
        *(counters.episode_return, counters.rewards.tolist(), counters.discounted_return),
        *(snapshot.agent.q.tolist(), snapshot.agent.visits.tolist()),
        *(results.return_last_100, results.length_last_100, results.greedy_return),
        *(results.curve.return_mean.tolist(), results.marks.expected_return.tolist()),
        *(results.marks.step.tolist(), snapshot.trail),
    )


def test_it_stands_before_its_first_step(tmp_path: Path) -> None:
    with watched(written(tmp_path)) as watcher:
        snapshot = watcher.do()
    assert snapshot.playback.phase is Phase.PAUSED
    assert (snapshot.counters.step, snapshot.counters.last_step) == (0, None)
    assert (snapshot.program.title, snapshot.program.environment) == ("student.py", "FrozenLake-v1")
    assert snapshot.world.mdp is not None


def test_a_step_is_one_step_with_all_that_it_changed(tmp_path: Path) -> None:
    with watched(written(tmp_path)) as watcher:
        for step in range(1, 6):
            assert watcher.do(commands.Step()).counters.step == step
        rewarded = watcher.do(commands.RunUntil(Until(Event.REWARD)))
    last = rewarded.counters.last_step
    assert last.reward == 1.0
    assert (last.before, last.after) == (0.0, pytest.approx(0.1))
    assert rewarded.agent.q[last.updated_pair] == last.after


def test_few_functions_run_from_a_step_to_its_snapshot(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Lower this number when the way becomes shorter. The diagnosis does not count."""
    with watched(written(tmp_path, episodes=2_000)) as watcher:
        shown = watcher.do(commands.Train(2_000), commands.Step())
        assert shown.program is not None
        verdict = shown.program.verdict
        assert verdict.update.rule is Rule.Q_LEARNING
        monkeypatch.setattr(verdicts, "verdict_of", lambda _: verdict)
        watcher.do(commands.Step())
        assert min(len(functions_of(watcher.playback, commands.Step())) for _ in range(3)) <= 102


def test_few_functions_run_for_a_step_as_on_screen(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The same with a look at the program's file, and the work at rest."""
    with watched(written(tmp_path, episodes=2_000)) as watcher:
        shown = watcher.do(commands.Train(2_000), commands.Step())
        assert shown.program is not None
        verdict = shown.program.verdict
        monkeypatch.setattr(verdicts, "verdict_of", lambda _: verdict)
        watcher.do(commands.Step())
        watcher.playback.automatic = True
        counts = []
        for _ in range(3):
            watcher.playback.work()
            step = functions_of(watcher.playback, commands.Step())
            counts.append(len(step | functions_in(watcher.playback.work)))
        assert min(counts) <= 109


def test_an_episode_ends_where_the_environment_ends_it(tmp_path: Path) -> None:
    with watched(written(tmp_path)) as watcher:
        first = watcher.do(commands.RunEpisode())
        second = watcher.do(commands.RunEpisode())
    for number, snapshot in enumerate((first, second), start=1):
        last = snapshot.counters.last_step
        assert snapshot.counters.episodes == number
        assert last.terminated or last.truncated
    assert len(second.results.curve.episode) == 2


def test_it_runs_until_a_step_an_episode_a_value_and_an_optimal_policy(tmp_path: Path) -> None:
    with watched(written(tmp_path)) as watcher:
        assert watcher.do(commands.RunUntil(Until(Event.STEP, 37))).counters.step == 37
        assert watcher.do(commands.RunUntil(Until(Event.EPISODE, 20))).counters.episodes == 19
        changed = watcher.do(commands.RunUntil(Until(Event.POLICY_CHANGE)))
        last = changed.counters.last_step
        pair = last.updated_pair
        reached = watcher.do(commands.RunUntil(Until(Event.VALUE, pair=pair, threshold=0.3)))
        assert reached.agent.q[pair] >= 0.3
        optimal = watcher.do(commands.RunUntil(Until(Event.OPTIMAL)))
        assert optimal.results.greedy_return == 1.0
        before = watcher.do(commands.StepBack())
        assert before.results.greedy_return != 1.0


def test_what_lies_behind_is_refused_in_a_sentence(tmp_path: Path) -> None:
    with watched(written(tmp_path)) as watcher:
        watcher.do(commands.Train(50))
        assert "is in the past" in watcher.do(commands.RunUntil(Until(Event.STEP, 10))).playback.paused_by


def test_a_breakpoint_stops_it_at_the_very_step(tmp_path: Path) -> None:
    with watched(written(tmp_path)) as watcher:
        watcher.do(commands.ToggleBreakpoint(state=4))
        snapshot = watcher.do(commands.RunUntil(Until(Event.EPISODE, 100)))
        assert snapshot.counters.state == 4
        assert snapshot.playback.paused_by == "breakpoint: state 4"
        pair = snapshot.world.space.pair_of(4, 0)
        watcher.do(commands.ClearBreakpoints(), commands.ToggleBreakpoint(pair=pair))
        taken = watcher.do(commands.RunUntil(Until(Event.EPISODE, 100))).counters.last_step
        assert taken.pair == pair


def test_what_is_shown_of_the_past_is_what_was_shown_then(tmp_path: Path) -> None:
    with watched(written(tmp_path)) as watcher:
        shown = {}
        for step in (7, 100, 333, 800, 1_500):
            shown[step] = figures(watcher.do(commands.RunUntil(Until(Event.STEP, step))))
        for step in (100, 1_500, 7, 800, 333):
            assert figures(watcher.do(commands.GoTo(step=step))) == shown[step]


def test_back_and_episode_back_and_on_from_the_newest_step(tmp_path: Path) -> None:
    with watched(written(tmp_path)) as watcher:
        watcher.do(commands.Train(200))
        back = watcher.do(commands.StepBack())
        assert back.counters.step == 199
        assert back.timeline.in_past
        began = watcher.do(commands.EpisodeBack())
        assert began.counters.episode_step == 0
        assert began.counters.is_at_beginning
        assert began.counters.state == began.counters.step_from == 0
        earlier = watcher.do(commands.EpisodeBack())
        assert earlier.counters.episodes == began.counters.episodes - 1
        third = watcher.do(commands.GoTo(episode=3))
        assert (third.counters.episodes, third.counters.episode_step) == (2, 0)
        assert watcher.do(commands.RunUntil(Until(Event.EPISODE, 5))).counters.is_at_beginning
        assert not watcher.do(commands.GoTo(third.counters.step)).counters.is_at_beginning
        on = watcher.do(commands.GoTo(step=190), commands.Play(), commands.Pause())
        assert (on.counters.step, on.timeline.in_past) == (200, False)


def test_forward_through_the_past_and_on_where_the_recording_ends(tmp_path: Path) -> None:
    with watched(written(tmp_path)) as watcher:
        first = [watcher.do(commands.RunEpisode()).counters.step for _ in range(20)]
        rewarded = watcher.do(commands.RunUntil(Until(Event.REWARD))).counters.step
        newest = watcher.do(commands.Train(5)).counters.step
        watcher.do(commands.GoTo(step=3))
        assert [watcher.do(commands.Step()).counters.step for _ in range(2)] == [4, 5]
        watcher.do(commands.GoTo(step=0))
        again = [watcher.do(commands.RunEpisode()) for _ in range(20)]
        assert [shown.counters.step for shown in again] == first
        assert all(shown.timeline.in_past and shown.playback.steps_per_second is None for shown in again)
        for until, expected in (
            (Until(Event.REWARD), rewarded),
            (Until(Event.STEP, newest - 1), newest - 1),
            (Until(Event.EPISODE, 5), first[3]),
            (Until(Event.EPISODE_END, 2), first[2]),
            (Until(Event.STEP, newest + 3), newest + 3),
        ):
            watcher.do(commands.GoTo(step=0))
            assert watcher.do(commands.RunUntil(until)).counters.step == expected
        shown = watcher.do(commands.GoTo(step=newest + 2), commands.Step())
        assert (shown.counters.step, shown.timeline.in_past) == (newest + 3, False)
        assert watcher.do(commands.Step()).counters.step == newest + 4


def test_its_end_is_said_and_all_stays_on_screen(tmp_path: Path) -> None:
    with watched(written(tmp_path, episodes=5)) as watcher:
        snapshot = watcher.do(commands.Train(10_000))
        assert snapshot.playback.phase is Phase.SPENT
        assert snapshot.playback.message
        assert snapshot.counters.episodes == 5
        assert snapshot.program.ended
        assert watcher.do(commands.GoTo(step=3)).counters.step == 3


@pytest.mark.parametrize(
    ("line", "words", "known"),
    # a killed program loses its unsent messages
    [("1 / 0", "ZeroDivisionError", (4,)), ("import os; os.kill(os.getpid(), 9)", "SIGKILL", range(5))],
    ids=["raises", "is killed"],
)
def test_a_program_that_breaks_down_stops_at_its_step(
    tmp_path: Path, line: str, words: str, known: Container[int]
) -> None:
    text = LEARNS.replace("    done = False", f"    done = False\n    if episode == 4: {line}")
    with watched(written(tmp_path, text)) as watcher:
        snapshot = watcher.do(commands.Train(10_000))
    assert snapshot.playback.phase is Phase.STOPPED
    assert words in snapshot.playback.message
    assert snapshot.counters.episodes in known


def test_without_an_environment_it_is_refused_in_a_sentence(tmp_path: Path) -> None:
    program = WatchedProgram(ProgramRequest(written(tmp_path, "print('hello')")))
    try:
        with pytest.raises(UserError, match="before its first step: nothing to watch, because"):
            program.wait_for_environment()
    finally:
        program.end()


def test_without_a_table_all_else_lives(tmp_path: Path) -> None:
    text = """
import gymnasium
env = gymnasium.make("FrozenLake-v1")
for _ in range(20):
    env.reset(); ended = False
    while not ended:
        ended = any(env.step(env.action_space.sample())[2:4])
"""
    with watched(written(tmp_path, text)) as watcher:
        snapshot = watcher.do(commands.Train(60))
    assert snapshot.program.table is None
    assert snapshot.program.looked_for
    assert snapshot.results.greedy_return is None
    assert np.isnan(snapshot.results.marks.expected_return).all()
    assert snapshot.counters.step == 60
    assert snapshot.agent.visits.sum() == 60  # the next state is known even without estimates
    assert not snapshot.agent.q.any()


def test_the_update_that_was_found_is_said_part_by_part(tmp_path: Path) -> None:
    with watched(written(tmp_path)) as watcher:
        found = watcher.do(commands.Train(1_500))
    last = found.counters.last_step
    assert found.agent.algorithm == "q-learning"
    assert found.agent.hyperparameters.alpha == pytest.approx(0.1)
    assert found.agent.hyperparameters.gamma == pytest.approx(0.99)
    assert found.agent.author is None
    assert last.after == pytest.approx(last.before + last.step_size * (last.target - last.before))
    assert found.program.gamma_source == "found"
    assert found.exact_answer.solution is not None


def test_while_the_update_is_unknown_the_program_stands_for_it(tmp_path: Path) -> None:
    with watched(written(tmp_path)) as watcher:
        snapshot = watcher.do(commands.Train(3))
    assert snapshot.agent.learned_by[0] == OWN_PROGRAM.id
    assert snapshot.agent.row is OWN_PROGRAM


def test_lines_are_looked_at_again_once_something_is_found(tmp_path: Path) -> None:
    text = LEARNS.replace("epsilon = 0.1,", "epsilon = 1.5,")
    with watched(written(tmp_path, text)) as watcher:
        found = watcher.do(commands.Train(2_000))
        lines = watcher.playback.lead.program.log.lines
        assert found.program.verdict.findings
        at_first = sum(lines.values())
        watcher.do(commands.Train(3_000))
        assert sum(lines.values()) >= at_first + 40
        again = sum(lines.values())
        watcher.do(commands.Train(4_000))
        assert sum(lines.values()) == again  # for the same finding once


def test_started_again_it_does_the_same_again(tmp_path: Path) -> None:
    with watched(written(tmp_path)) as watcher:
        first = figures(watcher.do(commands.Train(400)))
        recipe = watcher.do().recipe
        assert watcher.do(commands.Restart(recipe)).counters.step == 0
        assert figures(watcher.do(commands.Train(400))) == first


def test_what_cannot_be_done_to_a_program_is_said_in_a_sentence(tmp_path: Path) -> None:
    refused = (
        commands.Apply(SetParameter("alpha", 0.5)),
        commands.Apply(SwitchAlgorithm("sarsa")),
        commands.Take(1),
        commands.WatchLearning(),
        commands.ChooseBranch(0),
        commands.ChooseLane(1),
        commands.StudySeeds(),
    )
    with watched(written(tmp_path)) as watcher:
        before = watcher.do(commands.Step())
        words = [watcher.do(command).playback.paused_by for command in refused]
        after = watcher.do()
    assert all(words)
    assert "student.py" in words[0]
    assert figures(after) == figures(before)


def test_ours_beside_it_comes_to_the_same_step(tmp_path: Path) -> None:
    with watched(written(tmp_path)) as watcher:
        watcher.do(commands.Train(300))
        beside = watcher.do(commands.AddLane((SwitchAlgorithm("sarsa"),)))
        _assert_beside(beside, 300)
        _assert_beside(watcher.do(commands.Train(100)), 400)
        _assert_beside(watcher.do(commands.GoTo(step=50)), 50)
        alone = watcher.do(commands.DropLane(1))
    assert alone.beside is None
    assert not alone.run_group.lanes


def _assert_beside(snapshot: Snapshot, step: int) -> None:
    other = snapshot.beside
    assert other.agent.algorithm == "sarsa"
    assert (snapshot.counters.step, other.counters.step) == (step, step)
    assert [lane.step for lane in snapshot.run_group.lanes] == [step, step]


def test_a_cell_is_followed_through_its_changes(tmp_path: Path) -> None:
    with watched(written(tmp_path)) as watcher:
        rewarded = watcher.do(commands.RunUntil(Until(Event.REWARD))).counters.last_step
        history = watcher.do(commands.FollowCell(rewarded.pair), commands.Train(200)).cell
    assert history.value[0] == 0.0
    assert history.value[list(history.step).index(rewarded.step)] == pytest.approx(0.1)


def test_two_environments_take_turns(tmp_path: Path) -> None:
    text = LEARNS.replace(
        "    s, _ = env.reset()",
        """    if episode % 2:
        test.reset()
        for _ in range(2):
            test.step(2)
    s, _ = env.reset()""",
    ).replace("q = np", 'test = gym.make("FrozenLake-v1", is_slippery=False)\nq = np')
    with watched(written(tmp_path, text)) as watcher:
        snapshot = watcher.do(commands.Train(400))
        shown = figures(snapshot)
        watcher.do(commands.Train(100))
        assert figures(watcher.do(commands.GoTo(step=400))) == shown


def test_blackjack_has_naturals_and_an_exact_answer(tmp_path: Path) -> None:
    text = """
import gymnasium, collections
import numpy as np
env = gymnasium.make("Blackjack-v1", sab=True)
q = collections.defaultdict(lambda: np.zeros(2))
rng = np.random.default_rng(0)
for _ in range(400):
    s, _ = env.reset(); ended = False
    while not ended:
        a = int(rng.integers(2))
        s2, r, terminated, truncated, _ = env.step(a)
        q[s][a] += 0.1 * (r + (0 if terminated else q[s2].max()) - q[s][a])
        s, ended = s2, terminated or truncated
"""
    with watched(written(tmp_path, text)) as watcher:
        snapshot = watcher.do(commands.Train(300))
        last = snapshot.counters.last_step
    assert snapshot.world.mdp is not None
    assert last is not None
    assert snapshot.results.greedy_return is not None


def test_the_file_saved_again_starts_it_again_and_says_what_became_better(tmp_path: Path) -> None:
    slow = LEARNS.replace("alpha, gamma, epsilon = 0.1", "alpha, gamma, epsilon = 0.0")
    with closing(_Editor(tmp_path, slow)) as editor:
        playback = editor.playback
        editor.trained(1_500)
        editor.path.write_text("this is no Python")
        editor.until_it_says("not restarted")
        assert "line 1" in playback.restarts.words
        assert playback.lead.history.newest.step == 1_500
        editor.path.write_text(LEARNS.replace("EPISODES", "300"))
        _until(editor.watcher, lambda: playback.lead.history.newest.step == 0)
        editor.trained(1_600, "better than before: ")
        assert "it was 0" in playback.restarts.words


def _until(watcher: Watcher, is_there: Callable[[], bool]) -> None:
    deadline = time.monotonic() + 60
    while not is_there():
        watcher.playback.work()
        assert time.monotonic() < deadline


def test_on_from_the_past_of_one_that_has_ended_is_its_last_moment(tmp_path: Path) -> None:
    with watched(written(tmp_path, episodes=3)) as watcher:
        ended = watcher.do(commands.Train(10_000))
        last = ended.counters.step - 1
        for command in (commands.Step(), commands.Play(), commands.RunEpisode(), commands.Train(5)):
            past = watcher.do(commands.GoTo(step=last))
            assert past.timeline.in_past
            # no episode ended there: the screen counts the current one, like the last step
            assert past.playback.phase is Phase.PAUSED
            on = watcher.do(command)
            assert figures(on) == figures(ended)
            assert on.playback.phase is Phase.SPENT


def test_a_breakpoint_set_on_the_way_does_not_change_what_is_counted(tmp_path: Path) -> None:
    with watched(written(tmp_path, episodes=100_000)) as watcher:
        playback = watcher.playback
        watcher.do(commands.Train(3))
        begun = playback.lead.history.newest.episodes
        playback.handle(commands.RunUntil(Until(Event.EPISODE_END, 900)))
        for number in range(10):  # holes 5 and 7 end an episode: no step leaves them
            playback.work()
            playback.handle(
                commands.ToggleBreakpoint(pair=playback.lead.program.world.world.space.pair_of(5, 0))
            )
            assert playback.state is State.UNTIL, number
        assert watcher.do().counters.episodes == begun + 901


def test_what_the_diagnosis_stumbles_over_is_said_and_ends_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def stumbles(_: object) -> object:
        raise ZeroDivisionError("of all things")

    monkeypatch.setattr("rl_tui.programs.diagnosis.verdicts.verdict_of", stumbles)
    with watched(written(tmp_path)) as watcher:
        snapshot = watcher.do(commands.Train(200))
    assert snapshot.counters.step == 200
    assert "of all things" in snapshot.program.verdict.notes[0]


def test_each_episode_begins_where_the_one_before_it_ended(tmp_path: Path) -> None:
    with watched(written(tmp_path)) as watcher:
        watcher.do(commands.Train(1_500))
        history = watcher.playback.lead.history
        steps = history.recording.steps
        ends = np.flatnonzero(steps.terminated | steps.truncated) + 1
        begins = [history.begin_of_episode(number) for number in range(1, len(ends) + 2)]
        assert begins == [0, *ends]
        assert history.begin_of_episode(len(ends) + 2) == 1_500


def test_a_cell_is_followed_anew_as_it_goes_on_and_into_the_past(tmp_path: Path) -> None:
    with watched(written(tmp_path)) as watcher:
        rewarded = watcher.do(commands.RunUntil(Until(Event.REWARD))).counters.last_step
        shown = [watcher.do(commands.FollowCell(rewarded.pair)).cell]
        shown += [watcher.do(commands.Train(150)).cell for _ in range(4)]
        changes = watcher.playback.lead.history.recording.changes
        mine = (
            changes.step[changes.cell == watcher.playback.lead.program.world.cell_of_pair[rewarded.pair]] + 1
        )
        for history, step in zip(shown, (0, 150, 300, 450, 600), strict=True):
            assert set(mine[mine <= rewarded.step + step]) <= set(history.step)
        then, now = shown[1], watcher.do(commands.GoTo(step=rewarded.step + 150)).cell
        assert (now.step.tolist(), now.value.tolist()) == (then.step.tolist(), then.value.tolist())


class _Editor:
    """A watched program whose file is saved again. Time passes with each look."""

    def __init__(self, folder: Path, text: str = LEARNS) -> None:
        self.path = written(folder, text)
        clock = iter(range(10**9))
        program = WatchedProgram(ProgramRequest(self.path))
        program.wait_for_environment()
        self.playback = ProgramPlayback(program, lambda: None, clock=lambda: next(clock) / 10)
        self.watcher = Watcher(self.playback)
        self.close = self.playback.close

    def until_it_says(self, words: str) -> None:
        _until(self.watcher, lambda: words in self.playback.restarts.words)

    def saved(self, text: str, words: str) -> None:
        other = self.path.with_suffix(".new")
        other.write_text(text)
        self.path.unlink()
        _until(self.watcher, lambda: True)
        other.rename(self.path)
        self.until_it_says(words)

    def trained(self, steps: int, words: str = "") -> None:
        self.playback.handle(commands.Train(steps))
        _until(self.watcher, lambda: not self.playback.on_the_way)
        self.until_it_says(words)


def test_what_is_saved_may_be_worse_shorter_or_broken(tmp_path: Path) -> None:
    with closing(_Editor(tmp_path)) as editor:
        playback = editor.playback
        editor.trained(1_200)
        episodes = playback.lead.history.newest.episodes
        playback.handle(commands.GoTo(step=100))  # while the past is on screen
        editor.saved(LEARNS.replace("EPISODES", "300").replace("= 0.1,", "= 0.0,"), "from its seed")
        assert (playback.lead.history.in_past, playback.lead.history.newest.step) == (False, 0)
        editor.trained(5_000, f"after {episodes} episodes, worse than before")
        editor.saved(LEARNS.replace("EPISODES", "2"), "from its seed")
        editor.trained(1_300, "at its end, ")
        assert "after 2 episodes" in playback.restarts.words
        ended = playback.lead.history.newest.step
        editor.saved("import gymnasium\nraise ValueError('no more')\n", "ValueError")
        assert "line 2" in playback.restarts.words
        assert playback.lead.history.newest.step == ended
        editor.path.unlink()
        playback.handle(commands.Restart(playback.snapshot().recipe))
        _until(editor.watcher, lambda: not playback.restarts.is_awaited)
        assert playback.restarts.words
        assert playback.lead.history.newest.step == ended
