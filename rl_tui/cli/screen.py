"""Starting the program on screen."""

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

from rl_tui.cli.descriptors import screen_alone
from rl_tui.cli.kiosk import confine
from rl_tui.cli.output import complain
from rl_tui.cli.program import USAGE
from rl_tui.common.errors import UserError
from rl_tui.common.findings import printable
from rl_tui.common.kiosk import in_kiosk
from rl_tui.terminal.driver_choice import in_browser
from rl_tui.tui.app.display import Display

if TYPE_CHECKING:
    from rl_tui.lab.live_programs.watched_program import WatchedProgram
    from rl_tui.lab.programs.program_process import ProgramRequest
    from rl_tui.lab.sessions.autosave import KeptSession
    from rl_tui.tui.app.opening import Start
    from rl_tui.tui.theme.glyphs import Glyphs


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
    from rl_tui.lab.programs.program_process import ProgramRequest

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
    from rl_tui.lab.live_programs.watched_program import WatchedProgram

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
        from rl_tui.lab.sessions.place import session_folder
        from rl_tui.tui.app.app import RlTuiApp

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
    from rl_tui.tui.draw.to_ascii import separated

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
