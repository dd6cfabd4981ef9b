"""Realistic programs: what they do is understood, faults are found, and correct code is not blamed."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest
from corpus import CORRECT, FAULTY, Program, line_of
from test_old_gym import NOTE
from watched_scripts import script_in, watched

from rl_tui.programs.diagnosis.diagnosis import verdict_of
from rl_tui.programs.evidence.verdict import CodeFault

pytestmark = pytest.mark.process

OWN = """\
import copy as copying, gymnasium as own_gym
class Own:
    def __init__(self, *arguments, **more):
        self.inner = copying.deepcopy(own_gym.make(*arguments, **more))
        self.action_space, self.observation_space = self.inner.action_space, self.inner.observation_space
        self.action_space.seed(0)
        self.seed = 0
    def reset(self, **more):
        if self.seed is not None:
            more.setdefault("seed", self.seed)
        self.seed = None
        return self.inner.reset(**more)
    def step(self, action):
        return self.inner.step(action)
    def __getattr__(self, name):
        if name.startswith("__") or name == "inner":
            raise AttributeError(name)
        return getattr(self.inner, name)
"""
WRAPS = "potential_shaping"
"""A program whose wrapper needs an environment of Gymnasium."""


def each_of(programs: list[Program], *everyday: str) -> Any:
    def mark(test: Any) -> Any:
        exhaustive = pytest.mark.exhaustive("watches every program", but=everyday)
        return exhaustive(pytest.mark.parametrize("program", programs, ids=lambda each: each.name)(test))

    return mark


@each_of(
    FAULTY,
    *("cut_off_cliff", "discounted_twice", "last_reward", "moves_first", "same_list", "transposed"),
    "updates_a_copy",
)
def test_the_fault_of_a_program_is_found(program: Program, tmp_path: Path) -> None:
    log = program.watched(tmp_path, seed=0)
    assert log.error is None
    (finding,) = verdict_of(log).findings
    assert (finding.fault.value, line_of(finding)) == (program.expect, program.line)
    assert finding.kind == "risk" or finding.steps_against == 0


def test_every_fault_has_programs() -> None:
    assert {program.expect for program in FAULTY} == {each.value for each in CodeFault}


@each_of(
    CORRECT,
    *("alpha_by_episode", "dyna_q", "n_step_sarsa", "optimistic_lists", "potential_shaping"),
    *("real_time_planning", "replay_buffer", "sarsa_cliff", "single_precision"),
)
def test_a_correct_program_is_understood_and_not_blamed(program: Program, tmp_path: Path) -> None:
    log = program.watched(tmp_path, seed=CORRECT.index(program))
    verdict = verdict_of(log)
    assert (log.error, verdict.findings) == (None, ())
    table = log.table.name if log.table else None
    found = {name: table if name == "table" else getattr(verdict.update, name) for name in program.expect}
    assert found == {
        name: pytest.approx(value, rel=1e-6) if isinstance(value, float) else value
        for name, value in program.expect.items()
    }, verdict.update
    assert bool(verdict.update.reason) == (verdict.update.rule == "unknown" and log.table is not None)


@each_of([*CORRECT, *FAULTY], "sarsa_cliff", "integers")
def test_it_is_understood_under_the_old_name_too(program: Program, tmp_path: Path) -> None:
    text = program.text.replace("import gymnasium as gym", "import gym")
    text = text.replace("import gymnasium", "import gym as gymnasium").replace("from gymnasium", "from gym")
    assert NOTE in check(program, text, tmp_path, is_known=True)


@each_of([each for each in (*CORRECT, *FAULTY) if each.name != WRAPS], "sarsa_cliff", "integers")
def test_it_is_understood_in_a_world_of_its_own_too(program: Program, tmp_path: Path) -> None:
    check(program, OWN + re.sub(r"\b(gym|gymnasium)\.make\(", "Own(", program.text), tmp_path)


def check(program: Program, text: str, folder: Path, *, is_known: bool = False) -> list[str]:
    group = CORRECT if program in CORRECT else FAULTY
    log = watched(script_in(folder, text), seed=group.index(program))
    verdict = verdict_of(log)
    assert log.error is None
    faults = {each.fault.value for each in verdict.findings}
    if group is FAULTY:
        assert faults <= {program.expect}
        assert faults or not is_known
    else:
        assert (faults, verdict.update.rule) == (set(), program.expect.get("rule", verdict.update.rule))
    return log.notes
