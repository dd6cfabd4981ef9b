"""The start of the app, for one user or as a kiosk."""

from __future__ import annotations

import ctypes
import gc
import os
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Final

import click

from rl_tui.commands.line.descriptors import screen_alone
from rl_tui.commands.line.output import complain
from rl_tui.commands.line.program import USAGE
from rl_tui.common.errors import UserError
from rl_tui.common.findings import command_line, printable
from rl_tui.common.kiosk import VARIABLE, in_kiosk
from rl_tui.screen.app.display import Display
from rl_tui.screen.terminal.driver_choice import IN_BROWSER, in_browser

if TYPE_CHECKING:
    from rl_tui.live.sessions.autosave import KeptSession
    from rl_tui.programs.watched.program_process import ProgramRequest
    from rl_tui.programs.watched.watched_program import WatchedProgram
    from rl_tui.screen.app.opening import Start
    from rl_tui.screen.theme.glyphs import Glyphs


# The kiosk


COMMANDS: Final = (None, "play", "learn", "list", "serve")
"""Commands available in a kiosk. None is the start screen."""
MOST_DATA: Final = 2**30
"""Memory limit of one kiosk in bytes. It needs far less."""
_NICENESS: Final = 10
_MOST_OPEN: Final = 256
_THREADS: Final = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
# Textual reads variables that make it log, debug, take pictures or import modules. A kiosk keeps only these
_HARMLESS: Final = ("TEXTUAL_FPS", "TEXTUAL_COLOR_SYSTEM", "TEXTUAL_ANIMATIONS")


def _turn_on(_: click.Context, __: click.Parameter, value: bool) -> None:
    if value:
        os.environ[VARIABLE] = "1"


kiosk_option: Final = click.option(
    "--kiosk",
    is_flag=True,
    is_eager=True,  # applies as soon as it is read
    expose_value=False,
    callback=_turn_on,
    help="for public use: shipped scenarios only, no access to files, limited memory",
)


def enter_kiosk(command: str | None) -> None:
    """Prepare for `command` if this is a kiosk, before heavy imports.

    Raises:
        UserError: A kiosk does not have this command.
    """
    if not in_kiosk():
        return
    if command not in COMMANDS:
        raise UserError(f"kiosk mode has no {command}: it shows only scenarios of rl-tui, and opens no files")
    sys.dont_write_bytecode = True
    os.environ.update(dict.fromkeys(_THREADS, "1"))
    for name, value in list(os.environ.items()):
        is_ours = (name, value) == ("TEXTUAL_DRIVER", IN_BROWSER)
        if name == "TEXTUAL" or (name.startswith("TEXTUAL_") and name not in _HARMLESS and not is_ours):
            del os.environ[name]


def confine() -> None:
    """Restrict this process permanently to what a kiosk needs, and lower its priority.

    Even a bug cannot write files afterwards. Windows has no such limits.
    """
    if sys.platform == "win32":
        return
    import resource

    for kind, most in (
        (resource.RLIMIT_FSIZE, 0),
        (resource.RLIMIT_CORE, 0),
        (resource.RLIMIT_DATA, MOST_DATA),
        (resource.RLIMIT_NOFILE, _MOST_OPEN),
    ):
        with suppress(OSError, ValueError):
            hard = resource.getrlimit(kind)[1]
            least = most if hard == resource.RLIM_INFINITY else min(most, hard)
            resource.setrlimit(kind, (least, least))
    with suppress(OSError):
        os.nice(_NICENESS)


# Opening the screen


FEWEST_FILES: Final = 64
"""Smallest number of open files that the app needs, for screen, sockets, workers and imports."""
WORTH_TELLING: Final = 3.0  # seconds without an environment
_ARENA_MAX: Final = -8  # M_ARENA_MAX in glibc's malloc.h


class NoTerminalError(click.ClickException):
    """There is no terminal to draw on."""

    exit_code = USAGE


def require_terminal(instead: str = "rl-tui train and rl-tui screenshot work without one") -> None:
    """Check that the app can draw here. `instead` says what works without a terminal.

    Raises:
        NoTerminalError: Input or output is not a terminal, or its type is unknown.
    """
    if in_browser():
        return
    streams = {"stdin": sys.stdin, "stdout": sys.stdout}
    elsewhere = [name for name, stream in streams.items() if not (stream and stream.isatty())]
    term = os.environ.get("TERM", "")
    if elsewhere:
        problem = f"the playground needs a terminal, and {elsewhere[0]} is not one"
    elif term in ("dumb", "unknown"):
        problem = f"the playground cannot draw on a terminal of type {term} (TERM={term})"
    elif not term and sys.platform != "win32":
        problem = "the playground cannot draw on a terminal of no known type (TERM is not set)"
    else:
        return
    raise NoTerminalError(f"{problem}; {instead}")


