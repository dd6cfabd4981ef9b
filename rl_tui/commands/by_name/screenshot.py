"""``rl-tui screenshot``: draw a screen as SVG after some keys."""

from __future__ import annotations

from typing import Any

import click

from rl_tui.commands.line.output import write_text
from rl_tui.commands.options.display import display_of
from rl_tui.commands.options.picture import chosen_start, picture_options
from rl_tui.commands.options.run import SectionedCommand


@click.command("screenshot", cls=SectionedCommand)
@click.option("--out", required=True, metavar="F.svg", help="the file to write; - for stdout")
@picture_options
def command(out: str, size: tuple[int, int], keys: str, **values: Any) -> None:
    """Draw a screen as an SVG picture.

    It shows the playground of a scenario or session, or the start screen if you name none. --watch shows your
    own script, --lesson shows a lesson, and --agent lets your own agent take the steps. The same command
    always draws the same picture, so speeds are left blank. An example:

    rl-tui screenshot frozenlake --keys "wait:20000,v" --out lake.svg
    """
    with chosen_start(values) as start:
        import asyncio

        from rl_tui.screen.app.screenshot import screenshot

        pressed = keys.split(",") if keys else []
        write_text(asyncio.run(screenshot(start, size, pressed, display_of(values))), out)
