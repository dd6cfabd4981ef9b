"""Machine code for many short runs."""

from __future__ import annotations

from collections.abc import Iterable

import pytest

from rl_tui.agents.kernels.machine_code import Loop
from rl_tui.studies.sweeps import runs as machine_code
from rl_tui.studies.sweeps.runs import WORTH_COMPILING, WORTH_READING, MachineCodeDemand

ONE, OTHER = Loop("one", "policy", stepped=False), Loop("other", "policy", stepped=False)


class Compiler:
    def __init__(self) -> None:
        self.failed: dict[Loop, BaseException] = {}
        self.asked: list[object] = []

    def read(self, loop: Loop) -> bool:
        self.asked.append(loop)
        return False

    def want(self, loops: Iterable[Loop]) -> None:
        self.asked.append(list(loops))


@pytest.fixture
def compiler(monkeypatch: pytest.MonkeyPatch) -> Compiler:
    made = Compiler()
    monkeypatch.setattr(machine_code, "BACKGROUND", made)
    monkeypatch.setattr(machine_code, "was_compiled", lambda loop: loop == ONE)
    return made


def test_short_runs_add_up_until_what_is_kept_is_read(compiler: Compiler) -> None:
    demand = MachineCodeDemand()
    for _ in range(9):
        demand.ran(ONE, WORTH_READING / 10)
    assert compiler.asked == []
    demand.ran(ONE, WORTH_READING / 5)
    demand.ran(ONE, WORTH_READING / 5)
    assert compiler.asked == [ONE]


def test_what_is_not_kept_is_compiled_later_and_all_of_it(compiler: Compiler) -> None:
    demand = MachineCodeDemand()
    demand.ran(OTHER, WORTH_READING)
    assert compiler.asked == []
    demand.ran(OTHER, WORTH_COMPILING)
    demand.ran(OTHER, WORTH_COMPILING)
    assert compiler.asked == [[OTHER]]
    demand.ran(ONE, WORTH_COMPILING)
    assert compiler.asked == [[OTHER], ONE, [OTHER, ONE]]


def test_what_cannot_be_had_is_not_asked_for(compiler: Compiler) -> None:
    compiler.failed[ONE] = RuntimeError()
    MachineCodeDemand().ran(ONE, 10 * WORTH_COMPILING)
    assert compiler.asked == []
