"""Options for the start of a run, from the table of hyperparameters."""

from __future__ import annotations

import functools
import math
import os
import sys
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, TextIO

import click

from rl_tui.agents.catalogue import BY_ID, POLICY_BY_ID
from rl_tui.agents.hyperparameters import PARAMETERS, Parameter, Range
from rl_tui.common.errors import UserError
from rl_tui.common.findings import shown
from rl_tui.common.kiosk import in_kiosk

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem

    from rl_tui.live.sessions.session import StoredSession
    from rl_tui.runs.recipe import JournalEntry, Recipe


# Numbers as option values


class OptionValue(click.ParamType):  # type: ignore[type-arg]  # generic in newer versions only
    """Base of all option types."""


class ParameterValue(OptionValue):
    """A value of a hyperparameter: a number in its range, or one of its words."""

    def __init__(self, parameter: Parameter) -> None:
        self.parameter = parameter
        numbers = ["number"] if parameter.range else []
        self.name = "|".join([*numbers, *parameter.words])

    def get_metavar(self, param: click.Parameter, ctx: click.Context | None = None) -> str:
        """Return the placeholder for the help text."""
        return self.name.replace("number", "NUMBER")

    def convert(self, value: object, param: click.Parameter | None, ctx: click.Context | None) -> float | str:
        """Parse a number or word, or fail with the expected values."""
        number = number_in(value)
        if isinstance(value, str) and value in self.parameter.words:
            return value
        if number is None or not self.parameter.accepts(number):
            self.fail(f"expected {self.parameter.expected}, not {value}", param, ctx)
        return number


class Whole(OptionValue):
    """A whole number from `low` to `high`."""

    name = "N"

    def __init__(self, low: int, high: float = math.inf) -> None:
        self.range = Range(low, high)

    def convert(self, value: object, param: click.Parameter | None, ctx: click.Context | None) -> int:
        """Parse a number, or fail with the range."""
        try:
            number: int | None = int(str(value))
        except ValueError:
            number = None
        if number is None or number not in self.range:
            self.fail(f"expected a whole number in {self.range}, not {value}", param, ctx)
        return number


class Real(OptionValue):
    """A finite number from `low` to `high`."""

    name = "NUMBER"

    def __init__(self, low: float = -math.inf, high: float = math.inf) -> None:
        self.range = Range(low, high)

    def convert(self, value: object, param: click.Parameter | None, ctx: click.Context | None) -> float:
        """Parse a number, or fail with the range."""
        number = number_in(value)
        if number is None or not math.isfinite(number) or number not in self.range:
            self.fail(f"expected a number in {self.range}, not {value}", param, ctx)
        return number


class ChangeValue(OptionValue):
    """A change during training: STEP:NAME=VALUE."""

    name = "STEP:NAME=VALUE"

    def convert(
        self, value: object, param: click.Parameter | None, ctx: click.Context | None
    ) -> JournalEntry:
        """Parse a change, or fail with the expected form."""
        from rl_tui.runs.changes import read_change
        from rl_tui.runs.recipe import JournalEntry

        if isinstance(value, JournalEntry):
            return value
        try:
            return read_change(str(value))
        except ValueError as fault:
            self.fail(str(fault), param, ctx)


def number_in(value: object) -> float | None:
    """Return the number in an option value, or None."""
    try:
        return float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        return None


# The file of a picture


SUFFIXES: Final = (".svg", ".png")


class PictureFile(OptionValue):
    """A picture file. Its suffix selects the format."""

    name = "F.svg|F.png"

    def get_metavar(self, param: click.Parameter, ctx: click.Context | None = None) -> str:
        """Return the placeholder, with the suffixes in lower case."""
        return self.name

    def convert(self, value: object, param: click.Parameter | None, ctx: click.Context | None) -> Path:
        """Parse a path, or fail with the allowed suffixes."""
        path = Path(str(value))
        if path.suffix.lower() not in SUFFIXES:
            self.fail(f"{value} does not end in {' or '.join(SUFFIXES)}", param, ctx)
        return path


out_option: Final = click.option(
    "--out", type=PictureFile(), help='picture file to write; PNG needs pip install "rl-tui[plot]"'
)


