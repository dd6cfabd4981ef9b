from __future__ import annotations

import itertools

import pytest
from playing import busy
from recipes import bandit, recipe, replay

from rl_tui.live import commands
from rl_tui.live.commands import (
    Apply,
    Command,
    LetPass,
    Pause,
    Play,
    Restart,
    RunEpisode,
    SetSpeed,
    Step,
    Train,
    WatchLearning,
)
from rl_tui.live.handlers import HANDLERS
from rl_tui.live.pace.pacing import FIRST_CHUNK
from rl_tui.live.playback import Playback
from rl_tui.live.program_playback import ProgramPlayback
from rl_tui.live.snapshot import Phase
from rl_tui.runs.recipe import JournalEntry, Recipe, SetParameter


class Clock:
    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now


def nobody() -> None:
    """A listener that waits for no exact values."""


def ready(
    made_from: Recipe, clock: Clock | None = None, *, speed: float | None = 10.0, automatic: bool = True
) -> Playback:
    playback = Playback(made_from, speed=speed, automatic=automatic, clock=clock or Clock(), on_exact=nobody)
    while busy(playback):
        assert playback.work() == 0.0
    return playback


def settle(playback: Playback) -> None:
    for _ in itertools.takewhile(lambda _: playback.on_the_way, itertools.count()):
        playback.work()


def test_the_world_is_shown_before_the_learner_is_there() -> None:
    playback = Playback(recipe("student"), speed=10.0, automatic=True, clock=Clock(), on_exact=nobody)
    playback.work()
    first = playback.snapshot()
    assert first.playback.phase is Phase.PREPARING
    assert first.playback.message
    assert first.world.space.states == 4
    assert first.agent.q.tolist() == [0.0] * 5
    assert busy(playback)
    playback.work()
    second = playback.snapshot()
    assert second.playback.phase is Phase.PAUSED
    assert second.world is first.world
    assert second.exact_answer.solution.value_at_start == pytest.approx(5.2 / 0.82)
    assert second.playback.speed == 10.0


def test_nothing_happens_without_being_asked() -> None:
    playback = ready(recipe("student"))
    playback.snapshot()
    assert playback.work() is None
    assert not playback.changed


def test_a_run_keeps_the_wanted_speed() -> None:
    clock = Clock()
    playback = ready(recipe("student"), clock)
    playback.handle(Play())
    wait = playback.work()
    assert playback.snapshot().counters.step == 1
    for step in range(2, 40):
        assert wait is not None
        clock.now += wait
        wait = playback.work()
        assert playback.snapshot().counters.step == step
    assert playback.snapshot().playback.steps_per_second == pytest.approx(10.0)
    assert playback.snapshot().playback.phase is Phase.RUNNING


def test_a_new_speed_counts_from_now_on() -> None:
    clock = Clock()
    playback = ready(recipe("student"), clock, speed=1.0)
    playback.handle(Play())
    playback.work()
    playback.handle(SetSpeed(30.0))
    for _ in range(30):
        wait = playback.work()
        assert wait is not None
        clock.now += wait
    playback.work()
    assert playback.snapshot().counters.step == 31
    assert playback.snapshot().playback.speed == 30.0


def test_full_speed_never_waits_until_it_is_paused() -> None:
    playback = ready(recipe("student"), speed=None)
    playback.handle(Play())
    assert [playback.work() for _ in range(3)] == [0.0, 0.0, 0.0]
    there = playback.snapshot()
    assert there.counters.step > 3
    assert there.playback.phase is Phase.RUNNING
    playback.handle(Pause())
    assert playback.work() is None
    assert playback.snapshot().counters.step == there.counters.step
    assert playback.snapshot().playback.phase is Phase.PAUSED


def test_step_pauses_and_takes_one_step() -> None:
    playback = ready(recipe("student"), speed=None)
    playback.handle(Play())
    playback.work()
    before = playback.snapshot().counters.step
    playback.handle(Step())
    after = playback.snapshot()
    assert after.counters.step == before + 1
    assert after.playback.phase is Phase.PAUSED
    assert after.counters.last_step.step == after.counters.step


