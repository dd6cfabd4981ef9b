"""``--kiosk``: which commands a kiosk has, and what it gives up for good before it takes input."""

from __future__ import annotations

import os
import sys
from contextlib import suppress
from typing import Final

import click

from rl_tui.common.errors import UserError
from rl_tui.common.kiosk import VARIABLE, in_kiosk
from rl_tui.terminal.driver_choice import IN_BROWSER

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
