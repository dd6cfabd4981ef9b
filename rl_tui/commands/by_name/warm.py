"""``rl-tui warm``: compile every kernel into the cache."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from rl_tui.commands.line.output import progress
from rl_tui.commands.options.run import SCENARIO, allow_module_option

if TYPE_CHECKING:
    from rl_tui.agents.kernels.machine_code import Loop


@click.command("warm")
@click.argument("scenarios", metavar="[SCENARIO|FILE.toml|gym:ENV_ID]...", nargs=-1, type=SCENARIO)
@allow_module_option
def command(scenarios: tuple[str, ...]) -> None:
    """Compile kernels in advance, so that runs start fast.

    Kernels are the inner loops of learning. Without a scenario, all kernels are compiled, which takes some
    minutes. This is useful for container images, and for classrooms that share a cache. The cache is the
    folder RL_TUI_CACHE_DIR, or your platform's cache folder.
    """
    from rl_tui.agents.compiling.base_folder import refusals
    from rl_tui.agents.compiling.cache_folder import cache_folder
    from rl_tui.agents.compiling.loops import all_batches, all_loops
    from rl_tui.agents.compiling.warming import warm
    from rl_tui.common.errors import UserError
    from rl_tui.common.findings import printable
    from rl_tui.runs.training.compile_or_interpret import cores

    if any(refusals()):
        raise UserError("nothing is compiled: the cache folder is ignored")
    loops = sorted({_loop_of(each) for each in scenarios}) if scenarios else [*all_loops(), *all_batches()]
    with progress("compiling") as on_progress:
        warmed = warm(loops, cores(), on_progress)
    click.echo(f"compiled: {warmed.compiled}; already compiled: {warmed.found}")
    click.echo(printable(str(cache_folder())))


def _loop_of(scenario: str) -> Loop:
    from rl_tui.runs.library import recipe_named
    from rl_tui.runs.run import Run

    return Run(recipe_named(scenario, {}, 0), evaluate=False).learner.loop
