"""The world check on screen."""

from __future__ import annotations

import json
import subprocess
import threading
from collections.abc import Callable, Iterator
from typing import Final

import pytest
from click.testing import CliRunner
from playing import begin, do
from recipes import recipe

from rl_tui.commands.main import program
from rl_tui.commands.reports.flip_points import check_document
from rl_tui.common.kiosk import VARIABLE
from rl_tui.live.commands import Apply, AskCheck, Step
from rl_tui.runs.background import background
from rl_tui.runs.recipe import EditWorld, SetParameter
from rl_tui.runs.run import Run
from rl_tui.studies.world_check import world_checks
from rl_tui.studies.world_check.report import CheckStage
from rl_tui.studies.world_check.world_checks import (
    BROKEN_OFF,
    IN_KIOSK,
    NO_PROCESS,
    WorldChecks,
    WorldCheckView,
)
from rl_tui.worlds.editing.edit import read_edits

LONGEST: Final = 120.0  # seconds for a process to answer
QUICK: Final = "random-walk"
"""A world in which each policy ends: the check needs no trials."""


def run_of(scenario: str) -> Run:
    return Run(recipe(scenario))


@pytest.mark.exhaustive("trains in a world of some size", but=["random-walk"])
@pytest.mark.process
@pytest.mark.parametrize("scenario", ["student", QUICK])
def test_a_snapshot_tells_what_the_command_prints_and_nothing_once_it_is_closed(scenario: str) -> None:
    playback = begin(recipe(scenario))
    assert playback.snapshot().world_check is None
    snapshot = do(playback, AskCheck(is_asked=True))
    view = snapshot.world_check
    assert view.report.stage is CheckStage.DONE
    printed = CliRunner().invoke(program, ["check", "--deep", scenario, "--json"])
    told = json.loads(json.dumps(check_document([], snapshot.world, view.report)))
    assert told == json.loads(printed.stdout)
    assert do(playback, AskCheck(is_asked=False)).world_check is None


@pytest.mark.process
def test_it_is_about_the_world_and_the_settings_in_force() -> None:
    playback = begin(recipe("bridge", gamma=0.9))

    def told() -> tuple[float | None, float, int]:
        view = playback.snapshot().world_check
        assert not view.is_outdated
        return view.report.best_return, view.gamma, len(view.report.never_reached or ())

    do(playback, AskCheck(is_asked=True))
    before = told()
    do(playback, Apply(SetParameter("gamma", 0.1)))
    assert told()[1] == 0.1
    do(playback, Apply(EditWorld(read_edits("world.step_reward=-0.25"))))
    do(playback, Step())
    after = told()
    assert before[0] is not None
    assert after[0] is not None
    assert after[0] < before[0]


# In its own process


class Beside:
    def __init__(self, processes: list[subprocess.Popen[bytes]]) -> None:
        self.processes = processes
        self.has_news = threading.Event()
        self.checks = WorldChecks(self.has_news.set, automatic=True)

    def until(self, run: Run, holds: Callable[[WorldCheckView], bool]) -> WorldCheckView:
        while True:
            self.has_news.clear()
            view = self.checks.of(run)
            if holds(view):
                return view
            assert self.has_news.wait(LONGEST)


def is_whole(view: WorldCheckView) -> bool:
    return view.report is not None and view.report.stage is CheckStage.DONE and not view.is_outdated


def has_figures(view: WorldCheckView) -> bool:
    return view.report is not None and not view.is_outdated


@pytest.fixture
def beside(processes: list[subprocess.Popen[bytes]]) -> Iterator[Beside]:
    made = Beside(processes)
    yield made
    made.checks.close()


@pytest.mark.exhaustive("tries every algorithm")
@pytest.mark.process
def test_figures_come_before_the_algorithms_are_tried(beside: Beside) -> None:
    run = run_of("student")
    assert beside.checks.of(run).report is None
    first = beside.until(run, has_figures).report
    assert (first.best_return, first.tried) == (7.5, None)
    last = beside.until(run, is_whole).report
    assert (last.best_return, len(last.flips or ())) == (7.5, 1)
    assert last.tried is not None
    assert len(beside.processes) == 1


@pytest.mark.exhaustive("works out the report of several worlds")
@pytest.mark.process
def test_of_many_changes_the_newest_counts_and_not_each_begins_a_process(beside: Beside) -> None:
    runs = [run_of("cliff") for _ in range(20)]  # each has its own world
    for run in runs:
        assert beside.checks.of(run).report is None
    assert len(beside.processes) == 1
    beside.until(runs[-1], has_figures)
    assert len(beside.processes) == 2
    assert beside.processes[0].wait(LONGEST) is not None
    other = run_of(QUICK)
    view = beside.checks.of(other)
    assert view.is_outdated
    assert view.world.space.states == 48, "the report goes on to be about its own world"
    assert beside.until(other, is_whole).report is not None
    assert beside.processes[1].wait(LONGEST) is not None


@pytest.mark.process
def test_what_was_worked_out_is_kept(beside: Beside) -> None:
    one, other = run_of(QUICK), run_of("max-bias")
    beside.until(one, is_whole)
    beside.until(other, is_whole)
    assert is_whole(beside.checks.of(one))
    assert len(beside.processes) == 2


@pytest.mark.process
@pytest.mark.parametrize("end", [WorldChecks.end, WorldChecks.close])
def test_its_process_ends_when_it_is_closed(beside: Beside, end: Callable[[WorldChecks], None]) -> None:
    beside.until(run_of("cliff"), has_figures)
    end(beside.checks)
    assert beside.processes[0].wait(LONGEST) is not None


@pytest.mark.process
def test_what_is_broken_off_keeps_its_figures_and_says_so(beside: Beside) -> None:
    run = run_of("cliff")
    beside.until(run, has_figures)
    beside.processes[0].kill()
    view = beside.until(run, lambda view: bool(view.refused))
    assert view.refused == BROKEN_OFF
    assert view.report.best_return == -13.0
    assert beside.checks.of(run).refused == BROKEN_OFF, "it is not begun again by itself"
    assert len(beside.processes) == 1


@pytest.mark.unit
def test_what_is_not_worked_out_says_why(beside: Beside, monkeypatch: pytest.MonkeyPatch) -> None:
    assert "no transition table" in beside.checks.of(run_of("blackjack")).refused
    monkeypatch.setattr(world_checks, "LIVE_STATES", 3)
    assert "rl-tui check --deep" in beside.checks.of(run_of("student")).refused
    monkeypatch.setenv(VARIABLE, "1")
    assert beside.checks.of(run_of("student")).refused == IN_KIOSK
    assert not beside.processes


@pytest.mark.unit
def test_where_no_process_can_be_started_the_reason_is_told(
    beside: Beside, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(*_: object) -> None:
        raise OSError("none left")

    monkeypatch.setattr(background, "python_process", fails)
    assert beside.checks.of(run_of("student")).refused == NO_PROCESS