def test_an_episode_runs_to_its_end_and_pauses() -> None:
    playback = ready(recipe("student", seed=2))
    playback.handle(RunEpisode())
    assert playback.snapshot().playback.phase is Phase.RUNNING
    settle(playback)
    first = playback.snapshot()
    assert (first.counters.episodes, first.counters.episode_step, first.playback.phase) == (
        1,
        0,
        Phase.PAUSED,
    )
    playback.handle(Step())
    playback.handle(RunEpisode())
    settle(playback)
    assert playback.snapshot().counters.episodes == 2


def test_pause_breaks_off_an_episode() -> None:
    playback = ready(recipe("student"))
    playback.handle(RunEpisode())
    playback.handle(Pause())
    assert not playback.on_the_way
    assert playback.snapshot().counters.episodes == 0


@pytest.mark.parametrize("automatic", [True, False])
def test_training_takes_exactly_its_steps_before_anything_else(automatic: bool) -> None:
    playback = ready(recipe("frozenlake-slippery"), automatic=automatic)
    playback.handle(Train(12_345))
    assert busy(playback)
    playback.work()
    assert not playback.changed
    settle(playback)
    assert playback.changed
    snapshot = playback.snapshot()
    assert snapshot.counters.step == 12_345
    assert snapshot.playback.phase is Phase.PAUSED
    straight = replay(snapshot.recipe, (), 12_345)
    assert snapshot.agent.q.tolist() == straight.learner.q.tolist()


def test_by_hand_play_takes_no_step_and_speed_stays_unknown() -> None:
    clock = Clock()
    playback = ready(recipe("student"), clock, speed=None, automatic=False)
    playback.handle(Play())
    assert playback.work() is None
    playback.handle(Train(500))
    settle(playback)
    clock.now += 1
    playback.handle(Train(500))
    settle(playback)
    snapshot = playback.snapshot()
    assert snapshot.playback.phase is Phase.RUNNING
    assert snapshot.counters.step == 1000
    assert snapshot.playback.steps_per_second is None
    playback.handle(RunEpisode())
    assert busy(playback)
    settle(playback)
    assert playback.snapshot().playback.phase is Phase.PAUSED


def played(*commands_: Command) -> Playback:
    playback = ready(recipe("frozenlake"), automatic=False)
    for command in commands_:
        assert playback.takes(command)
        playback.handle(command)
        settle(playback)
    return playback


@pytest.mark.parametrize(("speed", "steps"), [(3.0, 6), (10.0, 20), (1_000.0, 2_000), (None, 200_000)])
def test_by_hand_time_passes_on_request_and_only_for_a_run_that_is_running(
    speed: float | None, steps: int
) -> None:
    begin = SetSpeed(speed), Play()
    whole, pieces = played(*begin, LetPass(120)), played(*begin, *[LetPass(4)] * 30)
    assert whole.snapshot().counters.step == pieces.snapshot().counters.step == steps
    assert whole.snapshot().playback.phase is Phase.RUNNING
    still = played(SetSpeed(speed), LetPass(120), *begin, Pause(), LetPass(120))
    assert still.snapshot().counters.step == 0
    assert played(*begin, LetPass(60), Pause(), Play(), LetPass(60)).snapshot().counters.step == steps


def test_by_hand_a_run_that_follows_learning_does_not_depend_on_the_pieces_and_pictures_of_its_time() -> None:
    whole, pieces = played(WatchLearning(), LetPass(300)), played(WatchLearning())
    for _ in range(75):
        pieces.handle(LetPass(4))
        settle(pieces)
        shown = pieces.snapshot()
    assert (shown.counters.step, shown.playback.speed) == (
        whole.snapshot().counters.step,
        whole.snapshot().playback.speed,
    )
    assert shown.agent.q.any()


def test_changes_are_journalled_at_the_step_they_came() -> None:
    playback = ready(recipe("student"))
    playback.handle(Step())
    playback.handle(Apply(SetParameter("gamma", 0.5)))
    playback.handle(Apply(SetParameter("alpha", 1.0)))
    playback.handle(Step())
    snapshot = playback.snapshot()
    assert snapshot.agent.hyperparameters.gamma == 0.5
    assert snapshot.exact_answer.solution.gamma == 0.5
    journal = (JournalEntry(1, SetParameter("gamma", 0.5)), JournalEntry(1, SetParameter("alpha", 1.0)))
    assert snapshot.agent.q.tolist() == replay(snapshot.recipe, journal, 2).learner.q.tolist()


