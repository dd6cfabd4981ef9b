"""Options of the commands that draw screens without a terminal."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import click

from rl_tui.commands.options.agent import agent_option, request_of
from rl_tui.commands.options.display import big_option, display_options, panels_option
from rl_tui.commands.options.run import (
    SCENARIO,
    Command,
    OptionValue,
    allow_module_option,
    run_options,
    seed_option,
    start_of,
)

if TYPE_CHECKING:
    from rl_tui.screen.app.opening import Start


class ScreenSize(OptionValue):
    """A screen size in columns and rows, such as ``120x40``."""

    name = "COLUMNSxROWS"

    def convert(
        self, value: object, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[int, int]:
        """Parse columns and rows, or fail with the range."""
        match = re.fullmatch(r"([0-9]{1,4})x([0-9]{1,4})", str(value))
        columns, rows = (int(match[1]), int(match[2])) if match else (0, 0)
        if not (20 <= columns <= 500 and 5 <= rows <= 200):
            self.fail(f"expected a size from 20x5 to 500x200, such as 120x40, not {value}", param, ctx)
        return columns, rows


size_option: Final = click.option(
    "--size", type=ScreenSize(), default="120x40", show_default=True, help="columns x rows"
)
_OPTIONS: Final = (
    click.argument(
        "scenario", metavar="[SCENARIO|FILE.toml|gym:ENV_ID|SESSION.json]", required=False, type=SCENARIO
    ),
    size_option,
    click.option(
        "--keys",
        default="",
        help="keys to press, separated by commas; wait:N takes N steps of training, Ns waits N seconds",
    ),
    click.option("--watch", metavar="SCRIPT.py", help="watch your own script instead of a scenario"),
    click.option(
        "--lesson", metavar="ID|FILE.toml", help="show the first page of a lesson instead of a scenario"
    ),
    *(agent_option, allow_module_option, run_options, seed_option, panels_option, big_option),
    display_options,
)


def picture_options(command: Command) -> Command:
    """Add what a picture shows: the start, the size, the keys and the look."""
    for option in reversed(_OPTIONS):
        command = option(command)
    return command


@contextmanager
def chosen_start(values: Mapping[str, Any]) -> Iterator[Start]:
    """Yield the start that the options choose. A script of the user ends with the context.

    Raises:
        UserError: There is no such scenario, session, lesson, script or agent.
        click.UsageError: Some of the options exclude each other.
    """
    context = click.get_current_context()
    scenario, watch, lesson, agent = (values[name] for name in ("scenario", "watch", "lesson", "agent"))
    overrides, seed = values["overrides"], values["seed"]
    if watch is not None and (scenario is not None or overrides or agent is not None):
        raise click.UsageError("a script has its own settings: leave out the options of a run", context)
    if lesson is not None and scenario is not None:
        raise click.UsageError(f"a lesson has its own worlds: leave out {scenario}", context)
    if lesson is not None and (overrides or seed or agent is not None or watch):
        raise click.UsageError("a lesson has its own runs: leave out the options of a run", context)
    if (lesson is not None and (values["big"] or values["panels"])) or (watch and values["panels"]):
        raise click.UsageError(
            "lessons and scripts have their own panels: leave out --panels and --big", context
        )
    if watch is None and scenario is None and (overrides or seed or agent is not None):
        raise click.UsageError("options of a run need a scenario: name one", context)
    start = start_of(scenario, overrides, seed) if scenario is not None else None
    if lesson is not None:
        from rl_tui.lessons.catalogue import find_lesson
        from rl_tui.lessons.file.setups import check_setups
        from rl_tui.live.sessions.progress import start_of as lesson_start_of

        found = find_lesson(lesson)
        check_setups(found)
        yield lesson_start_of(found, None)
    elif watch is not None or (agent is not None and start is not None):
        from rl_tui.commands.line.screen import started
        from rl_tui.programs.watched.program_process import ProgramRequest

        request = (
            ProgramRequest(Path(watch), seed=seed) if start is None else request_of(agent, start, overrides)
        )
        with started(request) as program:
            yield program
    else:
        yield start
