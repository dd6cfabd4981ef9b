"""``rl-tui bench``: steps per second, compared with the plain Gymnasium loop."""

from __future__ import annotations

import click

from rl_tui.commands.line.output import columns, print_json
from rl_tui.commands.options.run import (
    SCENARIO,
    SectionedCommand,
    Whole,
    allow_module_option,
    json_option,
    run_options,
    seed_option,
)


@click.command("bench", cls=SectionedCommand)
@click.argument(
    "scenario", metavar="[SCENARIO|FILE.toml|gym:ENV_ID]", default="frozenlake-slippery", type=SCENARIO
)
@click.option(
    "--rounds", type=Whole(1, 1000), default=5, show_default=True, help="number of timings per loop"
)
@allow_module_option
@run_options
@seed_option
@json_option
def command(scenario: str, rounds: int, overrides: dict[str, object], seed: int, as_json: bool) -> None:
    """Compare the speed of this program with a plain Gymnasium loop.

    They take turns in one process. The plain loop runs twice: with argmax, which takes the first of equal
    values, and with a random choice among equal values, as in this program.
    """
    from rl_tui.runs.library import recipe_named
    from rl_tui.runs.training.benchmark import benchmark

    figures = benchmark(recipe_named(scenario, overrides, seed), rounds)
    if as_json:
        print_json(figures)
        return
    first, random, many = (figures[f"ratio{which}"] for which in ("", "_random_ties", "_many_runs"))
    timed = (
        ("rl-tui", "kernel", ""),
        ("rl-tui, 64 runs", "many_runs", "on all cores"),
        ("plain loop, argmax", "gymnasium", f"{first:,.0f} times as fast, {many:,.0f} with 64 runs"),
        ("plain loop, random ties", "gymnasium_random_ties", f"{random:,.0f} times as fast"),
    )
    rows = [(name, f"{figures[f'{which}_steps_per_second']:,.0f}", we_are) for name, which, we_are in timed]
    click.echo(f"{figures['scenario']}, median of {rounds}")
    click.echo(columns([("", "steps/s", "we are"), *rows], right=(1,)))
