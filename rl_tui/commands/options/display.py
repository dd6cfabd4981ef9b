"""Options for the look of the screen."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final, get_args

import click

from rl_tui.agents.hyperparameters import Parameter, Range
from rl_tui.commands.options.run import Command, OptionValue, ParameterValue
from rl_tui.screen.app.display import Colours, Display

_DEFAULT: Final = Display()
_FPS: Final = Parameter(
    "fps", "fps", "maximum frames per second; fewer for slow connections", Range(0, 60, open_low=True)
)
_OPTIONS: Final = (
    click.option(
        "--theme", default=_DEFAULT.theme, show_default=True, help="dark, light or one of Textual's themes"
    ),
    click.option(
        "--colors",
        type=click.Choice(get_args(Colours)),
        default=_DEFAULT.colors,
        show_default=True,
        help="number of colours of the terminal",
    ),
    click.option("--no-color", is_flag=True, help="the same as --colors none"),
    click.option("--ascii", is_flag=True, help="draw with ASCII characters only"),
    click.option("--fps", type=ParameterValue(_FPS), default=_DEFAULT.fps, show_default=True, help=_FPS.help),
    click.option("--no-mouse", is_flag=True, help="do not use the mouse"),
    click.option("--reduced-motion", is_flag=True, help="show steps without animation"),
)
DISPLAY_OPTIONS: Final = ("theme", "colors", "no_color", "ascii", "fps", "no_mouse", "reduced_motion")


class PanelNames(OptionValue):
    """``few``, ``all``, or panel ids separated by commas."""

    name = "few|all|NAME,…"

    def convert(
        self, value: object, param: click.Parameter | None, ctx: click.Context | None
    ) -> str | frozenset[str]:
        """Parse a word or ids, or fail with the known ids."""
        from rl_tui.worlds.files.scenario import unknown_panels

        if value in ("few", "all"):
            return str(value)
        names = [name.strip() for name in str(value).split(",")]
        for finding in unknown_panels((), names):
            self.fail(f'{finding.found} is not "few", "all" or {finding.expected}', param, ctx)
        return frozenset(names)


panels_option: Final = click.option(
    "--panels",
    type=PanelNames(),
    metavar="few|all|NAME,…",
    help="panels at the start (few: others appear when they are useful)  [default: the scenario's]",
)
big_option: Final = click.option("--big", is_flag=True, help="start with the world in full screen (f)")


def display_options(command: Command) -> Command:
    """Add the options in ``DISPLAY_OPTIONS`` to `command`."""
    for option in reversed(_OPTIONS):
        command = option(command)
    return command


def is_given(context: click.Context, name: str) -> bool:
    """Return True if an option was given, before or after the command."""
    source = context.get_parameter_source(name)
    return source in (click.core.ParameterSource.COMMANDLINE, click.core.ParameterSource.DEFAULT_MAP)


def display_of(values: Mapping[str, Any]) -> Display:
    """Return the display settings for option values by name.

    ``big`` and ``panels`` may be missing.
    """
    return Display(
        theme=values["theme"],
        colors="none" if values["no_color"] else values["colors"],
        ascii=values["ascii"],
        fps=values["fps"],
        mouse=not values["no_mouse"],
        reduced_motion=values["reduced_motion"],
        is_big=values.get("big", False),
        panels=values.get("panels"),
    )
