"""Questions answered in the background."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from rl_tui.runs.background.background import ENDED_BY_ITSELF, Background
from rl_tui.runs.background.child import LONGEST

pytestmark = pytest.mark.process

WORK = """
import os
from contextlib import suppress

from rl_tui.common.errors import UserError


def counts(last, tell):
    for number in range(last + 1):
        tell(number, number / last)


def breaks_down(share, tell):
    tell("a part", share)
    raise ZeroDivisionError("out\\nof breath")


def refuses(reason, tell):
    raise UserError(reason)


def says_much(length, tell):
    tell("a part", 0.0)
    tell("x" * length, 1.0)


def writes(text, tell):
    tell("a part", 0.0)
    for descriptor in range(3, 10):  # the pipe of the answers is one of these
        with suppress(OSError):
            os.write(descriptor, text.encode())


def leaves(status, tell):
    tell("a part", 0.0)
    os._exit(status)
"""


@pytest.mark.parametrize(
    ("name", "asked", "known", "failed"),
    [
        ("counts", 3, 3, ""),
        ("breaks_down", 0.5, "a part", "ZeroDivisionError: out of breath"),
        ("refuses", "not here", None, "not here"),
        ("says_much", LONGEST, "a part", "ValueError: a result of "),
        ("leaves", 0, "a part", ENDED_BY_ITSELF),
        ("writes", "no length", "a part", ENDED_BY_ITSELF),
        ("writes", "\0\0\0\0\0\0\0\1x", "a part", "UnpicklingError: "),
        ("counts", lambda: None, None, "PicklingError: "),
    ],
)
def test_the_last_answer_is_known_and_why_no_more_come(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    name: str,
    asked: object,
    known: object,
    failed: str,
) -> None:
    (tmp_path / "questions.py").write_text(WORK)
    monkeypatch.syspath_prepend(tmp_path)
    news: list[bool] = []
    background = Background[object, object](f"questions:{name}", lambda: news.append(True))
    process = background.begin(asked, None)
    process.wait()
    assert process.known == known
    assert process.failed.startswith(failed)
    assert bool(process.failed) is bool(failed)
    assert news
    background.close()
    assert background.begin(asked, None) is None


def test_the_side_that_answers_loads_little_before_it_has_its_priority() -> None:
    code = "import sys, rl_tui.runs.background.child; print({'numpy', 'pydantic'} & {*sys.modules})"
    loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert loaded.stdout.strip() == "set()"
