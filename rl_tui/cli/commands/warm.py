"""``rl-tui warm``: every kernel compiled into the cache, for images and classrooms."""

from __future__ import annotations

import click

from rl_tui.cli.progress import progress


@click.command("warm")
def command() -> None:
    """Compile all kernels into the cache.

    Then no run begins without its machine code: for images of containers, and classrooms whose machines share
    a cache. It takes some minutes. The cache is the folder RL_TUI_CACHE_DIR, else that of your platform.
    """
    from rl_tui.agents.compiling.warming import warm
    from rl_tui.agents.kernels.cache_folder import cache_folder
    from rl_tui.common.findings import printable
    from rl_tui.lab.experiments.patience import cores

    with progress("compiling") as on_progress:
        warmed = warm(cores(), on_progress)
    click.echo(f"{warmed.compiled} kernels compiled, {warmed.found} were there already")
    click.echo(printable(str(cache_folder())))
