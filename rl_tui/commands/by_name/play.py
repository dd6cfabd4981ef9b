"""``rl-tui play``: open the playground."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from rl_tui.commands.line.screen import enter_kiosk, kiosk_option
from rl_tui.commands.options.agent import agent_option, request_of
from rl_tui.commands.options.display import big_option, display_of, display_options, panels_option
from rl_tui.commands.options.run import (
    SCENARIO,
    SectionedCommand,
    allow_module_option,
    run_options,
    seed_option,
    start_of,
)

if TYPE_CHECKING:
    from rl_tui.programs.own_agents.loading import AgentName


@click.command("play", cls=SectionedCommand)
@click.argument(
    "scenario", metavar="[SCENARIO|FILE.toml|gym:ENV_ID|SESSION.json]", required=False, type=SCENARIO
)
@kiosk_option
@allow_module_option
@run_options
@seed_option
@agent_option
@panels_option
@big_option
@display_options
def command(
    scenario: str | None,
    overrides: dict[str, object],
    seed: int,
    agent: AgentName | None,
    **display: Any,
) -> None:
    """Open a scenario in the playground, or continue a session.

    Without a name the first scenario opens. A session continues exactly where you left it, and is saved in
    its file. With --agent your own agent takes the steps. Its code runs with all your rights.
    """
    from rl_tui.commands.line.screen import require_terminal, run_app

    enter_kiosk("play")
    from rl_tui.worlds.files.catalogue import scenarios

    what = start_of(scenario if scenario is not None else scenarios()[0].id, overrides, seed)
    require_terminal()
    run_app(display_of(display), what if agent is None else request_of(agent, what, overrides))
