"""A program that goes silent or ends suddenly."""

from __future__ import annotations

import json
from pathlib import Path
from textwrap import dedent

import pytest
from watched_scripts import lines_of, script_in, watched

from rl_tui.programs.diagnosis.diagnosis import verdict_of
from rl_tui.programs.grading.watch_report import watch_report
from rl_tui.programs.watched.messages import OWN_MESSAGE, MessageKind
from rl_tui.programs.watched.program_log import ProgramLog
from rl_tui.programs.watched.watched_program import error_in_words

pytestmark = pytest.mark.process

FIVE_STEPS = dedent("""\
    import os, time
    import gymnasium as gym, numpy as np
    env = gym.make("FrozenLake-v1")
    Q = np.zeros((16, 4))
    s, _ = env.reset()
    for i in range(5):
        t, *_ = env.step(1)
        Q[s, 1] += 1
        s = t
    """)


@pytest.mark.exhaustive("waits for a program that hangs")
def test_the_last_steps_before_it_hangs_are_told_and_the_line(tmp_path: Path) -> None:
    log = watched(script_in(tmp_path, FIVE_STEPS + "while True: pass\n"), steps=5)

    assert (log.recording.count, log.error) == (5, None)
    assert log.stands_at == (str(tmp_path / "script.py"), 10)
    assert any("line 10" in note for note in log.notes)


@pytest.mark.parametrize("end", ["os._exit(3)", "__import__('_thread').start_new_thread(os._exit, (3,))"])
def test_os_exit_tells_the_last_step_and_its_change_first(tmp_path: Path, end: str) -> None:
    log = watched(script_in(tmp_path, FIVE_STEPS + f"{end}\ntime.sleep(60)\n"))

    assert log.recording.count == 5
    assert log.recording.table_at(5).sum() == 5
    assert "os._exit(3)" in log.error.text


def test_a_forked_process_that_exits_tells_nothing(tmp_path: Path) -> None:
    fork = "n = os.fork()\nif n == 0: os._exit(4)\nprint(os.waitstatus_to_exitcode(os.waitpid(n, 0)[1]))\n"
    log = watched(script_in(tmp_path, FIVE_STEPS + fork))

    assert (log.recording.count, log.error, log.ended) == (5, None, True)
    assert lines_of(log) == ["4"]
    assert lines_of(log, "err") == []


def test_what_fails_before_the_script_begins_is_not_blamed_on_it() -> None:
    log = ProgramLog()
    for kind, more in (
        (MessageKind.OUTPUT, {"stream": "err", "text": "ImportError: no", "replaces": False, "step": None}),
        (MessageKind.GONE, {"status": 1, "text": ""}),
    ):
        log.take(OWN_MESSAGE, json.dumps({"kind": kind, **more}).encode())

    assert log.error is not None
    words = error_in_words(log.error)
    assert "not a bug of the script" in words
    assert "ImportError: no" in words
    assert "os._exit" not in words


def test_axes_changed_over_are_told(tmp_path: Path) -> None:
    log = watched(script_in(tmp_path, FIVE_STEPS.replace("(16, 4)", "(4, 16)").replace("Q[s, 1]", "Q[1, s]")))

    assert log.table is None
    assert log.notes == ["Q is 4×16: did you mean 16×4 (states × actions)?"]


@pytest.mark.parametrize(
    ("table", "key", "entry", "shape"),
    [("{0: np.zeros(4)}", "s", "np.zeros(4)", [3, 4]), ("{(0, 0): 0.0}", "(s, 1)", "0.0", [4])],
)
def test_the_shape_of_a_dict_is_that_of_the_end_and_a_note_is_told_once(
    tmp_path: Path, table: str, key: str, entry: str, shape: list[int]
) -> None:
    text = f"""\
        import gymnasium as gym, numpy as np
        for _ in range(2):
            env = gym.make("FrozenLake-v0")
        Q = {table}
        env.reset()
        for s in range(3):
            env.step(1)
            Q[{key}] = {entry}
        """
    log = watched(script_in(tmp_path, text))
    document = watch_report("it", log, verdict_of(log))

    assert document["table"]["shape"] == shape
    assert [note for note in document["notes"] if "instead" in note] == [
        "FrozenLake-v0 is not in this Gymnasium: FrozenLake-v1 was made instead"
    ]