def require_open_files() -> None:
    """Raise the soft limit of open files if it is too low.

    Raises:
        UserError: The hard limit is too low as well.
    """
    if sys.platform == "win32":
        return
    import resource

    allowed, most = resource.getrlimit(resource.RLIMIT_NOFILE)
    if not 0 <= allowed < FEWEST_FILES:  # below 0: without a limit
        return
    if 0 <= most < FEWEST_FILES:
        raise UserError(
            f"only {most} files may be open at once; raise this limit with ulimit -n {FEWEST_FILES}"
        )
    resource.setrlimit(resource.RLIMIT_NOFILE, (FEWEST_FILES, most))


def run_app(display: Display, start: Start | ProgramRequest = None) -> None:
    """Show the app, from `start` (None: the start screen), until the user quits.

    A program is started before the screen opens, so its errors appear on the normal terminal.

    Raises:
        UserError: An error ended the app.
    """
    from rl_tui.programs.watched.program_process import ProgramRequest

    if isinstance(start, ProgramRequest):
        with started(start) as program:
            _run_app(display, program)
    else:
        _run_app(display, start)


@contextmanager
def started(request: ProgramRequest) -> Iterator[WatchedProgram]:
    """Yield the running program, stopped before its first step.

    Raises:
        UserError: The program cannot be shown, or this is a kiosk.
    """
    from rl_tui.programs.watched.watched_program import WatchedProgram

    refuse_where_served()
    program = WatchedProgram(request)
    try:
        with _waiting_said(program) as go_on:
            program.wait_for_environment(go_on)
        yield program
    finally:
        program.end()


@contextmanager
def _waiting_said(program: WatchedProgram) -> Iterator[Callable[[], bool]]:
    # The callback shows how long the program is not ready, and returns True
    from rl_tui.programs.watched.notebook import place_in_words

    begun, said, noted = time.monotonic(), 0, 0

    def go_on() -> bool:
        nonlocal said, noted
        waited = int(time.monotonic() - begun)
        if waited > said and waited >= WORTH_TELLING:
            said = waited
            at = "" if program.log.stands_at is None else f", now in {place_in_words(*program.log.stands_at)}"
            name = printable(program.request.path.name)
            text = f"{name} is not ready for its first step yet ({waited} s{at}); ctrl+c ends it"
            click.echo("\r\x1b[K", err=True, nl=False)
            for note in program.log.notes[noted:]:
                complain(f"rl-tui: {name}: {note}")
                noted += 1
            click.echo(text, err=True, nl=False)
        return True

    try:
        yield go_on
    finally:
        if said:
            click.echo("\r\x1b[K", err=True, nl=False)


def refuse_where_served() -> None:
    """Raise UserError in a kiosk or browser, where others use the program."""
    if in_kiosk() or in_browser():
        raise UserError("your own code does not run in a kiosk or in rl-tui serve")


def _run_app(display: Display, start: Start) -> None:
    require_terminal()
    require_open_files()
    _stand_somewhere()
    _share_heap()
    with _nothing_collected():
        from rl_tui.live.sessions.place import session_folder
        from rl_tui.screen.app.app import RlTuiApp

    if in_kiosk():
        app = RlTuiApp(display, start, kiosk=True)
        confine()
    else:
        app = RlTuiApp(display, start, sessions=session_folder())
    with screen_alone():
        fault = app.run(mouse=display.mouse)
    if app.bug is not None:
        raise app.bug
    if fault is not None:
        raise fault
    if app.return_code:
        click.get_current_context().exit(app.return_code)
    if app.kept is not None and not in_browser():  # a browser has no shell to continue in
        _tell_what_is_kept(app.kept, app.look.glyphs)


def _tell_what_is_kept(kept: KeptSession, glyphs: Glyphs) -> None:
    with suppress(OSError):
        complain(f"saved: {glyphs.separated(kept.title)}, at step {kept.step:,}")
        complain(f"continue with: rl-tui play {command_line([str(kept.path)])}")


def _stand_somewhere() -> None:
    # Libraries ask for the current folder, even if it was deleted
    try:
        Path.cwd()
    except OSError:
        from tempfile import gettempdir

        os.chdir(gettempdir())


@contextmanager
def _nothing_collected() -> Iterator[None]:
    # Collecting garbage takes a tenth of the import time
    gc.disable()
    try:
        yield
    finally:
        gc.freeze()
        gc.enable()


def _share_heap() -> None:
    # glibc gives each thread its own heap, which fragments when other threads free its memory: 74 MB more in
    # a few minutes, against 30 MB. This must happen before threads start
    with suppress(AttributeError, OSError, TypeError):
        ctypes.CDLL(None).mallopt(_ARENA_MAX, 1)
