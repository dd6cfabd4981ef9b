"""The entry point of the command line."""

from __future__ import annotations

import os
import sys
import threading
from contextlib import suppress
from pkgutil import walk_packages
from typing import ClassVar, Final, NoReturn

import click

from rl_tui import __version__
from rl_tui.agents.compiling.base_folder import refusals
from rl_tui.commands import by_name as commands
from rl_tui.commands.line.descriptors import keep_stdout
from rl_tui.commands.line.output import complain
from rl_tui.commands.line.program import Program
from rl_tui.commands.line.screen import enter_kiosk, kiosk_option
from rl_tui.commands.options.display import DISPLAY_OPTIONS, display_of, display_options, is_given
from rl_tui.commands.options.run import allow_module_option
from rl_tui.common.findings import one_line
from rl_tui.common.interrupts import INTERRUPTED, leave_when_interrupted, note_interrupts
from rl_tui.common.packages import why_interpreted

_THREADS: Final = "NUMBA_NUM_THREADS"
_COLOURS: Final = "TEXTUAL_COLOR_SYSTEM"
_COLOUR_SYSTEMS: Final = ("auto", "standard", "256", "truecolor", "windows")
_LONGEST_NUMBER: Final = 40
INTERPRETED: Final = ("train", "solve", "sweep", "screenshot", "evaluate", "figure", "replay")
"""Commands that report a missing Numba first. The app reports it on its screen."""


class RlTui(Program):
    """The commands of rl-tui, one for each module below ``by_name``."""

    modules: ClassVar = {
        each.name.rpartition(".")[2]: each.name
        for each in walk_packages(commands.__path__, f"{commands.__name__}.")
        if not each.ispkg
    }
    first_in_help = (
        *("play", "learn", "edit", "train", "sweep", "watch", "replay", "solve", "evaluate"),
        *("list", "new", "check", "bench", "screenshot", "record", "serve"),
    )


@click.group(cls=RlTui, invoke_without_command=True, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, "-V", "--version", prog_name="rl-tui")
@kiosk_option
@allow_module_option
@display_options
@click.pass_context
def program(context: click.Context, /, **display: object) -> None:
    """Watch a tabular reinforcement-learning agent learn, in the terminal.

    Without a command it opens the start screen.
    """
    enter_kiosk(context.invoked_subcommand)
    leave_out_bad_threads()
    leave_out_bad_colours()
    for refusal in refusals():
        complain(refusal)
    if context.invoked_subcommand in INTERPRETED and (why := why_interpreted()):
        complain(why)
    if context.invoked_subcommand is None:
        from rl_tui.commands.line.screen import run_app

        run_app(display_of(display))
        return
    given = {name: display[name] for name in DISPLAY_OPTIONS if is_given(context, name)}
    if given:
        _hand_on(context, context.invoked_subcommand, given)


def _hand_on(context: click.Context, name: str, given: dict[str, object]) -> None:
    # Display options before the command become its defaults
    command = program.get_command(context, name)
    taken = set() if command is None else {parameter.name for parameter in command.params}
    for option in given:
        if option not in taken:
            raise click.UsageError(f"{name} draws no screen: leave out --{option.replace('_', '-')}", context)
    if given.pop("no_color", False):
        given["colors"] = "none"  # so that --colors after the command overrides it
    context.default_map = {name: given}


def main() -> None:
    """Run rl-tui and exit."""
    keep_stdout()
    calculate_in_one_thread()
    try:
        try:
            note_interrupts()
            program(prog_name="rl-tui")
        finally:
            leave_when_interrupted()
    except SystemExit as end:
        # Python would kill itself by SIGINT if ctrl+C interrupted executed source text
        if isinstance(end.code, int) and (threading.active_count() > 1 or end.code == INTERRUPTED):
            leave_at_once(end.code)
        raise
    except KeyboardInterrupt:  # outside the time in which click handles ctrl+C
        leave_at_once(INTERRUPTED)


def calculate_in_one_thread() -> None:
    """Run NumPy's linear algebra in one thread, unless the environment says otherwise.

    The matrices here are small. Threads would cost start-up time and memory.
    """
    if "numpy" not in sys.modules and "OMP_NUM_THREADS" not in os.environ:
        os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")


def leave_out_bad_threads() -> None:
    """Report an invalid ``NUMBA_NUM_THREADS`` and continue without it.

    Numba would fail to start, or print a traceback.
    """
    number = os.environ.get(_THREADS, "1")
    with suppress(ValueError):  # also for thousands of digits
        if int(number) > 0:
            return
    complain(f"{_THREADS}={one_line(number, _LONGEST_NUMBER)} is ignored: expected a whole number, 1 or more")
    del os.environ[_THREADS]


def leave_out_bad_colours() -> None:
    """Report an invalid ``TEXTUAL_COLOR_SYSTEM`` and continue without it.

    Textual would fail when an app is created.
    """
    wanted = os.environ.get(_COLOURS, "auto")
    if wanted not in _COLOUR_SYSTEMS:
        complain(
            f"{_COLOURS}={one_line(wanted, _LONGEST_NUMBER)} is ignored: expected "
            f"{', '.join(_COLOUR_SYSTEMS[:-1])} or {_COLOUR_SYSTEMS[-1]}"
        )
        del os.environ[_COLOURS]


def leave_at_once(status: int) -> NoReturn:
    """Exit without the interpreter's shutdown.

    The shutdown stops daemon threads anywhere. A thread that was importing or compiling would keep locks that
    the shutdown needs: one quit in 250 during start-up never ended. It also waits for normal threads, and a
    thread inside an environment may never end.
    """
    # a thread inside an environment may have replaced stdout
    for stream in (sys.stdout, sys.__stdout__, sys.stderr):
        with suppress(OSError, ValueError):
            if stream is not None:
                stream.flush()
    os._exit(status)
