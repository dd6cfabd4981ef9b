"""``rl-tui serve``: the app in a browser."""

from __future__ import annotations

import asyncio
import subprocess
import sys
from contextlib import suppress
from difflib import get_close_matches
from importlib.resources import files
from importlib.util import find_spec
from pathlib import Path
from subprocess import DEVNULL
from typing import TYPE_CHECKING, Any, Final
from urllib.parse import urlsplit

import click

from rl_tui.commands.line.program import FAILED
from rl_tui.commands.options.display import DISPLAY_OPTIONS, display_of, display_options, is_given
from rl_tui.commands.options.run import SCENARIO, Whole, start_of
from rl_tui.common.errors import UserError
from rl_tui.common.kiosk import VARIABLE, in_kiosk

if TYPE_CHECKING:
    import socket

_LONGEST_WARMING: Final = 600.0  # seconds
_USUAL: Final = "frozenlake-slippery"  # uses the same kernels as most scenarios
_MISSING: Final = 'rl-tui serve needs two more packages: pip install "rl-tui[serve]"'


@click.command("serve")
@click.argument("scenario", metavar="[SCENARIO]", required=False, type=SCENARIO)
@click.option("--host", default="127.0.0.1", show_default=True, help="address to listen on")
@click.option(
    "--port",
    type=Whole(0, 65535),
    default=8000,
    show_default=True,
    help="port to listen on; 0: any free port",
)
@click.option("--url", help="public address of a proxy in front, such as https://lab.example.org")
@click.option(
    "--most",
    type=Whole(1, 1000),
    default=8,
    show_default=True,
    help="largest number of people at once, each with a process",
)
@click.option(
    "--no-kiosk", is_flag=True, help="let the browser read and write your files, as rl-tui play does"
)
@click.option("--yes", is_flag=True, help="do not ask before other machines get access")
@display_options
@click.pass_context
def command(
    context: click.Context,
    /,
    scenario: str | None,
    host: str,
    port: int,
    url: str | None,
    most: int,
    no_kiosk: bool,
    yes: bool,
    **display: Any,
) -> None:
    """Serve rl-tui to browsers: every tab is its own run.

    Without a scenario it opens the start screen. It runs in kiosk mode, without access to files. Only this
    machine can reach it, unless you give another address.
    """
    if find_spec("textual_serve") is None or find_spec("aiohttp") is None:
        raise UserError(_MISSING)
    kiosk = not no_kiosk
    if no_kiosk and in_kiosk():
        raise click.UsageError(f"{VARIABLE} is set, so --no-kiosk is not allowed: unset it first")
    if url is not None and not _is_url(url):
        raise click.UsageError(f"--url {url} is not an address; expected one such as https://lab.example.org")
    _check_start(scenario, display, kiosk=kiosk)
    _confirm(context, host, port, url, most=most, kiosk=kiosk, yes=yes)

    from rl_tui.commands.serving.addresses import bind, listen

    with bind(host, port) as bound:  # first, so that a port in use is reported immediately
        if kiosk and not in_kiosk():
            prepare(scenario or _USUAL)
        listen(bound, host)
        serve_apps(bound, app_command(context, scenario, display), host, url, kiosk=kiosk, most=most)


def prepare(scenario: str) -> None:
    """Compile the kernels that play `scenario`, in another process.

    A kiosk stores no compiled code, so every tab would compile again.
    """
    from rl_tui.commands.serving.app_process import command_line

    click.echo("preparing machine code (up to half a minute the first time)", err=True)
    warming = command_line(sys.executable, ["warm", scenario])
    with suppress(OSError, subprocess.TimeoutExpired):  # errors appear in the tabs
        subprocess.run(
            warming, timeout=_LONGEST_WARMING, stdin=DEVNULL, stdout=DEVNULL, stderr=DEVNULL, check=False
        )


