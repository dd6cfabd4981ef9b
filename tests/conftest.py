"""The groups, choice and surroundings of tests."""

from __future__ import annotations

import gc
import importlib
import locale
import os
import re
import signal
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import suppress
from itertools import count
from pathlib import Path
from types import SimpleNamespace
from typing import Any, Final, NoReturn

import pytest
from kinds import (
    COMPILED,
    EXHAUSTIVE,
    INTERPRETED,
    KINDS,
    SLOW,
    about,
    is_everyday,
    is_quick,
    kind_of,
    may_be_about,
    take_few_examples,
)
from warm_start import programs_are_forked, real_start  # noqa: F401

from rl_tui.agents.compiling.background import BACKGROUND
from rl_tui.agents.compiling.cache_folder import was_compiled
from rl_tui.agents.compiling.loops import compile_here
from rl_tui.agents.kernels.machine_code import COMPILED_LOOPS, SHARED, Loop
from rl_tui.agents.kernels.position import Stop
from rl_tui.agents.learner import UNLIMITED, Learner
from rl_tui.common.packages import is_installed
from rl_tui.live.pace import interpreter
from rl_tui.runs.background import background

_TESTS = count()
_INTERPRETED = Counter[Loop]()
_STEPS_INTERPRETED: Final = 100_000
_OF_THE_PROGRAM: Final = re.compile("RL_TUI_.*|TEXTUAL.*|ESCDELAY")
_KEPT: Final = re.compile("RL_TUI_CACHE_DIR|TEXTUAL_SNAPSHOT_.*")  # compiled code, and what pytest sets
_OF_A_PERSON: Final = re.compile(  # their terminal, language, shell and login
    "(LC|SSH|TERM|TMUX|WT)_.*|LANGUAGE|COLUMNS|LINES|COLORTERM|(NO|FORCE)_COLOR|CLICOLOR.*|TERMCAP|TMUX"
    "|STY|WINDOW|(SYS)?SCREEN(DIR|RC)|ENV|BASH_ENV|PROMPT_COMMAND|TMOUT"
    "|PYTHON(WARNINGS|DEVMODE|IOENCODING|UTF8|COERCECLOCALE)"
)
_UTF_8: Final = "C.UTF-8"
_LONGEST_TEST: Final = 300  # seconds

# At once: the program reads some of these on import
for _name in filter(_OF_THE_PROGRAM.fullmatch, list(os.environ)):
    if not _KEPT.fullmatch(_name):
        del os.environ[_name]
# Otherwise each program that tests start would compile the source of its imports
sys.dont_write_bytecode = False
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
# As the program does. In several processes, the threads of NumPy would wait for each other at full speed
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
# Tests are listed for each available scenario: leave out your own
os.environ["XDG_CONFIG_HOME"] = os.path.join(os.path.dirname(__file__), "nobody")
if "textual.constants" in sys.modules:  # the plugin for pictures came first
    importlib.reload(sys.modules["textual.constants"])


