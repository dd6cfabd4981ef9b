"""The start of the program on screen, for one user or as a kiosk."""

from __future__ import annotations

import ctypes
import gc
import os
import shlex
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
from rl_tui.common.findings import printable
from rl_tui.common.kiosk import VARIABLE, in_kiosk
from rl_tui.screen.app.display import Display
from rl_tui.screen.terminal.driver_choice import IN_BROWSER, in_browser

if TYPE_CHECKING:
    from rl_tui.live.programs.watched_program import WatchedProgram
    from rl_tui.live.sessions.autosave import KeptSession
    from rl_tui.programs.watched.program_process import ProgramRequest
    from rl_tui.screen.app.opening import Start
    from rl_tui.screen.theme.glyphs import Glyphs


# The kiosk


COMMANDS: Final = (None, "play", "learn", "list", "serve")
"""What a kiosk has; None is the catalogue."""
MOST_DATA: Final = 2**30
"""Bytes of memory that one kiosk may ask for; it uses far less."""
_NICENESS: Final = 10
_MOST_OPEN: Final = 256
_THREADS: Final = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
# Of the variables that make Textual log, debug, take pictures or import what they name, only these are left
_HARMLESS: Final = ("TEXTUAL_FPS", "TEXTUAL_COLOR_SYSTEM", "TEXTUAL_ANIMATIONS")


def _turn_on(_: click.Context, __: click.Parameter, value: bool) -> None:
    if value:
        os.environ[VARIABLE] = "1"


kiosk_option: Final = click.option(
    "--kiosk",
    is_flag=True,
    is_eager=True,  # it counts from the moment it is read
    expose_value=False,
    callback=_turn_on,
    help="for strangers: shipped scenarios only, no files written or read, bounded memory",
)


def enter_kiosk(command: str | None) -> None:
    """Prepare this process for ``command`` if it is a kiosk, before anything heavy is imported.

    Raises UserError where a kiosk does not have that command.
    """
    if not in_kiosk():
        return
    if command not in COMMANDS:
        raise UserError(
            f"kiosk mode has no {command}: it plays the shipped scenarios, and neither reads nor writes files"
        )
    sys.dont_write_bytecode = True
    os.environ.update(dict.fromkeys(_THREADS, "1"))
    for name, value in list(os.environ.items()):
        is_ours = (name, value) == ("TEXTUAL_DRIVER", IN_BROWSER)
        if name == "TEXTUAL" or (name.startswith("TEXTUAL_") and name not in _HARMLESS and not is_ours):
            del os.environ[name]


def confine() -> None:
    """Let the system hold this process to what a kiosk needs, and yield to others; nothing takes it back.

    No file can be written, not even by a fault in the program. Nothing happens where the system knows no
    such limits (Windows).
    """
    try:
        import resource
    except ImportError:
        return
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
"""So many files may be open at once, or more: screen, sockets, workers and modules that are imported."""
WORTH_TELLING: Final = 3.0  # seconds without an environment
_ARENA_MAX: Final = -8  # M_ARENA_MAX in glibc's malloc.h


class NoTerminalError(click.ClickException):
    """There is nothing to draw on."""

    exit_code = USAGE


def require_terminal(instead: str = "rl-tui train and rl-tui screenshot do without") -> None:
    """Raise NoTerminalError, in one sentence that ends with ``instead``, where nothing can be drawn."""
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
    """Raise UserError where so few files may be open that no screen, or no worker, could start."""
    if sys.platform == "win32":
        return
    import resource

    allowed, most = resource.getrlimit(resource.RLIMIT_NOFILE)
    if not 0 <= allowed < FEWEST_FILES:  # below 0: without a limit
        return
    if 0 <= most < FEWEST_FILES:
        raise UserError(
            f"only {most} files may be open at once (ulimit -n); the playground needs {FEWEST_FILES}"
        )
    resource.setrlimit(resource.RLIMIT_NOFILE, (FEWEST_FILES, most))


def run_app(display: Display, start: Start | ProgramRequest = None) -> None:
    """Show the catalogue, or what ``start`` says, until the user quits.

    A program is started first: what keeps it from being shown is said on the terminal as it was. Raises
    UserError where a fault ended it.
    """
    from rl_tui.programs.watched.program_process import ProgramRequest

    if isinstance(start, ProgramRequest):
        with started(start) as program:
            _run_app(display, program)
    else:
        _run_app(display, start)


@contextmanager
def started(request: ProgramRequest) -> Iterator[WatchedProgram]:
    """Yield the program of ``request``, which stands before its first step; it ends with the context.

    Raises UserError where it cannot be shown, and in a kiosk.
    """
    from rl_tui.live.programs.watched_program import WatchedProgram

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
    """Yield what is called while one waits for an environment; it says so on stderr, a line that goes again.

    What the program was noted for until then may say why, and stays. What it returns is always true.
    """
    begun, said, noted = time.monotonic(), 0, 0

    def go_on() -> bool:
        nonlocal said, noted
        waited = int(time.monotonic() - begun)
        if waited > said and waited >= WORTH_TELLING:
            said = waited
            at = "" if program.log.stands_at is None else f", now in line {program.log.stands_at[1]}"
            name = printable(program.request.path.name)
            text = f"{name} has not made an environment yet ({waited} s{at}); ctrl+c ends it"
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
    """Raise UserError where others use the program: somebody's own code runs with all rights of its user."""
    if in_kiosk() or in_browser():
        raise UserError("your own code runs neither in a kiosk nor where the program is served")


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
    if app.kept is not None and not in_browser():  # where there is no shell
        _tell_what_is_kept(app.kept, app.look.glyphs)


def _tell_what_is_kept(kept: KeptSession, glyphs: Glyphs) -> None:
    """Tell on stderr, which is the shell's again, how to go on; it is kept even if nobody can be told."""
    from rl_tui.screen.draw.to_ascii import separated

    with suppress(OSError):
        complain(f"kept: {separated(kept.title, glyphs)}, at step {kept.step:,}")
        complain(f"to go on: rl-tui play {shlex.quote(str(kept.path))}")


def _stand_somewhere() -> None:
    """Go to the folder of temporary files where the one that the program was started in is gone.

    Libraries ask where they are: to compile a kernel needs that.
    """
    try:
        Path.cwd()
    except OSError:
        from tempfile import gettempdir

        os.chdir(gettempdir())


@contextmanager
def _nothing_collected() -> Iterator[None]:
    """Keep the garbage collector from what is made here, now and later: of modules nothing is garbage.

    Measured: it takes a tenth of the time of the imports before the first paint.
    """
    gc.disable()
    try:
        yield
    finally:
        gc.freeze()
        gc.enable()


def _share_heap() -> None:
    """Have all threads allocate in one heap; to be called before there are any.

    glibc gives each thread one of its own, in which holes stay where others have freed what it allocated.
    Measured: with runs opened and ended beside one another, 74 MB more in a few minutes against 30. Kernels
    allocate nothing, so that none of them waits for the heap. Other C libraries have one anyway.
    """
    with suppress(AttributeError, OSError, TypeError):
        ctypes.CDLL(None).mallopt(_ARENA_MAX, 1)
