"""Start the programs of tests by forking a process that has already imported their modules.

Tests about the start itself use the fixture ``real_start``. Some programs cannot be forked faithfully and
start normally: other kinds, those with a ``preexec_fn``, and those with environment variables that Python
reads early.
"""

from __future__ import annotations

import ctypes
import inspect
import json
import os
import re
import socket
import subprocess
import sys
import threading
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import pytest
from fork_server import LARGEST, MOST_DESCRIPTORS

RealPopen: Final = subprocess.Popen
_SERVER: Final = Path(__file__).with_name("fork_server.py")
_WATCHED: Final = "from rl_tui.programs.watched.child.main import main"
_ASKS_WHAT_IS_IMPORTED: Final = "sys.modules"
_READ_AT_START: Final = re.compile(
    "PYTHON.*|LC_.*|LANG|LANGUAGE|HOME|TEXTUAL.*|ESCDELAY|NUMBA.*|DASK.*|.*_NUM_THREADS|LD_.*|MALLOC.*"
)
_OF_SERVERS: Final = {"LC_ALL": "C.UTF-8", "OPENBLAS_NUM_THREADS": "1", "PYTHONHASHSEED": "0"}
_MEANS_THE_SAME: Final = {"PYTHONPATH": str(_SERVER.parents[1]), **dict.fromkeys(_OF_SERVERS)}
"""Values that mean the same as the server's own."""
_SET_CHILD_SUBREAPER: Final = 36
_START: Final = inspect.signature(subprocess.Popen._execute_child)  # type: ignore[attr-defined]
_PATIENCE: Final = 300.0  # seconds, on a busy machine


class ForkServer:
    """A process that forks programs of one kind (``IMPORTS`` of fork_server.py)."""

    def __init__(self, kind: str) -> None:
        self._environment = os.environ | _OF_SERVERS
        self._door, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self._lock = threading.Lock()
        command = [sys.executable, "-P", str(_SERVER), str(theirs.fileno()), kind]
        with theirs:
            self._process = RealPopen(
                command,
                env=self._environment,
                pass_fds=(theirs.fileno(),),
                stdin=subprocess.DEVNULL,
                start_new_session=True,
            )
        self._door.settimeout(_PATIENCE)
        self.is_ready = self._door.recv(LARGEST) == b"ready"

    def takes(self, environment: Mapping[str, str]) -> bool:
        """A program with this environment would have started like this process."""
        names = filter(_READ_AT_START.fullmatch, {*environment, *self._environment})
        return all(self._has(name, environment.get(name)) for name in names)

    def _has(self, name: str, value: str | None) -> bool:
        ours = self._environment.get(name)
        return value in (ours, _MEANS_THE_SAME.get(name, ours))

    def fork(self, request: Mapping[str, Any], descriptors: Sequence[int]) -> int | None:
        message = json.dumps(request).encode()
        if len(message) > LARGEST or len(descriptors) > MOST_DESCRIPTORS:
            return None
        with self._lock:
            if not _adopt(True):
                return None
            try:
                socket.send_fds(self._door, [message], descriptors)
                return int(self._door.recv(LARGEST) or 0) or None
            except ConnectionError:  # it has ended
                return None
            finally:
                _adopt(False)

    def end(self) -> None:
        self._door.close()
        self._process.kill()
        self._process.wait()


def _adopt(on: bool) -> bool:
    """Let this process adopt orphans below it, or stop doing so."""
    return bool(ctypes.CDLL(None).prctl(_SET_CHILD_SUBREAPER, int(on), 0, 0, 0) == 0)


class WarmPopen(subprocess.Popen[Any]):
    """Starts a program like subprocess, but forked if that makes no difference."""

    was_forked = False

    def _execute_child(self, *arguments: Any, **more: Any) -> None:
        asked = _START.bind(self, *arguments, **more).arguments
        pid = _forked(asked)
        if pid is None:
            super()._execute_child(*arguments, **more)  # type: ignore[misc]
            return
        self.pid, self.was_forked = pid, True
        self._child_created = True
        pipes = ("p2cread", "p2cwrite", "c2pread", "c2pwrite", "errread", "errwrite")
        self._close_pipe_fds(*(asked[name] for name in pipes))  # type: ignore[attr-defined]


def _forked(asked: Mapping[str, Any]) -> int | None:
    """Return the process that Popen is ``asked`` to start, or None if it cannot be forked."""
    usual = {"preexec_fn": None, "shell": False, "gid": None, "gids": None, "uid": None, "umask": -1}
    usual |= {"close_fds": True, "restore_signals": True, "process_group": -1, "executable": None}
    command = asked["args"]
    if not isinstance(command, (list, tuple)) or any(asked[name] != value for name, value in usual.items()):
        return None
    command = [os.fspath(each) for each in command]
    how = command[1 + (command[1:2] == ["-P"]) :]
    if command[0] != _PYTHON or how[:1] not in (["-m"], ["-c"]) or _ASKS_WHAT_IS_IMPORTED in how[1]:
        return None
    environment = dict(os.environ if asked["env"] is None else asked["env"])
    server = _server("watched" if _WATCHED in command[-1] else "ours")
    if server is None or not server.takes(environment):
        return None
    folder = os.path.abspath(asked["cwd"] or ".")
    if not os.path.isdir(folder):
        return None
    given = (asked["p2cread"], asked["c2pwrite"], asked["errwrite"])
    descriptors = {number: number if each == -1 else each for number, each in enumerate(given)}
    descriptors |= {int(each): int(each) for each in asked["pass_fds"]}
    os.umask(umask := os.umask(0))
    request = {
        "command": command,
        "environment": environment,
        "folder": folder,
        "session": bool(asked["start_new_session"]),
        "umask": umask,
        "descriptors": list(descriptors),
    }
    return server.fork(request, list(descriptors.values()))


_PYTHON: Final = sys.executable
_SERVERS: Final = dict[str, ForkServer | None]()
_STARTING: Final = threading.Lock()


def _server(kind: str) -> ForkServer | None:
    with _STARTING:
        if kind not in _SERVERS:
            started = ForkServer(kind)
            _SERVERS[kind] = started if started.is_ready else None
        return _SERVERS[kind]


@pytest.fixture(autouse=True, scope="session")
def programs_are_forked() -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        if sys.platform == "linux":
            patch.setattr(subprocess, "Popen", WarmPopen)
        yield
    for server in filter(None, _SERVERS.values()):
        server.end()
    _SERVERS.clear()


@pytest.fixture
def real_start(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(subprocess, "Popen", RealPopen)