# Options of a run


Command = Callable[..., Any]


class NameOrFile(OptionValue):
    """A name or the path of a file, as text. The shell completes both."""

    name = "text"

    def __init__(self, names: Callable[[], Iterable[str]] = tuple) -> None:
        self.names = names

    def shell_complete(
        self, ctx: click.Context, param: click.Parameter, incomplete: str
    ) -> list[CompletionItem]:
        """Complete names, or let the shell look for files."""
        from click.shell_completion import CompletionItem

        found = [CompletionItem(name) for name in self.names() if name.startswith(incomplete)]
        return found or [CompletionItem(incomplete, type="file")]


def _scenarios() -> Iterable[str]:
    from rl_tui.worlds.files.catalogue import scenarios

    return (each.id for each in scenarios())


def _lessons() -> Iterable[str]:
    from rl_tui.lessons.catalogue import shipped_lessons

    return (each.id for each in shipped_lessons())


FILE: Final = NameOrFile()
SCENARIO: Final = NameOrFile(_scenarios)
LESSON: Final = NameOrFile(_lessons)

scenario_argument: Final = click.argument("scenario", metavar="SCENARIO|FILE.toml|gym:ENV_ID", type=SCENARIO)
seed_option: Final = click.option(
    "--seed", type=Whole(0), default=0, show_default=True, help="seed of all randomness"
)


def _allow_modules(_: click.Context, __: click.Parameter, names: tuple[str, ...]) -> None:
    if names:
        from rl_tui.worlds.gym.modules import allow_module

        for name in names:
            allow_module(name)


allow_module_option: Final = click.option(
    "--allow-module",
    metavar="MODULE",
    multiple=True,
    is_eager=True,
    expose_value=False,
    callback=_allow_modules,
    help="allow environments named MODULE:ID, which import MODULE and run its code",
)
json_option: Final = click.option("--json", "as_json", is_flag=True, help="print one JSON document")
CsvTarget = Path | TextIO | None


def _csv_target(_: click.Context, __: click.Parameter, name: str | None) -> CsvTarget:
    if name == "-":
        if sys.stdout is None:
            raise UserError("stdout: cannot be written (it is closed)")
        return sys.stdout
    return None if name is None else Path(name)


def target_option(option: str, text: str) -> Callable[[Command], Command]:
    """Return an option for an output file, where ``-`` means stdout. `text` is its help."""
    return click.option(
        option,
        type=click.Path(dir_okay=False, allow_dash=True),
        callback=_csv_target,
        help=f"write {text} (-: to stdout, and the report to stderr)",
    )


csv_option: Final = target_option("--csv", "one row per episode: run, episode, return (undiscounted), length")
curve_option: Final = target_option(
    "--curve", "the mean curve of all runs in at most 200 rows, each a mean of several episodes"
)


def is_stdout(target: CsvTarget) -> bool:
    """Return True if `target` is stdout, which then allows no other output."""
    return target is not None and target is sys.stdout


def check_targets(targets: Mapping[str, CsvTarget], as_json: bool) -> None:
    """Raise UsageError if two outputs would share a file or stdout."""
    wanted: dict[object, str] = {sys.stdout: "--json"} if as_json else {}
    for option, target in targets.items():
        if target is None:
            continue
        place = os.path.realpath(target) if isinstance(target, Path) else target
        if place in wanted:
            where = "stdout" if is_stdout(target) else "the same file"
            first, second = sorted((option, wanted[place]))
            raise click.UsageError(
                f"{first} and {second} both write to {where}: choose another file for one of them",
                click.get_current_context(),
            )
        wanted[place] = option


def run_options(command: Command) -> Command:
    """Add ``--algorithm`` and all hyperparameters to `command`.

    The given ones arrive as the mapping ``overrides``.
    """
    names = ("algorithm", *PARAMETERS)

    @functools.wraps(command)
    def gathered(**values: Any) -> Any:
        given = {name: values.pop(name) for name in names}
        overrides = {name: value for name, value in given.items() if value is not None}
        return command(overrides=overrides, **values)

    decorated: Command = gathered
    for name in reversed(list(PARAMETERS)):
        decorated = parameter_option(name)(decorated)
    return algorithm_option("algorithm")(decorated)


