"""Scripts outside their loop: output, errors and ends."""

from __future__ import annotations

import json
import time
from pathlib import Path
from textwrap import dedent

import pytest
from watched_scripts import LOOP, lines_of, lives, script_in, wait_until, watched

from rl_tui.programs.diagnosis.diagnosis import verdict_of
from rl_tui.programs.grading.watch_report import watch_report
from rl_tui.programs.watched.messages import OWN_MESSAGE, MessageKind
from rl_tui.programs.watched.program_log import ProgramLog
from rl_tui.programs.watched.program_process import LAST_KEPT, MOST_A_SECOND
from rl_tui.programs.watched.watched_program import error_in_words

pytestmark = pytest.mark.process

NO_ENVIRONMENT = (
    "nothing to watch, because rl-tui sees only steps in a Gymnasium environment, in a class with reset() "
    "and step(action), in a function step(state, action), or as assignments to a table"
)


@pytest.mark.usefixtures("real_start")
def test_it_runs_as_python_runs_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "in").mkdir()
    (tmp_path / "in" / "neighbour.py").write_text("NAME = 'beside it'\n")
    (tmp_path / "data.txt").write_text("of the current folder\n")
    script_in(
        tmp_path / "in",
        """\
        import sys, neighbour
        if __name__ == "__main__":
            print(sys.argv)
            print(__file__)
            print(sys.path[0])
            print(neighbour.NAME, open("data.txt").read().strip())
            print(sys.modules["__main__"].__file__ == __file__, "" in sys.path)
        """,
    )
    log = watched(Path("in/script.py"), "--episodes", "-3", "ä b")
    folder = tmp_path / "in"
    assert lines_of(log) == [
        str(["in/script.py", "--episodes", "-3", "ä b"]),
        f"{folder}/script.py",
        str(folder),
        "beside it of the current folder",
        "True False",
    ]
    assert (log.error, log.ended) == (None, True)


def test_output_of_python_of_c_and_of_processes_comes_in_lines(tmp_path: Path) -> None:
    text = """\
    import os, sys, warnings
    print("printed")
    print("to stderr", file=sys.stderr)
    warnings.warn("a warning")
    os.write(1, b"as C code does\\n")
    os.system("echo by a process; echo and its errors >&2")
    """
    log = watched(script_in(tmp_path, text))
    assert lines_of(log) == ["printed", "as C code does", "by a process"]
    errors = lines_of(log, "err")
    assert errors[0] == "to stderr"
    assert errors[1].endswith("script.py:4: UserWarning: a warning")
    assert errors[-1] == "and its errors"


def test_a_progress_bar_is_one_line(tmp_path: Path) -> None:
    text = """\
    import sys, time
    for percent in range(2001):
        print(f"\\r{percent / 20:.0f} %|####", end="", file=sys.stderr, flush=True)
        if percent % 500 == 0:
            time.sleep(0.05)
    print(file=sys.stderr)
    print("after it", file=sys.stderr)
    """
    log = watched(script_in(tmp_path, text))
    assert lines_of(log, "err") == ["100 %|####", "after it"]


def test_a_flood_of_output_is_bounded_and_its_end_is_kept(tmp_path: Path) -> None:
    text = """\
    import os
    for line in range(200_000):
        print("line", line, "x" * 50)
    os.write(1, b"y" * 3_000_000 + b"\\n")
    print("the last line")
    """
    started = time.monotonic()
    log = watched(script_in(tmp_path, text))
    seconds = int(time.monotonic() - started) + 2  # as many as it can have touched
    lines = lines_of(log)
    assert lines[0].startswith("line 0 ")
    assert lines[-1] == "the last line"
    assert any(line.startswith("… ") and line.endswith(" lines left out") for line in lines)
    assert max(map(len, lines)) <= 500
    assert len(lines) <= seconds * (MOST_A_SECOND + LAST_KEPT + 1)


def test_floods_by_processes_do_not_outlive_the_script(tmp_path: Path) -> None:
    path = script_in(
        tmp_path,
        """\
        import os, subprocess, sys
        for _ in range(5):
            child = subprocess.Popen(["sh", "-c", "while :; do echo flood; done"])
            print(child.pid, file=sys.stderr)
        """,
    )
    log = watched(path)
    numbers = [int(line) for line in lines_of(log, "err")]
    assert (log.ended, log.error, len(numbers)) == (True, None, 5)
    wait_until(lambda: not any(map(lives, numbers)))


