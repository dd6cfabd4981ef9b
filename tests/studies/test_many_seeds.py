"""A study of many seeds."""

from __future__ import annotations

import math
import os
import signal
import statistics
import subprocess
import sys
import time
import weakref
from collections.abc import Callable
from dataclasses import replace
from itertools import count
from pathlib import Path
from typing import Any

import pytest
from playing import begin, do
from programs.watched_scripts import lives, wait_until
from recipes import recipe

import rl_tui
from rl_tui.common.kiosk import VARIABLE
from rl_tui.live.commands import (
    AddLane,
    Apply,
    ChooseBranch,
    ChooseLane,
    Command,
    DropLane,
    EndStudy,
    GoTo,
    Play,
    Restart,
    Step,
    StudySeeds,
    Take,
    Train,
    is_taken_while_seeking,
)
from rl_tui.live.playback import Playback
from rl_tui.live.player import Player
from rl_tui.live.snapshot import Phase
from rl_tui.runs.background import background
from rl_tui.runs.figures import training_figures
from rl_tui.runs.recipe import Recipe, SetParameter, SwitchAlgorithm
from rl_tui.runs.run import Run
from rl_tui.runs.timeline.run_group import RunGroup
from rl_tui.runs.training.many_runs import many_runs
from rl_tui.runs.training.seeded_runs import Goal, SeededRuns, train
from rl_tui.studies.many_seeds import request as seed_studies
from rl_tui.studies.many_seeds import study
from rl_tui.studies.many_seeds.figures import Estimate, LaneStudy, SeedStudy, StudyState
from rl_tui.studies.many_seeds.request import StudyRequest, study_request
from rl_tui.studies.many_seeds.study import Study, difference_of

pytestmark = pytest.mark.process

HOME = str(Path(rl_tui.__file__).parents[1])
LONGEST = 60.0
GREEDY = AddLane((SetParameter("epsilon", 0.0),))


def studied(made_from: Recipe, *before: Command) -> SeedStudy:
    told = do(begin(made_from), *before, StudySeeds()).study
    assert told is not None
    return told


def requested(made_from: Recipe, *before: Command, most: int = 8) -> StudyRequest:
    playback = begin(made_from)
    do(playback, *before)
    return replace(study_request(playback.group, is_awaited=True), most=most)


def reports(made_from: Recipe, *before: Command, most: int = 8) -> list[SeedStudy]:
    return list(Study(requested(made_from, *before, most=most)).reports())


def assert_equal_to_runs(lane: LaneStudy, document: dict[str, Any]) -> None:
    there = {name: each for name, each in document["summary"].items() if each["count"]}
    assert list(lane.estimates) == list(there)
    for name, each in there.items():
        assert lane.estimates[name] == Estimate(each["mean"], each["stderr"], each["count"])
        values = [run[name] for run in document["runs"] if run[name] is not None]
        assert lane.seeds[name].tolist() == values
    assert lane.this_seed.items() <= document["runs"][0].items()
    assert lane.curve.episode.tolist() == document["curve"]["episode"]
    assert lane.curve.mean.tolist() == document["curve"]["return_mean"]
    assert lane.curve.stderr.tolist() == document["curve"]["return_stderr"]


# Equal to train --runs


@pytest.mark.parametrize(
    ("scenario", "steps"), [("bandit", 300), ("student", 2_000), ("frozenlake-slippery", 900)]
)
def test_the_figures_are_those_of_train_runs_to_the_bit(scenario: str, steps: int) -> None:
    made_from = recipe(scenario, 3)
    told = studied(made_from, Train(steps))
    assert (told.state, told.seeds, told.most, told.steps) == (StudyState.DONE, 8, 8, None)
    assert told.episodes is not None
    assert_equal_to_runs(told.lanes[0], many_runs(made_from, 8, Goal(episodes=told.episodes)))


def test_it_grows_by_doubling() -> None:
    made_from = recipe("bandit")
    told = reports(made_from, Train(40), most=32)
    assert [each.seeds for each in told] == [8, 16, 32]
    assert [each.state for each in told] == [StudyState.RUNNING, StudyState.RUNNING, StudyState.DONE]
    for each in told:
        assert_equal_to_runs(each.lanes[0], many_runs(made_from, each.seeds, Goal(episodes=40)))


