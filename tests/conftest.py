"""Which tests share a process, as the suite runs in several, and what they find around them."""

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
from collections.abc import Iterator
from contextlib import suppress
from itertools import count
from typing import Final, NoReturn

import pytest
from kinds import INTERPRETED, KINDS, SLOW, about, is_quick, kind_of
from warm_start import _programs_are_forked, real_start  # noqa: F401

from rl_tui.agents.compiling.loops import compile_what_all_share
from rl_tui.agents.kernels.machine_code import COMPILED_LOOPS
from rl_tui.agents.learner import Learner

_TESTS = count()
_OF_THE_PROGRAM: Final = re.compile("RL_TUI_.*|TEXTUAL.*|ESCDELAY")
_KEPT: Final = re.compile("RL_TUI_CACHE_DIR|TEXTUAL_SNAPSHOT_.*")  # compiled code, and what pytest sets
_OF_A_PERSON: Final = re.compile(  # their terminal, language, shell and login
    "(LC|SSH|TERM|TMUX|WT)_.*|LANGUAGE|COLUMNS|LINES|COLORTERM|(NO|FORCE)_COLOR|CLICOLOR.*|TERMCAP|TMUX"
    "|STY|WINDOW|(SYS)?SCREEN(DIR|RC)|ENV|BASH_ENV|PROMPT_COMMAND|TMOUT"
    "|PYTHON(WARNINGS|DEVMODE|IOENCODING|UTF8|COERCECLOCALE)"
)
_UTF_8: Final = "C.UTF-8"

# At once, since the program looks at some of these when it is imported
for _name in filter(_OF_THE_PROGRAM.fullmatch, list(os.environ)):
    if not _KEPT.fullmatch(_name):
        del os.environ[_name]
# Tests are listed for each scenario there is: those of the person who runs them are none
os.environ["XDG_CONFIG_HOME"] = os.path.join(os.path.dirname(__file__), "nobody")
if "textual.constants" in sys.modules:  # the plugin for pictures was here first
    importlib.reload(sys.modules["textual.constants"])


@pytest.fixture(autouse=True, scope="session")
def _nothing_of_a_person(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Tests, and the programs that they start, are alike for everybody, in every terminal and everywhere."""
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
            locale.setlocale(locale.LC_CTYPE, _UTF_8)  # in which files are read and written
        yield
    time.tzset()
    locale.setlocale(locale.LC_CTYPE, before)


@pytest.fixture(autouse=True)
def _sessions_of_its_own(monkeypatch: pytest.MonkeyPatch, tmp_path_factory: pytest.TempPathFactory) -> None:
    """No test reads or writes the sessions of another; programs that tests start do not either."""
    folder = tmp_path_factory.getbasetemp() / "sessions" / str(next(_TESTS))
    monkeypatch.setenv("RL_TUI_SESSIONS_DIR", str(folder))


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add what ``make test-quick`` asks for."""
    group = parser.getgroup("rl-tui")
    group.addoption("--quick", action="store_true", help="unit tests, and a picture of each screen")
    group.addoption("--for", dest="subject", default="", help="tests about an id, a panel or a module")


def pytest_configure(config: pytest.Config) -> None:
    """Register the kinds, and let hypothesis try the same examples in every run, however long they take.

    ``--hypothesis-profile=default`` looks for others. A change is then judged by what it changes.
    Nothing is written down, so the folder may be read-only.
    """
    for line in (*(f"{kind}: {meaning}" for kind, meaning in KINDS.items()), SLOW, INTERPRETED):
        config.addinivalue_line("markers", line)
    config.addinivalue_line("markers", "exhaustive(reason): left out of python -m pytest; --all runs it too")
    from hypothesis import settings

    settings.register_profile("repeatable", derandomize=True, database=None, deadline=None)
    if not config.getoption("--hypothesis-profile"):
        settings.load_profile("repeatable")


def pytest_sessionstart() -> None:
    """Let signals count that a shell's background, or nohup, ignores: programs that tests start would too."""
    for number in (signal.SIGINT, signal.SIGQUIT, signal.SIGHUP):
        if signal.getsignal(number) is signal.SIG_IGN:
            usual = signal.default_int_handler if number is signal.SIGINT else signal.SIG_DFL
            signal.signal(number, usual)


def pytest_collection_finish() -> None:
    """Look for garbage less often: looking through all that the libraries hold took a sixth of the time."""
    gc.freeze()
    gc.set_threshold(50_000, 20, 20)


@pytest.fixture(autouse=True)
def _is_of_its_kind(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Refuse a unit test what would make it slow."""

    def refused(*_: object, **__: object) -> NoReturn:
        raise AssertionError("a unit test starts no app and no process: mark it as screen or process")

    if request.node.get_closest_marker("unit"):
        monkeypatch.setattr(subprocess, "Popen", refused)
        monkeypatch.setattr("textual.app.App.run_test", refused)
        monkeypatch.setattr("textual.app.App.run_async", refused)


@pytest.fixture(autouse=True, scope="session")
def _what_all_share_is_compiled() -> None:
    compile_what_all_share()


@pytest.fixture(autouse=True)
def _is_compiled_first(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Have a loop compiled, or read from the cache, before its first step, unless a test says otherwise.

    Interpreted the tests would take hours. Child processes do as the program does.
    """

    def is_compiled(learner: Learner) -> bool:
        if learner.loop not in COMPILED_LOOPS:
            learner.compile()
        return True

    if not request.node.get_closest_marker("interpreted"):
        monkeypatch.setattr(Learner, "is_compiled", property(is_compiled))


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Mark each test with its kind, leave out what was not asked for, and say which share a process.

    The tests of an algorithm do, so that its loop is compiled once, and the rest of a file. A file may name
    another group, to share it with other files.
    """
    for item in items:
        if not any(item.get_closest_marker(kind) for kind in KINDS):
            item.add_marker(kind_of(item))
    wanted = about(items, config.option.subject) if config.option.subject else items
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
