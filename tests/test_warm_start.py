"""A forked program is like a newly started one."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from warm_start import RealPopen, WarmPopen

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="programs are forked on Linux only")

LOOKS_AROUND = """
import os, signal, sys, threading
print(__name__, sys.argv, sys.orig_argv, sys.path, os.getcwd(), dict(os.environ), os.getppid())
print(os.getsid(0) == os.getpid(), repr(sys.stdin.read()), threading.active_count(), os.umask(0))
print([(each.name, each.mode, each.encoding, each.errors, each.isatty()) for each in (sys.stdin, sys.stdout)])
print([signal.getsignal(each) for each in (signal.SIGINT, signal.SIGPIPE, signal.SIGTERM)])
print([each for each in range(3, 300) if os.path.exists(f"/proc/self/fd/{each}")], file=sys.stderr)
"""


def outcome(start: Any, *arguments: str, **more: Any) -> tuple[bool, int, str, str]:
    pipes = dict.fromkeys(("stdin", "stdout", "stderr"), subprocess.PIPE)
    with start([sys.executable, *arguments], **pipes, text=True, **more) as process:
        written = process.communicate("typed\n")
    return getattr(process, "was_forked", False), process.returncode, *written


@pytest.mark.parametrize("more", [{}, {"cwd": "/", "start_new_session": True}])
def test_all_it_finds_is_the_same(more: dict[str, Any]) -> None:
    more |= {"env": {**os.environ, "RL_TUI_KIOSK": "1"}}
    forked, *found = outcome(WarmPopen, "-c", LOOKS_AROUND, "an argument", **more)
    assert forked
    assert [False, *found] == list(outcome(RealPopen, "-c", LOOKS_AROUND, "an argument", **more))


def test_descriptors_keep_their_numbers() -> None:
    reading, writing = os.pipe()
    with open(reading, encoding="utf-8") as there:
        code = f"import os; os.write({writing}, b'through the pipe')"
        assert outcome(WarmPopen, "-P", "-c", code, pass_fds=(writing,)) == (True, 0, "", "")
        os.close(writing)
        assert there.read() == "through the pipe"


@pytest.mark.parametrize(
    "code",
    [
        "import sys; sys.exit(7)",
        "import sys; sys.exit('in words')",
        "import os; os.kill(os.getpid(), 9)",
        "import signal; signal.raise_signal(signal.SIGTERM)",
        "import atexit; atexit.register(print, 'a farewell'); print('before', end=' ')",
        "import threading, time; threading.Thread(target=lambda: (time.sleep(.1), print('late'))).start()",
    ],
)
def test_it_ends_in_the_same_way(code: str) -> None:
    forked, *found = outcome(WarmPopen, "-c", code)
    assert forked
    assert [False, *found] == list(outcome(RealPopen, "-c", code))


@pytest.mark.parametrize(
    ("arguments", "more"),
    [
        (("-c", "import sys; print('numba' in sys.modules)"), {}),
        (("-I", "-c", "print(False)"), {}),
        (("-c", "print(False)"), {"env": {**os.environ, "TEXTUAL_FPS": "9"}}),
        (("-c", "print(False)"), {"preexec_fn": signal.SIGTERM.__index__}),
    ],
)
def test_what_would_not_be_the_same_is_started_anew(arguments: tuple[str, ...], more: dict[str, Any]) -> None:
    assert outcome(WarmPopen, *arguments, **more) == (False, 0, "False\n", "")


def test_a_module_finds_what_is_beside_it(tmp_path: Path) -> None:
    (tmp_path / "program.py").write_text("import part, sys; print(__name__, sys.argv, part.__file__)")
    (tmp_path / "part.py").touch()
    forked, *found = outcome(WarmPopen, "-m", "program", "an argument", cwd=tmp_path)
    assert forked
    assert [False, *found] == list(outcome(RealPopen, "-m", "program", "an argument", cwd=tmp_path))