def test_a_change_that_does_not_fit_is_refused() -> None:
    playback = ready(recipe("student"))
    playback.handle(Apply(SetParameter("gamma", 2)))
    snapshot = playback.snapshot()
    assert snapshot.playback.paused_by.startswith("gamma is 2; expected a number in [0, 1]")
    assert (snapshot.agent.hyperparameters.gamma, snapshot.timeline.current.journal) == (0.9, ())


def test_a_spent_budget_ends_the_run() -> None:
    playback = ready(bandit(100), speed=None)
    playback.handle(Play())
    while playback.work() is not None:
        pass
    spent = playback.snapshot()
    assert spent.playback.phase is Phase.SPENT
    assert spent.results.bandit.pulls == spent.counters.episodes == 100
    for command in (Play(), Step(), RunEpisode(), Train(5), Pause()):
        playback.handle(command)
        assert playback.work() is None
    assert playback.snapshot().counters.episodes == 100
    assert playback.snapshot().playback.phase is Phase.SPENT


def test_restarting_begins_anew_and_paused() -> None:
    playback = ready(recipe("student"), speed=None)
    playback.handle(Play())
    playback.work()
    before = playback.snapshot()
    playback.handle(Restart(recipe("student", seed=7)))
    again = playback.snapshot()
    assert (again.counters.step, again.playback.phase, again.recipe.seed) == (0, Phase.PAUSED, 7)
    assert again.agent.visits.sum() == 0
    assert again.playback.speed is before.playback.speed


def test_restarting_keeps_a_world_that_no_seed_shapes_and_draws_one_that_it_does() -> None:
    lake = recipe("student")
    playback = ready(lake)
    world = playback.snapshot().world
    playback.handle(Restart(lake))
    assert playback.snapshot().world is world
    arms = recipe("bandit", seed=1)
    playback.handle(Restart(arms))
    first = playback.snapshot().world
    playback.handle(Restart(Recipe(arms.scenario, arms.algorithm, arms.hyperparameters, seed=2)))
    second = playback.snapshot().world
    assert first.mdp.reward.tolist() != second.mdp.reward.tolist()


def test_a_planner_that_is_done_goes_on_with_another_discount() -> None:
    playback = ready(recipe("frozenlake", algorithm="value-iteration"), speed=None)
    playback.handle(Play())
    while playback.phase is Phase.RUNNING:
        playback.work()
    done = playback.snapshot()
    assert done.playback.phase is Phase.DONE
    assert done.playback.message.startswith(f"converged after {done.counters.episodes} sweeps")
    assert done.results.return_last_100 is None
    playback.handle(Play())
    assert playback.phase is Phase.DONE
    playback.handle(Apply(SetParameter("gamma", 0.5)))
    assert playback.phase is Phase.PAUSED
    playback.handle(Play())
    while playback.phase is Phase.RUNNING:
        playback.work()
    again = playback.snapshot()
    assert again.playback.phase is Phase.DONE
    assert abs(again.agent.q - again.exact_answer.solution.q).max() < 1e-8


@pytest.mark.parametrize(
    "command", [Apply(SetParameter("planning_steps", 10_000)), Restart(recipe("student", seed=1))]
)
def test_how_long_a_step_takes_is_found_out_anew_after_a_change(command: Apply | Restart) -> None:
    playback = ready(recipe("student"), speed=None)
    playback.handle(Play())
    for _ in range(8):
        playback.work()
    assert playback.snapshot().counters.step > 1_000
    playback.handle(command)
    before = playback.snapshot().counters.step
    playback.handle(Play())
    playback.work()
    assert playback.snapshot().counters.step - before == FIRST_CHUNK


def test_there_is_a_handler_for_every_command() -> None:
    kinds = {each for each in vars(commands).values() if isinstance(each, type) and issubclass(each, Command)}
    of_programs = {commands.ChooseTable}  # ours have one table each
    assert set(HANDLERS) == kinds - {Command} - of_programs
    assert set(ProgramPlayback.handlers) == kinds - {Command}


def test_the_speed_of_training_is_forgotten_by_the_next_step() -> None:
    clock = Clock()
    playback = ready(recipe("student"), clock, speed=None)
    playback.handle(Train(10))
    while playback.on_the_way:
        playback.work()
        clock.now += 0.3
    assert playback.snapshot().playback.steps_per_second is not None
    playback.handle(Step())
    assert playback.snapshot().playback.steps_per_second is None