@pytest.mark.parametrize(
    ("line", "error", "text"),
    [
        ("input('how many? ')", "RuntimeError", "input() does not work while rl-tui watches"),
        ("import cv2_", "ModuleNotFoundError", "put it next to the script"),
        ("import cv2.no", "ModuleNotFoundError", "install it with `pip install opencv-python`"),
        ("import sklearn.tree as x", "ModuleNotFoundError", "`pip install scikit-learn`"),
        ("s, r, done, info = env.step(0)", "ValueError", "since Gym 0.26, step returns five values"),
        ("state = env.reset(); q = [0.0] * 16; q[state]", "TypeError", "`state, info = env.reset()`"),
        ("state = env.reset(); q = {}; q[state]", "TypeError", "`state, info = env.reset()`"),
        ("import numpy as np; q = np.zeros(16); s = env.reset(); q[s]", "IndexError", "info = env.reset()`"),
        ("env.seed(0)", "AttributeError", "write `env.reset(seed=0)`"),
        ("env.nS", "AttributeError", "write `env.unwrapped.nS`"),
        ("raise KeyboardInterrupt", "KeyboardInterrupt", ""),
        ("raise MemoryError('no more')", "MemoryError", "no more"),
    ],
)
def test_an_error_has_its_place_and_what_helps(tmp_path: Path, line: str, error: str, text: str) -> None:
    path = script_in(
        tmp_path,
        f"""\
        import gymnasium
        env = gymnasium.make("FrozenLake-v1")
        env.reset()
        def faulty():
            {line}
        faulty()
        """,
    )
    found = watched(path).error
    assert (found.type, found.file, found.line) == (error, str(path), 5)
    assert text in found.text
    assert "rl_tui/programs" not in found.traceback
    assert found.traceback.startswith("Traceback (most recent call last):\n")
    assert "in faulty" in found.traceback


def test_advice_is_given_only_where_it_fits(tmp_path: Path) -> None:
    found = watched(script_in(tmp_path, "a, b, c, d = range(5)\n")).error
    assert found.text == "too many values to unpack (expected 4)"


def test_a_traceback_of_any_depth_is_bounded(tmp_path: Path) -> None:
    text = "def deeper(n):\n    return deeper(n + 1) if n % 2 else deeper(n - 1 + 2)\ndeeper(0)\n"
    found = watched(script_in(tmp_path, text)).error
    assert (found.type, len(found.traceback) < 15_000) == ("RecursionError", True)


@pytest.mark.parametrize(
    ("code", "note"),
    [
        ("raise SystemExit", None),
        ("import sys; sys.exit(0)", None),
        ("import sys; sys.exit(3)", "the script ended itself with sys.exit(3)"),
        ("import sys; sys.exit('no luck')", "the script ended itself with sys.exit('no luck')"),
        ("import os; os._exit(0)", "the program ended at once, by os._exit(0)"),
    ],
)
def test_an_exit_is_an_end(tmp_path: Path, code: str, note: str | None) -> None:
    log = watched(script_in(tmp_path, code + "\n"))
    assert (log.ended, log.error) == (True, None)
    assert log.notes == [*([] if note is None else [note]), *([] if "_exit" in code else [NO_ENVIRONMENT])]


@pytest.mark.parametrize(
    ("code", "text"),
    [
        ("os.kill(os.getpid(), 9)", "stopped by the signal SIGKILL"),
        ("os._exit(7)", "by os._exit(7)"),
        ("os.abort()", "stopped by the signal SIGABRT"),
        ("os.closerange(3, 256); time.sleep(600)", "closed the pipe"),
        ("os.closerange(0, 256); time.sleep(600)", "closed the pipe"),
        ("[os.write(n, b'S' + b'\\xff' * 99) for n in pipes()]; time.sleep(600)", "is damaged"),
        ("[os.write(n, b'?' + bytes(8)) for n in pipes()]; time.sleep(600)", "is damaged"),
        ("[os.write(n, b'J' + (4).to_bytes(8, 'little') + b'null') for n in pipes()]", "is damaged"),
        ("[os.write(n, b'S' + (8).to_bytes(8, 'little') + b'\\xff' * 8) for n in pipes()]", "is damaged"),
    ],
)
def test_a_violent_end_is_told_in_a_line(tmp_path: Path, code: str, text: str) -> None:
    path = script_in(
        tmp_path,
        f"""\
        import os, stat, time
        def pipes():
            for number in range(3, 50):
                try:
                    if stat.S_ISFIFO(os.fstat(number).st_mode):
                        os.set_blocking(number, False)
                        os.write(number, b"")
                        yield number
                except OSError:
                    pass
        print("alive", flush=True)
        {code}
        """,
    )
    log = watched(path)
    assert text in log.error.text
    assert log.ended
    assert lines_of(log)[:1] == ["alive"]


def test_what_a_killed_program_did_is_kept(tmp_path: Path) -> None:
    text = (
        LOOP.format(episodes=20) + "print('done')\nenv.reset()\nimport time; time.sleep(0.2)\nenv.reset()\n"
    )
    log = watched(script_in(tmp_path, text + "import os; os.kill(os.getpid(), 9)\n"))
    assert log.recording.count > 20
    assert lines_of(log) == ["done"]


