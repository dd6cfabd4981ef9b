"""Whether training waits for machine code."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from types import SimpleNamespace

import pytest

from rl_tui.agents.compiling.background import BACKGROUND
from rl_tui.agents.kernels.machine_code import Loop
from rl_tui.runs.library import recipe_named
from rl_tui.runs.run import Run
from rl_tui.runs.training import compile_or_interpret as patience
from rl_tui.runs.training import many_runs, seeded_runs
from rl_tui.runs.training.compile_or_interpret import (
    FIRST_LOOK,
    SURE_ENOUGH,
    WORTH_COMPILING,
    WORTH_READING,
    Patience,
)
from rl_tui.runs.training.seeded_runs import Goal, train

pytestmark = pytest.mark.interpreted

LOOP = Loop("q-learning", "epsilon-greedy", stepped=False)
OTHER = Loop("sarsa", "epsilon-greedy", stepped=False)


@dataclass
class Learner:
    loop: Loop = LOOP
    is_compiled: bool = False


@dataclass
class Machine:
    now: float = 100.0
    cores: int = 2
    noted: set[Loop] = field(default_factory=set)
    asked: list[tuple[str, Loop]] = field(default_factory=list)
    can_read: bool = True

    def read(self, loop: Loop) -> bool:
        self.asked.append(("load", loop))
        return self.can_read

    def want(self, loops: Iterable[Loop]) -> None:
        self.asked += [("want", loop) for loop in loops]

    def get(self, loop: Loop) -> bool:
        self.asked.append(("compile", loop))
        self.now += 8.0
        return True


@pytest.fixture
def machine(monkeypatch: pytest.MonkeyPatch) -> Machine:
    machine = Machine()
    monkeypatch.setattr(patience, "time", SimpleNamespace(perf_counter=lambda: machine.now))
    monkeypatch.setattr(patience, "cores", lambda: machine.cores)
    monkeypatch.setattr(patience, "was_compiled", lambda loop: loop in machine.noted)
    monkeypatch.setattr(BACKGROUND, "read", machine.read)
    monkeypatch.setattr(BACKGROUND, "get", machine.get)
    monkeypatch.setattr(BACKGROUND, "want", machine.want)
    return machine


def after_a_look(
    machine: Machine, seconds_left: float, learner: Learner | None = None, spent: float = SURE_ENOUGH
) -> Patience:
    learner, looks = learner or Learner(), Patience()
    looks.look(learner, 0, 1)  # type: ignore[arg-type]
    machine.now += spent * 1.01
    wanted = round(1000 * (1 + seconds_left / (spent * 1.01)))
    looks.look(learner, 1000, wanted)  # type: ignore[arg-type]
    return looks


def test_short_training_asks_for_nothing(machine: Machine) -> None:
    after_a_look(machine, WORTH_READING * 0.9)
    machine.noted.add(LOOP)
    after_a_look(machine, WORTH_READING * 0.9)
    assert machine.asked == []


def test_what_is_in_the_cache_is_read_at_once(machine: Machine) -> None:
    machine.noted.add(LOOP)
    after_a_look(machine, WORTH_READING * 1.1, spent=FIRST_LOOK)
    assert machine.asked == [("load", LOOP)]


def test_what_is_not_is_asked_for_only_where_it_comes_in_time(machine: Machine) -> None:
    after_a_look(machine, WORTH_COMPILING * 0.9)
    assert machine.asked == []
    after_a_look(machine, WORTH_COMPILING * 1.1, spent=FIRST_LOOK)
    assert machine.asked == []  # it is too early to be sure
    after_a_look(machine, WORTH_COMPILING * 1.1)
    assert machine.asked == [("want", LOOP)]


def test_a_long_first_episode_says_nothing_yet(machine: Machine) -> None:
    machine.noted.add(LOOP)
    learner, looks = Learner(), Patience()
    looks.look(learner, 0, 5)  # type: ignore[arg-type]
    machine.now += WORTH_READING * 0.9
    looks.look(learner, 0, 5)  # type: ignore[arg-type]
    assert machine.asked == []
    machine.now += WORTH_READING * 0.9
    looks.look(learner, 0, 5)  # type: ignore[arg-type]
    assert machine.asked == [("load", LOOP)]


def test_what_cannot_be_read_is_tried_once(machine: Machine) -> None:
    machine.noted.add(LOOP)
    machine.can_read = False
    learner = Learner()
    looks = after_a_look(machine, WORTH_COMPILING * 0.9, learner)
    machine.now += 1.0
    looks.look(learner, 2000, 5000)  # type: ignore[arg-type]
    assert machine.asked == [("load", LOOP)]


def test_a_note_without_machine_code_is_asked_for(machine: Machine) -> None:
    machine.noted.add(LOOP)
    machine.can_read = False
    after_a_look(machine, WORTH_COMPILING * 1.1)
    assert machine.asked == [("load", LOOP), ("want", LOOP)]


def test_on_one_core_it_waits_and_says_for_how_long(machine: Machine) -> None:
    machine.cores = 1
    learner, looks = Learner(), Patience()
    looks.look(learner, 0, 1)  # type: ignore[arg-type]
    machine.now += 1.0
    assert looks.look(learner, 1, 1000) == 8.0  # type: ignore[arg-type]
    assert machine.asked == [("compile", LOOP)]


def test_it_asks_once_for_each_loop(machine: Machine) -> None:
    learner = Learner()
    looks = after_a_look(machine, 100.0, learner)
    for done in (2000, 3000):
        machine.now += 1.0
        looks.look(learner, done, 10**9)  # type: ignore[arg-type]
    learner.loop = OTHER
    for done in (4000, 5000):
        machine.now += 1.0
        looks.look(learner, done, 10**9)  # type: ignore[arg-type]
    assert machine.asked == [("want", LOOP), ("want", OTHER)]


def test_the_looks_become_rarer_and_stop_with_machine_code(machine: Machine) -> None:
    learner, looks = Learner(), Patience()
    first = looks.chunk(learner)  # type: ignore[arg-type]
    for done in range(3):
        looks.look(learner, done, 10**9)  # type: ignore[arg-type]
    assert looks.chunk(learner) == first * 4  # type: ignore[arg-type]
    learner.is_compiled = True
    assert looks.chunk(learner) > 10**6  # type: ignore[arg-type]
    assert looks.look(learner, 3, 10**9) == 0.0  # type: ignore[arg-type]
    assert machine.asked == []


@pytest.mark.parametrize(
    ("seconds", "noted", "expected"),
    [
        (WORTH_READING * 0.9, True, False),
        (WORTH_READING * 1.1, True, True),
        (WORTH_COMPILING * 0.9, False, False),
        (WORTH_COMPILING * 1.1, False, True),
    ],
)
def test_many_runs_wait_where_it_pays(
    machine: Machine, monkeypatch: pytest.MonkeyPatch, seconds: float, noted: bool, expected: bool
) -> None:
    if noted:
        machine.noted.add(LOOP)
    monkeypatch.setattr(seeded_runs, "seconds_interpreted", lambda *_, **__: seconds / 4)
    said: list[str] = []
    figures = many_runs.many_runs(
        recipe_named("student", {}, 0), 4, Goal(episodes=3), on_compiling=lambda: said.append("compiling")
    )
    assert len(figures["runs"]) == 4
    assert machine.asked == ([("compile", LOOP)] if expected else [])
    assert said == (["compiling"] if expected else [])


def test_rows_until_ctrl_c_are_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    lengths: list[int] = []
    run = Run(
        recipe_named("student", {}, 0),
        evaluate=False,
        on_episodes=lambda returns, each, optimal: lengths.extend(each.tolist()),
    )

    def interrupt(done: int, wanted: int) -> None:
        if done >= 10:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        train(run, Goal(episodes=10**6), interrupt)
    assert len(lengths) == run.learner.episodes >= 10