@pytest.fixture(autouse=True, scope="session")
def _nothing_of_a_person(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    folder = tmp_path_factory.getbasetemp()
    before = locale.setlocale(locale.LC_CTYPE)
    with pytest.MonkeyPatch.context() as patch:
        for name in filter(_OF_A_PERSON.fullmatch, list(os.environ)):
            patch.delenv(name)
        for name in ("XDG_CONFIG_HOME", "XDG_DATA_HOME", "XDG_STATE_HOME"):
            patch.setenv(name, str(folder / "nobody"))
        patch.setenv("RL_TUI_SESSIONS_DIR", str(folder / "sessions" / "shared"))
        patch.setenv("TERM", "xterm-256color")
        patch.setenv("LANG", _UTF_8)
        patch.setenv("TZ", "UTC")
        time.tzset()
        with suppress(locale.Error):
            locale.setlocale(locale.LC_CTYPE, _UTF_8)  # the encoding of files
        yield
    time.tzset()
    locale.setlocale(locale.LC_CTYPE, before)


@pytest.fixture(autouse=True)
def _sessions_of_its_own(monkeypatch: pytest.MonkeyPatch, tmp_path_factory: pytest.TempPathFactory) -> None:
    folder = tmp_path_factory.getbasetemp() / "sessions" / str(next(_TESTS))
    monkeypatch.setenv("RL_TUI_SESSIONS_DIR", str(folder))


def pytest_addoption(parser: pytest.Parser) -> None:
    group = parser.getgroup("rl-tui")
    group.addoption("--all", action="store_true", help="exhaustive tests too")
    group.addoption("--quick", action="store_true", help="unit tests, and a picture of each screen")
    group.addoption("--for", dest="subject", default="", help="tests about an id, a panel or a module")


def pytest_configure(config: pytest.Config) -> None:
    """Register the kinds, and let hypothesis try the same examples in every run, without a deadline.

    ``--hypothesis-profile=default`` tries other examples. Nothing is saved, so the folder may be read-only.
    """
    for line in (
        *(f"{kind}: {meaning}" for kind, meaning in KINDS.items()),
        SLOW,
        EXHAUSTIVE,
        INTERPRETED,
        COMPILED,
    ):
        config.addinivalue_line("markers", line)
    from hypothesis import settings

    settings.register_profile("repeatable", derandomize=True, database=None, deadline=None)
    if not config.getoption("--hypothesis-profile"):
        settings.load_profile("repeatable")


def pytest_sessionstart() -> None:
    """Reset signals that nohup or a background shell ignores: child programs would inherit that."""
    for number in (signal.SIGINT, signal.SIGQUIT, signal.SIGHUP):
        if signal.getsignal(number) is signal.SIG_IGN:
            usual = signal.default_int_handler if number is signal.SIGINT else signal.SIG_DFL
            signal.signal(number, usual)


def pytest_collection() -> None:
    """Collection leaves no garbage, but the collector took a quarter of its time."""
    gc.disable()


def pytest_collection_finish() -> None:
    """Scanning the libraries' objects for garbage took a sixth of the time."""
    gc.freeze()
    gc.set_threshold(50_000, 20, 20)
    gc.enable()


def pytest_unconfigure() -> None:
    """Collect garbage once: pytest does it five times, each half a second over all that tests left."""
    gc.collect()
    gc.freeze()


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call(item: pytest.Item) -> Iterator[None]:
    def end(*_: object) -> NoReturn:
        raise TimeoutError(f"{item.nodeid} took longer than {_LONGEST_TEST} s")

    before = signal.signal(signal.SIGALRM, end)
    signal.alarm(_LONGEST_TEST)
    try:
        return (yield)
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


@pytest.fixture(autouse=True)
def _is_of_its_kind(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Refuse slow operations in unit tests."""

    def refused(*_: object, **__: object) -> NoReturn:
        raise AssertionError("a unit test starts no app and no process: mark it as screen or process")

    if request.node.get_closest_marker("unit"):
        monkeypatch.setattr(subprocess, "Popen", refused)
        monkeypatch.setattr("textual.app.App.run_test", refused)
        monkeypatch.setattr("textual.app.App.run_async", refused)
        monkeypatch.setattr(BACKGROUND, "want", lambda _: None)


@pytest.fixture(autouse=True)
def _what_is_loaded_stays_frozen(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Turn off players' garbage collections: with all loaded modules they take a second each."""
    if "real_collections" not in request.fixturenames:
        nothing = SimpleNamespace(unfreeze=bool, collect=bool, freeze=bool)
        monkeypatch.setattr(interpreter, "gc", nothing)


@pytest.fixture
def processes(monkeypatch: pytest.MonkeyPatch) -> list[subprocess.Popen[bytes]]:
    started: list[subprocess.Popen[bytes]] = []
    start = background.python_process

    def noted(*args: Any) -> subprocess.Popen[bytes]:
        started.append(start(*args))
        return started[-1]

    monkeypatch.setattr(background, "python_process", noted)
    return started


@pytest.fixture
def real_collections() -> None:
    """Let players freeze loaded objects for the garbage collector, as for people."""


@pytest.fixture(autouse=True, scope="session")
def _what_all_share_is_compiled() -> None:
    if is_installed("numba"):
        compile_here(SHARED)  # one process at a time, so that the others find it


@pytest.fixture(autouse=True)
def _is_compiled_where_it_pays(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Compile a loop only after many steps: it takes as long as 300,000 interpreted ones."""
    if request.node.get_closest_marker("interpreted") or not is_installed("numba"):
        return
    most = 0 if request.node.get_closest_marker("compiled") else _STEPS_INTERPRETED
    take, compile_loop = Learner._advance, Learner.compile

    def compile_as_the_program_does(self: Learner) -> None:
        with pytest.MonkeyPatch.context() as plain:
            plain.setattr(Learner, take.__name__, take)
            compile_loop(self)

    def advance(self: Learner, steps: int, episodes: int, *, compiled: bool) -> int:
        loop = self.loop
        if not compiled or loop in COMPILED_LOOPS:
            return take(self, steps, episodes, compiled=compiled)
        left = most - _INTERPRETED[loop]
        if steps and (was_compiled(loop) or left <= 0):
            self.compile()
            return take(self, steps, episodes, compiled=True)
        first = min(steps, left)
        before, finished = self.step, self.episodes
        stop = take(self, first, episodes, compiled=False)
        taken = self.step - before
        _INTERPRETED[loop] += taken
        rest = episodes if episodes == UNLIMITED else episodes - (self.episodes - finished)
        if stop == Stop.DONE and taken == first < steps and rest:
            return advance(self, steps - taken, rest, compiled=True)
        return stop

    monkeypatch.setattr(Learner, "compile", compile_as_the_program_does)
    monkeypatch.setattr(Learner, take.__name__, advance)
    monkeypatch.setattr(Learner, "is_compiled", True)


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    subject = config.option.subject
    is_test = collection_path.name.startswith("test_") and collection_path.suffix == ".py"
    return True if subject and is_test and not may_be_about(collection_path, subject) else None


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Mark each test with its kind, leave out tests not asked for, and group tests by process.

    The tests of an algorithm share a process, which compiles its loop once, and so do the other tests of a
    file.
    """
    for item in items:
        if not any(item.get_closest_marker(kind) for kind in KINDS):
            item.add_marker(kind_of(item))
    wanted = about(items, config.option.subject) if config.option.subject else items
    if not (config.option.all or config.option.subject):
        wanted = [item for item in wanted if is_everyday(item, config.args)]
        for test in {item.obj for item in wanted if hasattr(item.obj, "hypothesis")}:
            take_few_examples(test)
    if config.option.quick:
        wanted = [item for item in wanted if is_quick(item)]
    if len(wanted) < len(items):
        kept = set(wanted)
        config.hook.pytest_deselected(items=[item for item in items if item not in kept])
        items[:] = wanted
    for item in items:
        if item.get_closest_marker("xdist_group"):
            continue
        parameters = item.callspec.params if hasattr(item, "callspec") else {}
        item.add_marker(pytest.mark.xdist_group(str(parameters.get("algorithm", item.path.stem))))
