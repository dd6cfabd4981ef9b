"""``rl-tui list``: all scenarios, with sizes and defaults."""

from __future__ import annotations

from typing import Any

import click

from rl_tui.commands.line.output import columns, complain, number, print_json
from rl_tui.commands.options.run import json_option


@click.command("list")
@json_option
def command(as_json: bool) -> None:
    """List the scenarios, with their sizes and defaults."""
    from rl_tui.common.errors import UserError
    from rl_tui.runs.library import listing
    from rl_tui.worlds.files.catalogue import read_catalogue

    catalogue = read_catalogue()
    faults: list[UserError] = [*catalogue.broken]
    rows = []
    for scenario in catalogue.scenarios:
        try:
            rows.append(listing(scenario))
        except UserError as refusal:
            faults.append(refusal)
    for fault in faults:
        complain(str(fault))
    if as_json:
        print_json(rows)
    else:
        click.echo(_table(rows))


def _table(rows: list[dict[str, Any]]) -> str:
    head = ("id", "states", "actions", "pairs", "limit", "α", "γ", "ε", "episodes")
    body = [
        (
            row["id"],
            str(row["states"]),
            str(row["actions"]),
            str(row["pairs"]),
            str(row["time_limit"] or "none"),
            *(_short(row["defaults"][name]) for name in ("alpha", "gamma", "epsilon")),
            f"{row['defaults']['episodes']:,}",
        )
        for row in rows
    ]
    return columns([head, *body], right=range(1, len(head)))


def _short(value: float | str) -> str:
    return "1/N" if value == "sample-average" else number(value, ".12g")