def test_a_hang_ends_with_the_time_limit(tmp_path: Path) -> None:
    from rl_tui.programs.watched.program_process import ProgramRequest, watched_to_the_end

    path = script_in(tmp_path, "import re\nre.match('(a+)+$', 'a' * 60 + 'b')\n")  # holds the interpreter
    log = watched_to_the_end(ProgramRequest(path), seconds=0.5)
    assert log.error.text == "the program was stopped after 0.5 seconds"


def test_lines_of_a_notebook_are_skipped_and_counted(tmp_path: Path) -> None:
    path = script_in(
        tmp_path,
        '''\
        !pip install gymnasium \\
            numpy
        %matplotlib inline
        text = """
        % not a line of a notebook
        """
        if True:
            %time
            print((7
                   % 4), text.strip())
        raise ValueError
        ''',
    )
    log = watched(path)
    assert lines_of(log) == ["3 % not a line of a notebook"]
    assert log.notes == ["4 lines that only notebooks understand are skipped"]
    assert log.error.line == 11


@pytest.mark.usefixtures("real_start")
def test_plots_open_no_window(tmp_path: Path) -> None:
    package = tmp_path / "matplotlib"
    package.mkdir()
    (package / "__init__.py").write_text("def use(name):\n    raise ImportError('no display')\n")
    (package / "pyplot.py").write_text(
        "def show():\n    raise RuntimeError('a window')\npause = show\nswitch_backend = print\n"
    )
    text = """\
    import os, matplotlib
    matplotlib.use("TkAgg")
    import matplotlib.pyplot as plt
    from matplotlib.pyplot import show
    plt.show(block=True); show(); plt.pause(0.1); plt.switch_backend("Qt5Agg")
    print(os.environ["MPLBACKEND"], os.environ["SDL_VIDEODRIVER"], os.environ["PYTHONHASHSEED"])
    """
    log = watched(script_in(tmp_path, text))
    assert log.error is None
    assert lines_of(log) == ["agg", "Agg dummy 0"]


def test_pickle5_is_pickle(tmp_path: Path) -> None:
    log = watched(script_in(tmp_path, "import pickle5 as pickle\nprint(pickle.loads(pickle.dumps([1])))\n"))
    assert lines_of(log) == ["[1]"]


def test_other_encodings_are_read(tmp_path: Path) -> None:
    path = tmp_path / "script.py"
    path.write_bytes(b"# -*- coding: latin-1 -*-\r\nprint('\xe4\xf6')\r\n")
    assert lines_of(watched(path)) == ["äö"]


def test_an_error_in_a_module_of_the_user_s_has_its_place_there(tmp_path: Path) -> None:
    (tmp_path / "broken.py").write_text("x = 1\nif x\n    pass\n")
    found = watched(script_in(tmp_path, "import broken\n")).error
    assert (found.type, Path(found.file).name, found.line) == ("SyntaxError", "broken.py", 2)


def test_threads_that_the_script_leaves_are_waited_for(tmp_path: Path) -> None:
    text = (
        "import threading, time\nthreading.Thread(target=lambda: (time.sleep(.2), print('late'))).start()\n"
    )
    log = watched(script_in(tmp_path, text))
    assert lines_of(log) == ["late"]
    assert log.notes == ["the script starts threads, so the same seed may give another run", NO_ENVIRONMENT]


def test_processes_that_the_script_forks_work_and_are_told_of(tmp_path: Path) -> None:
    text = """\
    import multiprocessing
    def squared(x):
        return x * x
    if __name__ == "__main__":
        with multiprocessing.get_context("fork").Pool(2) as pool:
            print(pool.map(squared, [1, 2, 3]))
    """
    log = watched(script_in(tmp_path, text))
    assert (lines_of(log), log.error) == (["[1, 4, 9]"], None)
    assert "the script starts processes, so the same seed may give another run" in log.notes


@pytest.mark.usefixtures("real_start")
def test_memory_is_bounded_where_that_is_asked_for(tmp_path: Path) -> None:
    path = script_in(tmp_path, "x = bytearray(3_000_000_000)\n")
    found = watched(path, memory=2 * 10**9).error
    assert found.type == "MemoryError"


def test_pauses_of_pygame_return_at_once(tmp_path: Path) -> None:
    (tmp_path / "pygame").mkdir()
    (tmp_path / "pygame" / "__init__.py").write_text("from pygame import time\n")
    script_in(tmp_path, "Clock = wait = delay = None\n", "pygame/time.py")
    text = "from pygame.time import Clock, wait\nprint(Clock().tick(60), Clock().get_fps(), wait(5))\n"
    log = watched(script_in(tmp_path, text))
    assert (log.error, lines_of(log)) == (None, ["1 60.0 5"])


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
