"""The line that changed the table."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from pathlib import Path
from textwrap import dedent
from types import SimpleNamespace
from typing import Any

import pytest
from watched_scripts import LOOP, script_in, wait_until, watched

from rl_tui.programs.watched.child.errors import line_of
from rl_tui.programs.watched.child.line_trace import MOST_LINES, TRACED_AT_FIRST, LineTrace, Place
from rl_tui.programs.watched.program_log import ProgramLog
from rl_tui.programs.watched.program_process import ProgramProcess, ProgramRequest


class Traced:
    """Runs a script: ``begin()`` starts the trace, and ``q`` is the table."""

    def __init__(self, folder: Path, text: str, changes: int = 1000) -> None:
        self.path = folder / "script.py"
        self.path.write_text(dedent(text))
        self.q = [0.0] * 4
        self.told: list[Mapping[Place, int]] = []
        self.trace = LineTrace(lambda: tuple(self.q), self.told.append)
        names: dict[str, Any] = {
            "q": self.q,
            "begin": lambda: self.trace.begin(changes),
            "is_on": lambda: self.trace.is_on,
        }
        try:
            exec(compile(self.path.read_text(), str(self.path), "exec"), names)
        finally:
            self.trace.stop()

    @property
    def lines(self) -> dict[int, int]:
        assert all(file == str(self.path) for told in self.told for file, _ in told)
        return {line: count for told in self.told for (_, line), count in told.items()}


@pytest.mark.parametrize(
    ("text", "lines"),
    [
        pytest.param("begin()\nfor i in range(3):\n    q[i] += 1\n    i\n", {3: 3}, id="a line"),
        pytest.param("begin()\nq[0] += (\n    1 +\n    2\n)\nq[0]\n", {2: 1}, id="several lines"),
        pytest.param("q[0] = 5\nbegin()\nq[0] = 6\nq[1] = 5\n", {3: 1, 4: 1}, id="from where it begins"),
        pytest.param("begin()\nq[0] = 1\nq[0] = 1\nq[0] = 1\n", {2: 1}, id="changes only"),
        pytest.param("def f(i):\n    q[i] += 1\nbegin()\nf(0)\nf(1)\n", {2: 2}, id="a function"),
        pytest.param(
            "def f(i):\n    return i + 1\nbegin()\nq[0] = f(\n    3)\n", {4: 1}, id="what a function returns"
        ),
        pytest.param(
            "class A:\n    def update(self):\n        if True:\n            q[2] = 9\n        self\n"
            "def g(a):\n    a.update()\nbegin()\ng(A())\n",
            {4: 1},
            id="a method",
        ),
        pytest.param(
            "begin()\nlist(map(lambda i: q.__setitem__(i, 7), [1, 2]))\n", {2: 2}, id="by built-ins"
        ),
        pytest.param(
            "def g():\n    yield 3\n    yield 4\nbegin()\nfor x in g():\n    q[0] = x\n",
            {6: 2},
            id="generators",
        ),
        pytest.param(
            "def f():\n    begin()\n    q[0] = 1\ndef g():\n    f()\n    q[1] = 1\ng()\nq[2] = 2\n",
            {3: 1, 6: 1, 8: 1},
            id="functions that called",
        ),
        pytest.param(
            "import bisect\nbegin()\nbisect.insort([3], 2, key=lambda x: q.__setitem__(0, x) or x)\n",
            {3: 2},
            id="by a library",
        ),
    ],
)
def test_the_line_that_changed_it(tmp_path: Path, text: str, lines: dict[int, int]) -> None:
    assert Traced(tmp_path, text).lines == lines


def test_so_many_changes_are_looked_for_and_nothing_is_left_of_it(tmp_path: Path) -> None:
    before = sys.gettrace()
    traced = Traced(
        tmp_path,
        """\
        import sys
        def inner():
            begin()
            for i in range(100):
                q[0] += 1
            assert not is_on()
            frame = sys._getframe()
            while frame is not None:
                assert frame.f_trace is None
                frame = frame.f_back
        inner()
        """,
        changes=40,
    )
    assert traced.lines == {5: 40}
    assert len(traced.told) == 1
    assert sys.gettrace() is before


def test_it_can_be_asked_for_again(tmp_path: Path) -> None:
    traced = Traced(
        tmp_path,
        """\
        for times in range(3):
            begin()
            for i in range(10):
                q[0] += 1
                q[1] += 1
        """,
        changes=4,
    )
    assert [sum(told.values()) for told in traced.told] == [4, 4, 4]


def test_where_changes_are_rare_it_gives_up(tmp_path: Path) -> None:
    traced = Traced(
        tmp_path,
        f"""\
        begin()
        q[0] = 1
        for i in range({MOST_LINES}):
            pass
        assert not is_on()
        """,
    )
    assert traced.lines == {2: 1}


@pytest.mark.process
@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ("", "", 11),
        ("np.zeros((16, 4))", "{s: np.zeros(4) for s in range(16)}", 11),
        ("np.zeros((16, 4))", "[[0.0] * 4 for _ in range(16)]", 11),
        ("Q[next_state].max()", "(\n            max(Q[next_state]))", 11),
    ],
)
def test_lines_of_a_real_script(tmp_path: Path, old: str, new: str, line: int) -> None:
    text = LOOP.format(episodes=100).replace(old, new) if old else LOOP.format(episodes=100)
    if "[[" in new or "{s" in new:
        text = text.replace("Q[state, action]", "Q[state][action]").replace(".max()", "[0]")
    path = script_in(tmp_path, text)
    assert watched(path).lines == {(str(path), line): TRACED_AT_FIRST}


@pytest.mark.process
def test_a_script_that_runs_can_be_asked_for_lines_again(tmp_path: Path) -> None:
    process = ProgramProcess(ProgramRequest(script_in(tmp_path, LOOP.format(episodes=10**7))))
    log = ProgramLog()

    def has_told(changes: int) -> bool:
        for letter, payload in process.frames(0.1):
            log.take(letter, payload)
        return sum(log.lines.values()) >= changes

    try:
        wait_until(lambda: has_told(TRACED_AT_FIRST))
        process.ask({"trace": 17})
        wait_until(lambda: has_told(TRACED_AT_FIRST + 17))
    finally:
        process.end()
    assert len(log.lines) == 1


def test_a_debugger_is_left_alone(tmp_path: Path) -> None:
    if sys.version_info >= (3, 12):
        pytest.skip("from 3.12 on both can look")

    def debugger(*_: object) -> None:
        return None

    before = sys.gettrace()
    sys.settrace(debugger)
    try:
        traced = Traced(tmp_path, "begin()\nassert not is_on()\nq[0] = 1\n")
        assert sys.gettrace() is debugger
    finally:
        sys.settrace(before)
    assert traced.told == []


@pytest.mark.parametrize("line", [2, 3, 4, 5])
def test_an_instruction_without_a_line_is_at_the_line_before_it(line: int) -> None:
    scope: dict[str, Any] = {}
    lines = "best = 0", "for each in numbers:", "    if each > best:", "        best = each"
    exec(compile("\n    ".join(("def scan(numbers):", *lines)), "script.py", "exec"), scope)
    code = scope["scan"].__code__
    first, _, _ = next(each for each in code.co_lines() if each[2] == line)
    frame: Any = SimpleNamespace(f_lineno=None, f_code=code, f_lasti=first)
    assert line_of(frame) == line
    unplaced: Any = SimpleNamespace(f_lineno=None, f_code=code, f_lasti=-1)
    assert line_of(unplaced) == code.co_firstlineno
