"""``rl-tui screenshot``: draw a screen as SVG after some keys. Needs no terminal."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from rl_tui.commands.options.agent import agent_option, request_of
from rl_tui.commands.options.display import big_option, display_of, display_options, panels_option
from rl_tui.commands.options.run import (
    OptionValue,
    SectionedCommand,
    allow_module_option,
    run_options,
    seed_option,
    start_of,
)

if TYPE_CHECKING:
    from rl_tui.programs.own_agents.loading import AgentName
    from rl_tui.programs.watched.program_process import ProgramRequest
    from rl_tui.screen.app.display import Display
    from rl_tui.screen.app.opening import Start


class ScreenSize(OptionValue):
    """A screen size in columns and rows, such as ``120x40``."""

    name = "COLUMNSxROWS"

    def convert(
        self, value: object, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[int, int]:
        """Return (columns, rows), or fail with the allowed range."""
        match = re.fullmatch(r"([0-9]{1,4})x([0-9]{1,4})", str(value))
        columns, rows = (int(match[1]), int(match[2])) if match else (0, 0)
        if not (20 <= columns <= 500 and 5 <= rows <= 200):
            self.fail(f"expected a size from 20x5 to 500x200, such as 120x40, not {value}", param, ctx)
        return columns, rows


@click.command("screenshot", cls=SectionedCommand)
@click.argument("scenario", metavar="[SCENARIO|FILE.toml|gym:ENV_ID|SESSION.json]", required=False)
@click.option("--out", required=True, metavar="F.svg", help="the file to write; - for stdout")
@click.option("--size", type=ScreenSize(), default="120x40", show_default=True, help="columns x rows")
@click.option(
    "--keys",
    default="",
    help="keys to press first, separated by commas; wait:N waits for N steps of training",
)
@click.option("--watch", metavar="SCRIPT.py", help="watch your own script instead of a scenario")
@click.option(
    "--lesson", metavar="ID|FILE.toml", help="show the first page of a lesson instead of a scenario"
)
@agent_option
@allow_module_option
@run_options
@seed_option
@panels_option
@big_option
@display_options
def command(
    scenario: str | None,
    watch: str | None,
    lesson: str | None,
    agent: AgentName | None,
    out: str,
    size: tuple[int, int],
    keys: str,
    overrides: dict[str, object],
    seed: int,
    **display: Any,
) -> None:
    """Draw a screen as an SVG picture.

    It shows the playground of a scenario or of a session; without one, the start screen. --watch shows your
    own script, --lesson a lesson, and --agent lets your own agent take the steps. The same command always
    draws the same picture, so speeds are left blank. An example:

    rl-tui screenshot frozenlake --keys "wait:20000,v" --out lake.svg
    """
    context = click.get_current_context()
    if watch is not None and (scenario is not None or overrides or agent is not None):
        raise click.UsageError("a script has its own settings: leave out the options of a run", context)
    if lesson is not None and (scenario is not None or overrides or seed or agent is not None or watch):
        raise click.UsageError("a lesson has its own runs: leave out the options of a run", context)
    if (lesson is not None and (display["big"] or display["panels"])) or (watch and display["panels"]):
        raise click.UsageError(
            "lessons and scripts have their own panels: leave out --panels and --big", context
        )
    if watch is None and scenario is None and (overrides or seed or agent is not None):
        raise click.UsageError("options of a run need a scenario: name one", context)
    start = start_of(scenario, overrides, seed) if scenario is not None else None
    wanted = keys.split(",") if keys else []
    if lesson is not None:
        from rl_tui.lessons.catalogue import find_lesson
        from rl_tui.lessons.file.setups import check_setups
        from rl_tui.live.sessions.progress import start_of as lesson_start_of

        found = find_lesson(lesson)
        check_setups(found)
        svg = _picture(lesson_start_of(found, None), size, wanted, display_of(display))
    elif watch is not None:
        from rl_tui.programs.watched.program_process import ProgramRequest

        svg = _picture_of_program(ProgramRequest(Path(watch), seed=seed), size, wanted, display_of(display))
    elif agent is not None and start is not None:
        svg = _picture_of_program(request_of(agent, start, overrides), size, wanted, display_of(display))
    else:
        svg = _picture(start, size, wanted, display_of(display))
    _write(svg, out)


def _picture_of_program(
    request: ProgramRequest, size: tuple[int, int], keys: Sequence[str], display: Display
) -> str:
    from rl_tui.commands.line.screen import started

    with started(request) as program:
        return _picture(program, size, keys, display)


def _picture(
    start: Start,
    size: tuple[int, int],
    keys: Sequence[str],
    display: Display,
) -> str:
    import asyncio

    from rl_tui.screen.app.screenshot import screenshot

    return asyncio.run(screenshot(start, size, keys, display))


def _write(svg: str, out: str) -> None:
    if out == "-":
        click.echo(svg, nl=False)
    else:
        from rl_tui.common.files import whole_file

        with whole_file(Path(out)) as stream:
            stream.write(svg)
