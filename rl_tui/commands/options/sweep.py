"""Options of commands that work on many runs."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Final

import click

from rl_tui.commands.options.run import OptionValue

if TYPE_CHECKING:
    from rl_tui.runs.measures import Measure
    from rl_tui.studies.sweeps.cells.variation import Variation
    from rl_tui.studies.sweeps.plan import Shard

MOST_SHARDS: Final = 100_000
_ADDRESS: Final = re.compile(r"(?:tcp|tls)://(?:[\w.-]+|\[[0-9a-fA-F:.]+\]):\d{1,5}", re.ASCII)


class VariationValue(OptionValue):
    """What varies, NAME=FROM:TO[:log]:COUNT or NAME=A,B,C."""

    name = "NAME=FROM:TO[:log]:COUNT|NAME=A,B,C"

    def get_metavar(self, param: click.Parameter, ctx: click.Context | None = None) -> str:
        """Return what the help shows in place of a value."""
        return self.name

    def convert(self, value: object, param: click.Parameter | None, ctx: click.Context | None) -> Variation:
        """Return the variation; fails naming what is expected."""
        from rl_tui.studies.sweeps.cells.variation import Variation, read_variation

        if isinstance(value, Variation):
            return value
        try:
            return read_variation(str(value))
        except ValueError as fault:
            self.fail(str(fault), param, ctx)


class ShardValue(OptionValue):
    """One of several parts, I/N."""

    name = "I/N"

    def convert(self, value: object, param: click.Parameter | None, ctx: click.Context | None) -> Shard:
        """Return the shard; fails naming what is expected."""
        from rl_tui.studies.sweeps.plan import Shard

        if isinstance(value, Shard):
            return value
        found = re.fullmatch(r"(\d{1,6})/(\d{1,6})", str(value), re.ASCII)
        number, count = (int(found[1]), int(found[2])) if found else (0, 0)
        if not 1 <= number <= count <= MOST_SHARDS:
            self.fail(f"{value} is not I/N, part I of N, such as 1/3", param, ctx)
        return Shard(number, count)


class MeasureValue(OptionValue):
    """The id of a measure."""

    name = "MEASURE"

    def convert(self, value: object, param: click.Parameter | None, ctx: click.Context | None) -> Measure:
        """Return the measure; fails naming those there are."""
        from rl_tui.runs.measures import Measure
        from rl_tui.studies.sweeps.cell import MEASURES

        if isinstance(value, Measure):
            return value
        if str(value) not in MEASURES:
            self.fail(f"there is no measure {value}; expected one of {', '.join(MEASURES)}", param, ctx)
        return MEASURES[str(value)]


class SchedulerValue(OptionValue):
    """The address of a Dask scheduler."""

    name = "ADDRESS"

    def convert(self, value: object, param: click.Parameter | None, ctx: click.Context | None) -> str:
        """Return the address; fails naming what is expected."""
        if not _ADDRESS.fullmatch(str(value)):
            self.fail(f"{value} is no address of a Dask scheduler, such as tcp://node1:8786", param, ctx)
        return str(value)