def test_what_was_set_on_the_way_counts() -> None:
    made_from = recipe("student")
    changes = (Train(100), Apply(SetParameter("gamma", 0.5)), Train(100), Apply(SwitchAlgorithm("sarsa")))
    playback = begin(made_from)
    told = do(playback, *changes, Train(300), StudySeeds()).study
    assert (told.episodes, told.steps) == (None, 500)
    journal, figures = playback.record.lanes[0].branches[0].journal, []
    for seed in range(8):
        run = Run(replace(made_from, seed=seed), evaluate=False)
        figures.append(training_figures(run, train(run, Goal(steps=500), journal=journal)))
    for name, each in told.lanes[0].estimates.items():
        assert each.mean == statistics.fmean(row[name] for row in figures if row[name] is not None)
    alone = do(begin(made_from), Train(500)).results
    assert told.lanes[0].this_seed["return_last_100"] != alone.return_last_100


def test_this_seed_is_the_run_on_screen() -> None:
    playback = begin(recipe("bandit"))
    told = do(playback, Train(150), StudySeeds())
    this_seed = told.study.lanes[0].this_seed
    assert this_seed["winnings"] == told.results.bandit.winnings
    assert this_seed["regret"] == told.results.bandit.regret
    assert this_seed["return_last_100"] == told.results.return_last_100
    assert this_seed["return_mean"] == told.results.bandit.winnings / 150


def test_beside_a_planner_this_seed_is_the_run_on_screen() -> None:
    changes = (Train(300), Apply(SwitchAlgorithm("value-iteration")), Train(300))
    told = do(begin(recipe("student")), *changes, StudySeeds())
    this_seed = told.study.lanes[0].this_seed
    assert (this_seed["steps"], told.study.steps) == (told.counters.step, told.counters.step)
    assert this_seed["expected_return"] == told.results.greedy_return
    assert f"{told.counters.step:,} steps" in told.study.message


def test_every_seed_has_every_change() -> None:
    request = requested(recipe("cliff"), Train(3_000), Apply(SetParameter("epsilon", 1.0)), Train(60))
    assert (request.episodes, request.steps) == (None, 3_060)


def test_lanes_have_as_many_episodes_as_the_one_with_the_fewest() -> None:
    playback = begin(recipe("cliff"))
    do(playback, AddLane((SetParameter("epsilon", 1.0),)), Train(4_000))
    finished = [run.learner.episodes for run in playback.group.runs]
    assert study_request(playback.group, is_awaited=True).episodes == min(finished) < finished[0]


@pytest.mark.exhaustive("runs a large world under many seeds")
def test_finished_runs_of_a_large_world_do_not_stay_in_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(study, "COLLECTED_ABOVE", 0)
    monkeypatch.setattr(study, "BATCHED_BELOW", 0)
    trained, row = list[weakref.ref[Run]](), SeededRuns.row

    def noted(runs: SeededRuns, run: Run, check: Callable[[], None]) -> dict[str, Any]:
        trained.append(weakref.ref(run))
        return row(runs, run, check)

    monkeypatch.setattr(SeededRuns, "row", noted)
    reports(recipe("student"), Train(100))
    assert [run() for run in trained] == [None] * 8


def test_it_waits_until_the_run_is_where_it_stood() -> None:
    assert not is_taken_while_seeking(StudySeeds(), None)


