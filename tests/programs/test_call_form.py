"""The form in which a call expects its result."""

from __future__ import annotations

import inspect
import linecache
from types import CodeType, FrameType
from typing import Any

import pytest

from rl_tui.programs.watched.child.old_gym.call_form import (
    CallForm,
    Use,
    form_of,
    reset_result,
    step_result,
    values_around,
    values_in,
)

UNPACKED, INDEXED, WHOLE = Use.UNPACKED, Use.INDEXED, CallForm(Use.AS_IT_IS)
FIVE = (3, 1.0, False, True, {"a": 1})


def caller() -> FrameType:
    frame = inspect.currentframe()
    assert frame is not None
    assert frame.f_back is not None
    assert frame.f_back.f_back is not None
    return frame.f_back.f_back


class Recording:
    def __init__(self) -> None:
        self.forms: list[CallForm] = []
        self.unwrapped = self

    def step(self, *_: Any) -> Any:
        self.forms.append(form_of(caller()))
        use, number = self.forms[-1]
        return range(number if use is UNPACKED and number else 5)

    reset = step


def compiled(text: str, file: str) -> CodeType:
    linecache.cache[file] = (len(text), None, text.splitlines(keepends=True), file)
    return compile(text, file, "exec")


@pytest.mark.parametrize(
    ("text", "forms"),
    [
        ("a, b, c, d = env.step(0)", [CallForm(UNPACKED, 4)]),
        ("[a, b, c, d, e] = env.step(0)", [CallForm(UNPACKED, 5)]),
        ("a, b, *c = env.step(0)", [CallForm(UNPACKED, 0)]),
        ("a = env.reset()", [WHOLE]),
        ("a = env.reset()[0]", [CallForm(INDEXED, 0)]),
        ("env.reset()", [WHOLE]),
        ("t = env.step(0)\na, b, c, d, e = t", [CallForm(UNPACKED, 5)]),
        ("t = env.step(0)\na, b = t[0], t[3]", [CallForm(INDEXED, 3)]),
        ("a, i = env.reset(); b, r, c, d = env.step(0)", [CallForm(UNPACKED, 2), CallForm(UNPACKED, 4)]),
        ("q = [0]\n(q[0], r, d, e) = env.step(0)", [CallForm(UNPACKED, 4)]),
        ("a, b, c, d = env.step(int(\n    abs(-1)\n))", [CallForm(UNPACKED, 4)]),
        ("a, b, c, d = (\n    env\n    .unwrapped\n    .step(0)\n)", [CallForm(UNPACKED, 4)]),
        ("x = str(env.step(0))", [WHOLE]),
        ("while (t := env.step(0)) and not t[4]: break", [CallForm(INDEXED, 4)]),
        ("def f():\n    return env.step(0)\nf()", [WHOLE]),
        ("def f():\n    t = env.step(0)\n    return t\nt = f()\na, b, c, d, e = t", [WHOLE]),
        (
            "class A:\n    def f(self):\n        self.s, r, d, _ = env.step(0)\nA().f()",
            [CallForm(UNPACKED, 4)],
        ),
        ("t = [env.step(each) for each in (0, 1)]", [WHOLE, WHOLE]),
        ("for _ in range(2):\n    a, b, c, d = env.step(0)", [CallForm(UNPACKED, 4)] * 2),
        ("if True:\n  x = 1; ä = 'öäü'; a, b, c, d = env.step(0)", [CallForm(UNPACKED, 4)]),
    ],
)
def test_the_use_of_a_result_is_read_around_its_call(text: str, forms: list[CallForm]) -> None:
    env = Recording()
    exec(compiled(text, f"<{text}>"), {"env": env})
    assert env.forms == forms


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("a, b, c, d = env.step(0)", 4),
        ("a, b, c, d, e = env.step(0)", 5),
        ("a, b, c, d, e = env.step(0)\na, b, c, d = env.step(0)\na, b, c, d = f.step(0)", 4),
        ("a, b, c, d = zip()\nx = env.step(0)", 0),
        ("a, b = env.reset()", 0),
        ("a, b, =", 0),
    ],
)
def test_most_calls_of_a_file_decide_the_others(text: str, values: int) -> None:
    linecache.cache[f"<{text}>"] = (len(text), None, text.splitlines(keepends=True), "")
    assert values_in(f"<{text}>") == values


def answered(text: str, observation: Any = 3) -> Any:
    class Env:
        def step(self, *_: Any) -> Any:
            return step_result(caller(), FIVE)

        def reset(self) -> Any:
            return reset_result(caller(), (observation, {}))

    names = {"env": Env()}
    exec(compiled(text, f"<answers {text}>"), names)
    return names["result"]


@pytest.mark.parametrize(
    ("text", "result"),
    [
        ("a, b, c, d = env.step(0); result = c, d", (True, {"a": 1, "TimeLimit.truncated": True})),
        ("a, b, c, d, e = env.step(0); result = c, d, e", (False, True, {"a": 1})),
        ("t = env.step(0); result = len(t), t[2]", (4, True)),
        ("t = env.step(0); result = t[4]", {"a": 1}),
        ("a, b, c, d, e = env.step(0); result = len(env.step(1))", 5),
        ("result = env.reset()", 3),
        ("s, i = env.reset(); result = s", 3),
        ("result = env.reset()[0]", 3),
        ("a, b, c, d, e = env.step(0); result = env.reset()", (3, {})),
        ("a, b, c, d, e = env.step(0); s, i = env.reset(); result = s", 3),
        ("s = result = env.reset(); s, r, c, d, e = env.step(0)", (3, {})),
        ("s = env.reset(); result = s; s, r, c, d, e = env.step(0)", 3),
        ("s = env.reset(); result = s; s2, r, c, d, e = env.step(0); s = s2", 3),
        ("s = env.reset(); result = s; s2, r, c, d, e = env.step(0); s = s[0]", (3, {})),
    ],
)
def test_each_call_gets_the_form_it_is_written_for(text: str, result: Any) -> None:
    assert answered(text) == result


def test_an_observation_of_several_numbers_may_be_unpacked() -> None:
    assert answered("x, y = env.reset(); result = x, y", (1, 2)) == (1, 2)
    assert answered("x, y, z = env.reset(); result = z", (1, 2, 3)) == 3
    assert answered("a, b, c, d, e = env.step(0); x, i = env.reset(); result = x", (1, 2)) == (1, 2)


def test_without_a_source_a_call_is_old() -> None:
    assert values_around(None) == 4
