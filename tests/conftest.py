"""Which tests share a process, as the suite runs in several, and where their sessions go."""

from __future__ import annotations

import gc
import signal
from itertools import count

import pytest

_TESTS = count()


@pytest.fixture(autouse=True)
def _sessions_of_its_own(monkeypatch: pytest.MonkeyPatch, tmp_path_factory: pytest.TempPathFactory) -> None:
    """No test reads or writes the sessions of whoever runs it; programs that tests start do not either."""
    folder = tmp_path_factory.getbasetemp() / "sessions" / str(next(_TESTS))
    monkeypatch.setenv("RL_TUI_SESSIONS_DIR", str(folder))


def pytest_sessionstart() -> None:
    """Let interrupts count: what a shell runs in its background ignores them, and so would its programs."""
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_collection_finish() -> None:
    """Look for garbage less often: looking through all that the libraries hold took a sixth of the time."""
    gc.freeze()
    gc.set_threshold(50_000, 20, 20)


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Keep the tests of an algorithm together, so that its loop is compiled once, and the rest of a file.

    A file may name another group, to share it with other files.
    """
    for item in items:
        if item.get_closest_marker("xdist_group"):
            continue
        parameters = item.callspec.params if hasattr(item, "callspec") else {}
        item.add_marker(pytest.mark.xdist_group(str(parameters.get("algorithm", item.path.stem))))