def test_there_is_none_of_a_world_too_large(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("rl_tui.studies.many_seeds.request.MOST_PAIRS", 3)
    assert "3 state–action pairs" in refusal_of(begin(recipe("student")))


# Lanes


def test_lanes_are_held_against_each_other_seed_by_seed() -> None:
    made_from = recipe("bandit")
    told = studied(made_from, GREEDY, Train(60), ChooseLane(1))
    assert (len(told.lanes), told.shown) == (2, 1)
    plain = many_runs(made_from, 8, Goal(episodes=60))["runs"]
    other = many_runs(recipe("bandit", epsilon=0.0), 8, Goal(episodes=60))["runs"]
    assert not told.lanes[1].differences
    for name in ("return_mean", "return_last_100", "winnings", "regret", "value_at_start", "expected_return"):
        each = told.lanes[0].differences[name]
        pairs = [(b[name], a[name]) for a, b in zip(plain, other, strict=True)]
        less = [mine - its for mine, its in pairs]
        assert each.mean.mean == pytest.approx(sum(less) / 8)
        assert each.mean.stderr == pytest.approx(statistics.stdev(less) / math.sqrt(8))
        assert each.greater == sum(mine > its for mine, its in pairs)
        assert each.equal == sum(mine == its for mine, its in pairs)


def test_a_difference_is_of_seeds_that_have_both() -> None:
    found = difference_of([1.0, None, 5.0, 2.0], [0.0, 3.0, 7.0, 2.0])
    assert (found.mean.mean, found.mean.count, found.greater, found.equal) == (pytest.approx(-1 / 3), 3, 1, 1)
    assert difference_of([None], [1.0]) is None


# Bounds


def test_each_seed_has_as_many_episodes_as_the_run_but_no_more_than_usual() -> None:
    made_from = recipe("student")
    assert requested(made_from).episodes == 500
    few = requested(made_from, Train(300))
    assert few.episodes == do(begin(made_from), Train(300)).counters.episodes < 500
    many = requested(made_from, Train(6_000))
    assert (many.episodes, few.message) == (500, "")
    assert "500" in many.message


def test_seeds_that_take_too_many_steps_are_ended_by_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(study, "MOST_STEPS", 500)
    made_from = recipe("student")
    first, *told = reports(made_from, most=16)
    assert (first.state, first.seeds, first.lanes) == (StudyState.RUNNING, 0, ())
    assert [(each.seeds, each.steps, each.episodes) for each in told] == [(8, 500, None), (16, 500, None)]
    assert "500 steps" in told[-1].message
    document = many_runs(made_from, 8, Goal(steps=500))
    assert_equal_to_runs(told[0].lanes[0], document)
    summary = many_runs(made_from, 16, Goal(steps=500))["summary"]
    for name, each in told[1].lanes[0].estimates.items():
        assert each == Estimate(*(summary[name][key] for key in ("mean", "stderr", "count")))
    fewest = summary["episodes"]["min"]
    assert told[1].lanes[0].curve.episode[-1] <= fewest
    assert told[1].lanes[0].curve.episode[0] == document["curve"]["episode"][0]


@pytest.mark.parametrize(("ticks", "seeds"), [(3, 0), (32, 6), (110, 16)])
def test_it_ends_when_its_time_is_up(ticks: int, seeds: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(study, "BATCHED_BELOW", 0)  # otherwise one clock serves many seeds
    now, slow = count(), study.MOST_SECONDS / ticks
    made_from = recipe("student")
    told = list(Study(requested(made_from, Train(300), most=64), lambda: next(now) * slow).reports())
    assert (told[-1].state, told[-1].seeds) == (StudyState.OUT_OF_TIME, seeds)
    if seeds:
        goal = Goal(episodes=told[-1].episodes)
        assert_equal_to_runs(told[-1].lanes[0], many_runs(made_from, seeds, goal))
    else:
        assert told[-1].message


def test_a_stepped_environment_has_eight_seeds() -> None:
    playback = begin(recipe("blackjack"))
    do(playback, Train(50))
    request = study_request(playback.group, is_awaited=False)
    assert request.most == 8
    assert "8" in request.message
    told = do(playback, StudySeeds()).study
    assert told.state is StudyState.DONE
    assert told.episodes is not None
    assert_equal_to_runs(told.lanes[0], many_runs(recipe("blackjack"), 8, Goal(episodes=told.episodes)))
    table = begin(recipe("student"))
    assert study_request(table.group, is_awaited=False).most == 256


# Runs without a study


def refusal_of(playback: Playback, *before: Command, state: StudyState = StudyState.REFUSED) -> str:
    snapshot = do(playback, *before, Play(), StudySeeds())
    assert (snapshot.study.state, snapshot.study.lanes) == (state, ())
    assert snapshot.playback.phase is Phase.RUNNING
    return snapshot.study.message


def test_a_planner_alone_has_no_luck() -> None:
    assert "planner" in refusal_of(begin(recipe("student", algorithm="value-iteration")))


def test_runs_that_differ_in_their_seed_have_no_other_seeds_to_differ_in() -> None:
    assert "c e" in refusal_of(begin(recipe("student")), AddLane(next_seed=True))


def test_a_planner_beside_an_agent_is_worked_out_with_it() -> None:
    told = studied(recipe("student"), AddLane((SwitchAlgorithm("value-iteration"),)), Train(100))
    assert told.state is StudyState.DONE
    planner = told.lanes[1]
    assert planner.estimates["expected_return"].stderr == 0.0
    assert "return_mean" not in planner.estimates
    assert planner.differences["expected_return"].mean.count == 8
    assert not len(planner.curve.episode)


def test_a_planner_in_a_world_drawn_from_the_seed_is_worked_out() -> None:
    told = studied(recipe("bandit", algorithm="value-iteration"))
    assert told.state is StudyState.DONE
    assert (told.lanes[0].estimates["expected_return"].stderr or 0.0) > 0.0


def test_there_are_none_in_a_kiosk(monkeypatch: pytest.MonkeyPatch) -> None:
    playback = begin(recipe("student"))
    monkeypatch.setenv(VARIABLE, "1")
    assert "kiosk" in refusal_of(playback)


def test_where_no_process_can_be_started_it_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "executable", "")
    assert refusal_of(begin(recipe("student")), state=StudyState.FAILED)


PRINTS = """
import gymnasium, os, sys

class Loud(gymnasium.Env):
    observation_space = gymnasium.spaces.Discrete(3)
    action_space = gymnasium.spaces.Discrete(2)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        print("hear me"), os.write(1, b"hear me"), os.write(2, b"hear me")
        self.taken = 0
        return 0, {}

    def step(self, action):
        self.taken += 1
        if os.path.exists(BROKEN):
            raise RuntimeError("out of breath")
        return self.taken % 3, float(action), self.taken == 3, False, {}

gymnasium.register("Loud-v0", Loud)
"""


def test_what_an_environment_prints_goes_nowhere_and_its_failure_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    broken = tmp_path / "broken"
    (tmp_path / "loud_world.py").write_text(PRINTS.replace("BROKEN", repr(str(broken))))
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr("rl_tui.worlds.gym.modules.ALLOWED", {"loud_world"})
    playback = begin(recipe("gym:loud_world:Loud-v0"))
    do(playback, Train(6))
    capfd.readouterr()
    told = do(playback, StudySeeds()).study
    assert (told.state, told.seeds) == (StudyState.DONE, 8)
    broken.touch()
    told = do(playback, StudySeeds()).study
    assert told.state is StudyState.FAILED
    assert told.message.startswith("seed 0: ")
    assert "out of breath" in told.message
    assert capfd.readouterr() == ("", "")


# The runs it covers


class ToldAtOnce:
    """A process that has sent all its messages at its start."""

    failed = how_long = ""

    def __init__(self, work: str, request: StudyRequest, known: SeedStudy, *_: object) -> None:
        self.known = known

    def wait(self) -> None:
        """Nothing is under way."""

    def end(self) -> None:
        """Nothing is left."""


def test_it_is_outdated_where_runs_were_changed_and_only_there(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(background, "AnsweringProcess", ToldAtOnce)
    playback = begin(recipe("student"))

    def is_outdated(*commands: Command) -> bool:
        told = do(playback, *commands).study
        return told.is_outdated

    start = playback.group.current.recipe
    do(playback, AddLane((SetParameter("alpha", 0.9),)), Train(50))
    assert not is_outdated(StudySeeds(), Step(), Train(100), GoTo(step=10), ChooseLane(1), ChooseLane(0))
    assert is_outdated(Apply(SetParameter("alpha", 0.7)))
    assert is_outdated(ChooseBranch(1))
    assert not is_outdated(ChooseBranch(0))
    for command in (Take(1), AddLane((SetParameter("epsilon", 0.5),)), DropLane(1)):
        assert not is_outdated(StudySeeds())
        assert is_outdated(command)
    assert not is_outdated(Restart(start), StudySeeds(), Restart(start))
    assert is_outdated(Restart(replace(start, seed=1)))
    assert do(playback, EndStudy()).study is None


# Its process


def long_study() -> Playback:
    made_from = recipe("student", algorithm="dyna-q")
    playback = Playback(made_from, speed=None, automatic=True, clock=time.perf_counter, on_exact=lambda: None)
    while playback.on_the_way:
        playback.work()
    playback.handle(StudySeeds())
    return playback


def is_gone(process: subprocess.Popen[bytes]) -> bool:
    return process.returncode is not None  # its thread has waited for it


@pytest.mark.parametrize(
    "command", [EndStudy(), StudySeeds(), Restart(recipe("bandit"))], ids=lambda c: type(c).__name__
)
def test_a_study_under_way_ends(command: Command, processes: list[subprocess.Popen[bytes]]) -> None:
    playback = long_study()
    playback.handle(command)
    wait_until(lambda: is_gone(processes[0]))
    told = playback.snapshot().study
    assert (told is None) == (not isinstance(command, StudySeeds))
    playback.questions.seed_studies.close()
    for process in processes:
        wait_until(lambda process=process: is_gone(process))
    playback.handle(StudySeeds())
    assert len(processes) == 1 + isinstance(command, StudySeeds)


async def test_it_ends_with_the_player_and_two_players_have_each_their_own(
    processes: list[subprocess.Popen[bytes]], monkeypatch: pytest.MonkeyPatch
) -> None:
    def awaited(group: RunGroup, **_: bool) -> StudyRequest:  # other tests already run at the lowest priority
        return replace(study_request(group, is_awaited=True), most=256)

    monkeypatch.setattr(seed_studies, "study_request", awaited)
    players = [Player(recipe(scenario), speed=None) for scenario in ("student", "bandit")]
    for player in players:
        player.send(StudySeeds())
    seen = []
    for player in players:
        grown = []
        async for snapshot in player.snapshots():
            if snapshot.study is not None:
                grown.append(snapshot.study)
                if snapshot.study.seeds >= 16:
                    break
        player.close()
        assert all(each.seeds in (0, 8, 16, 32, 64, 128, 256) for each in grown)
        assert [each.seeds for each in grown] == sorted(each.seeds for each in grown)
        seen.append(grown[-1])
    assert "winnings" not in seen[0].lanes[0].estimates
    assert "winnings" in seen[1].lanes[0].estimates
    for process in processes:
        wait_until(lambda process=process: is_gone(process))
    assert len(processes) == 2


PARENT = """
import sys, time
from rl_tui.runs.background import background
start = background.python_process

def noted(*args):
    process = start(*args)
    print(process.pid, flush=True)
    return process

background.python_process = noted
from rl_tui.live.commands import StudySeeds
from rl_tui.live.playback import Playback
from rl_tui.runs.library import recipe_named
made_from = recipe_named("student", {"algorithm": "dyna-q"})
playback = Playback(made_from, speed=None, automatic=True, clock=time.perf_counter, on_exact=lambda: None)
while playback.on_the_way:
    playback.work()
playback.handle(StudySeeds())
time.sleep(3600)
"""


@pytest.mark.parametrize(("number", "is_running"), [(signal.SIGKILL, True), (signal.SIGTERM, False)])
def test_it_ends_with_its_parent_however_that_ends(number: signal.Signals, is_running: bool) -> None:
    parent = subprocess.Popen(
        [sys.executable, "-c", PARENT],
        env=os.environ | {"PYTHONPATH": HOME},
        stdout=subprocess.PIPE,
        text=True,
    )
    child = int(parent.stdout.readline())
    assert os.getsid(child) == child
    if is_running:
        wait_until(lambda: os.getpriority(os.PRIO_PROCESS, child) == 19)
    parent.send_signal(number)
    parent.communicate(timeout=LONGEST)
    wait_until(lambda: not lives(child))