def algorithm_option(argument: str, more: str = "") -> Callable[[Command], Command]:
    """Return the option ``--algorithm``, whose value `argument` receives."""
    return click.option(
        "--algorithm",
        argument,
        type=click.Choice(list(BY_ID)),
        metavar="NAME",
        help=f"one of {', '.join(BY_ID)}{more}",
    )


def parameter_option(name: str, more: str = "") -> Callable[[Command], Command]:
    """Return the option of a hyperparameter. `more` adds to its help."""
    parameter = PARAMETERS[name]
    return click.option(
        f"--{name.replace('_', '-')}",
        name,
        type=ParameterValue(parameter),
        help=f"{_help(parameter)}{more}",
    )


def start_of(name: str, overrides: dict[str, object], seed: int) -> Recipe | StoredSession:
    """Return the recipe of a scenario (id, file or ``gym:ENV_ID``), or a session (.json).

    Raises:
        UserError: There is no such scenario or session.
        click.UsageError: A session was given together with options of a run.
    """
    from rl_tui.live.sessions.place import session_folder
    from rl_tui.live.sessions.session import SUFFIX, files_in, read_session
    from rl_tui.runs.library import recipe_named

    if not name.endswith(SUFFIX):
        try:
            return recipe_named(name, overrides, seed)
        except UserError:
            if in_kiosk() or name in _scenarios():
                raise
            path = next((path for path in files_in(session_folder()) if path.stem == name), None)
            if path is None:
                raise
            raise UserError(f"there is no scenario {shown(name)}; to open the session, give {path}") from None
    if overrides or seed:
        context = click.get_current_context()
        raise click.UsageError("a session has its own settings: leave out the options of a run", context)
    session = read_session(Path(name))
    session.record()  # reports errors before the screen opens
    return session


def warn_of_no_effect(recipe: Recipe, overrides: Mapping[str, object]) -> None:
    """Warn about `overrides` that algorithm and policy ignore."""
    from rl_tui.runs.library import without_effect

    policy = "" if BY_ID[recipe.algorithm].planner else f" with policy {recipe.hyperparameters.policy}"
    for name in without_effect(recipe, overrides):
        option = f"--{name.replace('_', '-')}"
        click.echo(f"{option} has no effect: {recipe.algorithm}{policy} does not use it", err=True)


def _help(parameter: Parameter) -> str:
    # Words appear in the placeholder instead
    is_a_sign = len(parameter.symbol.strip("₀")) == 1 and parameter.symbol != parameter.name
    named = f"{parameter.symbol}, {parameter.help}" if is_a_sign else parameter.help
    return named if parameter.range is None else f"{named}; {parameter.expected}"


# The help of commands that take them: a section for each purpose


OPTIONS: Final = "Options"
LEARNING: Final = "How the agent learns"
CHOOSING: Final = "How it chooses actions"
SOME: Final = "For some algorithms only"
SCHEDULES: Final = "How α and ε change from episode to episode"
TITLES: Final = (OPTIONS, LEARNING, CHOOSING, SOME, SCHEDULES)


class SectionedCommand(click.Command):
    """A command whose help groups the options of a run by purpose."""

    def format_options(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the command's own options first, then the groups."""
        sections: dict[str, list[tuple[str, str]]] = {title: [] for title in TITLES}
        for parameter in self.get_params(ctx):
            record = parameter.get_help_record(ctx)
            if record is not None and isinstance(parameter, click.Option):
                sections[section_of(parameter.name or "")].append(record)
        for title, records in sections.items():
            if records:
                with formatter.section(title):
                    formatter.write_dl(records)


def section_of(option: str) -> str:
    """Return the help section of an option, given by its Python name."""
    if option == "algorithm":
        return LEARNING
    if option not in PARAMETERS:
        return OPTIONS
    if PARAMETERS[option].schedule:
        return SCHEDULES
    if option == "policy" or any(option in policy.parameters for policy in POLICY_BY_ID.values()):
        return CHOOSING
    learners = [algorithm for algorithm in BY_ID.values() if not algorithm.planner]
    return LEARNING if all(option in each.parameters for each in learners) else SOME
