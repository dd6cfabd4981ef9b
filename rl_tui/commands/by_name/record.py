"""``rl-tui record``: record a screen while a script presses keys."""

from __future__ import annotations

from typing import Any

import click

from rl_tui.commands.line.output import write_text
from rl_tui.commands.options.display import display_of
from rl_tui.commands.options.picture import chosen_start, picture_options
from rl_tui.commands.options.run import SectionedCommand


@click.command("record", cls=SectionedCommand)
@click.option("--out", required=True, metavar="F.cast", help="the file to write; - for stdout")
@picture_options
def command(out: str, size: tuple[int, int], keys: str, **values: Any) -> None:
    """Record a screen for asciinema.

    Keys and options are those of screenshot. The result of each key is shown for a moment. A time after the
    key, such as 3s, shows the result for three seconds, in which the run continues. No clock is read, so the
    same command always writes the same recording. An example:

    rl-tui record frozenlake --keys "s,s,space,10s,space,v,3s" --out lake.cast
    """
    with chosen_start(values) as start:
        import asyncio

        from rl_tui.screen.app.screenshot import record, script_of

        script = script_of(keys.split(",") if keys else [])
        write_text(asyncio.run(record(start, size, script, display_of(values))), out)
