"""The command group: lazy command imports, and one-line errors."""

from __future__ import annotations

import errno
import os
import sys
from collections.abc import Iterator, Mapping, Sequence
from difflib import get_close_matches
from importlib import import_module
from pathlib import Path
from typing import Any, ClassVar, Final, cast

import click

from rl_tui.commands.line.descriptors import STDOUT, lead_nowhere, say_no_more
from rl_tui.commands.line.output import complain
from rl_tui.common.errors import UserError
from rl_tui.common.interrupts import INTERRUPTED, INTERRUPTS
from rl_tui.common.packages import missing_package

DONE: Final = 0
FAILED: Final = 1
USAGE: Final = 2
TRACEBACK: Final = "RL_TUI_TRACEBACK"


class Program(click.Group):
    """A command group that imports the module of a command only when needed.

    `modules` maps command names to modules with an attribute ``command``. The exit status is 0 (done), 1
    (failed), 2 (usage error) or 130 (interrupted). Errors never print a traceback.
    """

    modules: ClassVar[Mapping[str, str]]
    first_in_help: ClassVar[Sequence[str]] = ()

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return the command names in the order of the help."""
        return list(dict.fromkeys((*self.first_in_help, *self.modules)))

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Return the command called `cmd_name`, or None."""
        if cmd_name not in self.modules:
            return None
        return cast("click.Command", import_module(self.modules[cmd_name]).command)

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Find the command at the start of `args`, or suggest a near name or a key."""
        name = args[0]
        if name not in self.modules and not name.startswith("-"):
            hint = self._hint(name)
            raise click.UsageError(f"unknown command {name!r}{'; ' if hint else ''}{hint}", ctx)
        return super().resolve_command(ctx, args)

    def _command_in(self, args: Sequence[str] | None) -> str:
        name = next(iter(sys.argv[1:] if args is None else args), "")
        return f"rl-tui {name}" if name in self.modules else "rl-tui"

    def _hint(self, name: str) -> str:
        from rl_tui.commands.line.key_on_screen import key_on_screen

        near = get_close_matches(name, self.modules, n=1)
        return key_on_screen(name) or (f"did you mean {near[0]}?" if near else _way_to_play(name))

    def main(  # type: ignore[override]
        self, args: Sequence[str] | None = None, *, standalone_mode: bool = True, **extra: Any
    ) -> Any:
        """Run the program and exit with its status."""
        if not standalone_mode:
            return super().main(args, standalone_mode=False, **extra)
        for stream in (sys.stdout, sys.stderr):
            if hasattr(stream, "reconfigure"):
                stream.reconfigure(errors="replace")
        status = self._status(args, **extra)
        say_no_more()
        sys.exit(status)

    def _status(self, args: Sequence[str] | None, **extra: Any) -> int:
        try:
            status = super().main(args, standalone_mode=False, **extra)
            if sys.stdout is None:
                raise UserError("stdout: cannot be written (it is closed)")
            sys.stdout.flush()
        except click.UsageError as fault:
            where = fault.ctx.command_path if fault.ctx else self._command_in(args)
            problem = " ".join(fault.format_message().split())  # choices come one a line
            listed = "commands" if where == "rl-tui" else "options"
            if isinstance(fault, click.NoSuchOption):
                problem, listed = _unknown_option(fault, self), "options"
            return _fail(f"{where}: {problem} ({where} --help lists the {listed})", USAGE)
        except click.Abort:
            return INTERRUPTED
        except click.ClickException as fault:
            return _fail(f"rl-tui: {fault.format_message()}", fault.exit_code)
        except UserError as fault:
            return _fail(_prefixed(str(fault)))
        except OSError as fault:
            if fault.errno == errno.EPIPE:
                _give_up_stdout()
                return FAILED
            if fault.filename == STDOUT:
                _give_up_stdout()
                return _fail(f"rl-tui: stdout: cannot be written ({fault.strerror or fault})")
            place = f"{fault.filename}: " if fault.filename else ""
            return _fail(f"rl-tui: {place}{fault.strerror or fault}")
        except Exception as fault:  # a bug: still one line, and a way to see where
            if os.environ.get(TRACEBACK):
                raise
            missing = missing_package(fault)
            if missing:
                return _fail(f"rl-tui: {_with_notes(missing, fault)}")
            return _fail(f"rl-tui: {_described(fault)} ({TRACEBACK}=1 shows where)")
        return status if isinstance(status, int) else DONE


def _unknown_option(fault: click.NoSuchOption, program: click.Group) -> str:
    # Names commands with this option, or a near option
    option, context = fault.option_name, fault.ctx
    said = f"unknown option {option}"
    if context is None:
        return said
    owners = [
        name for name, command in _commands(program, context.find_root()) if option in _options(command)
    ]
    if owners:
        return f"{said} here; it belongs to {', '.join(owners)}"
    # the common dashes would make all names similar
    names = {each.lstrip("-"): each for each in _options(context.command) if each.startswith("--")}
    near = get_close_matches(option.lstrip("-"), names, n=1)
    return f"{said}; did you mean {names[near[0]]}?" if near else said


def _commands(program: click.Group, context: click.Context) -> Iterator[tuple[str, click.Command]]:
    yield context.info_name or "", program
    for name in program.list_commands(context):
        command = program.get_command(context, name)
        if command is not None:
            yield f"{context.info_name} {name}", command


def _options(command: click.Command) -> list[str]:
    return [name for option in command.params for name in (*option.opts, *option.secondary_opts)]


def _described(fault: Exception) -> str:
    reason = " ".join(str(fault).split())
    return _with_notes(f"unexpected {type(fault).__name__}: {reason}", fault)


def _with_notes(said: str, fault: Exception) -> str:
    return "; ".join((said, *getattr(fault, "__notes__", ())))


def _prefixed(message: str) -> str:
    return "\n".join(f"rl-tui: {line}" for line in message.splitlines())


def _fail(message: str, status: int = FAILED) -> int:
    if INTERRUPTS.came:  # an import that ctrl+C interrupts may fail in any way
        return INTERRUPTED
    complain(message)
    return status


def _give_up_stdout() -> None:
    # The reader stopped, like `head`, or the disk is full
    lead_nowhere(sys.stdout.fileno())


def _way_to_play(name: str) -> str:
    from rl_tui.common.errors import UserError
    from rl_tui.worlds.files.catalogue import find

    try:
        find(name)
    except UserError:
        is_session = name.endswith(".json") and Path(name).is_file()
        return f"to continue a session: rl-tui play {name}" if is_session else ""
    return f"to play a scenario: rl-tui play {name}"
