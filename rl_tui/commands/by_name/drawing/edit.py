"""``rl-tui edit``: draw a world on screen."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from rl_tui.commands.options.display import display_of, display_options
from rl_tui.commands.options.run import (
    SCENARIO,
    SectionedCommand,
    allow_module_option,
    run_options,
    seed_option,
)
from rl_tui.common.findings import shown


@click.command("edit", cls=SectionedCommand)
@click.argument("scenario", metavar="[SCENARIO|FILE.toml]", required=False, type=SCENARIO)
@allow_module_option
@run_options
@seed_option
@display_options
def command(scenario: str | None, overrides: dict[str, object], seed: int, **display: Any) -> None:
    """Draw a world while an agent learns in it.

    The keys w s save the world as a scenario file. Without a name you start with a blank map. You can draw
    maps, graphs, bandits, lakes and the cliff.
    """
    from rl_tui.commands.line.screen import require_terminal, run_app
    from rl_tui.common.errors import UserError
    from rl_tui.runs.export.scenario_file import new_world
    from rl_tui.runs.library import find, recipe_for
    from rl_tui.screen.app.opening import DrawingStart
    from rl_tui.worlds.editing.drafts import refusal
    from rl_tui.worlds.editing.templates import BLANK
    from rl_tui.worlds.files.shipped import SUFFIX

    if scenario is not None and scenario.endswith(SUFFIX) and not Path(scenario).exists():
        raise UserError(f"{shown(scenario)}: no such file; rl-tui new creates one")
    found = new_world(BLANK[0]) if scenario is None else find(scenario)
    if reason := refusal(found, seed):
        raise UserError(f"{found.id}: {reason}")
    require_terminal()
    run_app(display_of(display), DrawingStart(recipe_for(found, overrides, seed)))