def serve_apps(
    listening: socket.socket, command: tuple[str, ...], host: str, url: str | None, *, kiosk: bool, most: int
) -> None:
    """Serve at most `most` apps, each started by `command`, until interrupted.

    `url` is what people type if a proxy is in front of `host`.
    """
    from rl_tui.commands.serving.addresses import Doorkeeper, url_of
    from rl_tui.commands.serving.site import Site, serve

    terminal = Path(str(files("textual_serve"))) / "static"
    site = Site(command, Doorkeeper(host, url), terminal, kiosk=kiosk, most=most)

    def started() -> None:
        people = "one person" if most == 1 else f"{most} people"
        files = "the browser cannot open files" if kiosk else "the browser can read and write your files"
        click.echo(f"rl-tui is at {url_of(listening)} for up to {people} at a time; {files}; ctrl+c stops it")

    asyncio.run(serve(site, listening, started))


def _check_start(scenario: str | None, display: dict[str, Any], *, kiosk: bool) -> None:
    # Raises the error with which every app would end immediately
    if scenario is not None:
        if kiosk:
            _check_shipped(scenario)
        start_of(scenario, {}, 0)
    from rl_tui.screen.app.app import RlTuiApp

    RlTuiApp(display_of(display))


def _check_shipped(scenario: str) -> None:
    from rl_tui.common.findings import shown
    from rl_tui.worlds.files.shipped import shipped_folder

    shipped = [path.stem for path in shipped_folder().glob("*.toml")]
    if scenario not in shipped:
        near = get_close_matches(scenario.lower(), shipped, n=3, cutoff=0.5)
        hint = f"did you mean {' or '.join(near)}?" if near else "--no-kiosk allows your own files"
        raise UserError(f"{shown(scenario)} is not a scenario of rl-tui, and a kiosk has no others: {hint}")


def _confirm(
    context: click.Context, host: str, port: int, url: str | None, *, most: int, kiosk: bool, yes: bool
) -> None:
    # Raises UsageError if they would get access to files, or there is no terminal
    from rl_tui.commands.serving.addresses import is_this_machine

    if is_this_machine(host):
        if kiosk or url is None:
            return
        warning = (
            f"everyone who reaches {url} can read and write your files.\n"
            "The proxy in front must ask for a password."
        )
    elif not kiosk:
        raise click.UsageError(
            f"--no-kiosk gives every visitor access to your files: not on {host}, only on 127.0.0.1"
        )
    else:
        where = "every address of this machine" if host in ("0.0.0.0", "::") else host
        warning = (
            f"{where} can be reached from other machines.\n"
            "There is no password and no encryption: everyone who reaches"
            f" {'the port' if port == 0 else f'port {port}'} can use rl-tui, {most} at once.\n"
            "Safer: leave it on 127.0.0.1 and put a web server with TLS and a password in front (--url),\n"
            "or come through ssh -L."
        )
    click.echo(f"Warning: {warning}", err=True)
    if yes:
        return
    if not is_interactive():
        raise click.UsageError("cannot ask for confirmation here: add --yes")
    if not click.confirm("Serve it there?", err=True):
        context.exit(FAILED)


def is_interactive() -> bool:
    """Return True if a person can answer on this terminal."""
    return sys.stdin.isatty() and sys.stderr.isatty()


def app_command(context: click.Context, scenario: str | None, display: dict[str, Any]) -> tuple[str, ...]:
    """Return the command line of an app, with the display options of ``serve``."""
    from rl_tui.commands.serving.app_process import command_line

    arguments = [] if scenario is None else ["play", scenario]
    for name in DISPLAY_OPTIONS:
        if is_given(context, name):
            value = display[name]
            option = f"--{name.replace('_', '-')}"
            arguments.append(option if value is True else f"{option}={value}")
    return command_line(sys.executable, arguments)


def _is_url(text: str) -> bool:
    try:
        parts = urlsplit(text)
        return parts.scheme in ("http", "https") and bool(parts.hostname) and parts.port != 0
    except ValueError:
        return False
