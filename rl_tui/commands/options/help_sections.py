"""The help of commands that take many options: a section for each purpose."""

from __future__ import annotations

from typing import Final

import click

from rl_tui.agents.catalogue import BY_ID, POLICY_BY_ID
from rl_tui.agents.hyperparameters import PARAMETERS

OPTIONS: Final = "Options"
LEARNING: Final = "How the agent learns"
CHOOSING: Final = "How it chooses actions"
SOME: Final = "For some algorithms only"
SCHEDULES: Final = "How α and ε change from episode to episode"
TITLES: Final = (OPTIONS, LEARNING, CHOOSING, SOME, SCHEDULES)


class SectionedCommand(click.Command):
    """A command whose help lists the options of a run apart, in sections by what they are for."""

    def format_options(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the command's own options first, then the sections."""
        sections: dict[str, list[tuple[str, str]]] = {title: [] for title in TITLES}
        for parameter in self.get_params(ctx):
            record = parameter.get_help_record(ctx)
            if record is not None and isinstance(parameter, click.Option):
                sections[section_of(parameter.name or "")].append(record)
        for title, records in sections.items():
            if records:
                with formatter.section(title):
                    formatter.write_dl(records)


def section_of(option: str) -> str:
    """Return the title of the section of an option, by its name in Python."""
    if option == "algorithm":
        return LEARNING
    if option not in PARAMETERS:
        return OPTIONS
    if PARAMETERS[option].schedule:
        return SCHEDULES
    if option == "policy" or any(option in policy.parameters for policy in POLICY_BY_ID.values()):
        return CHOOSING
    learners = [algorithm for algorithm in BY_ID.values() if not algorithm.planner]
    return LEARNING if all(option in each.parameters for each in learners) else SOME
