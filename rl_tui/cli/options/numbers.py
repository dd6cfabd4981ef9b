"""Option values that are numbers in a range, and the parameter of a learner as an option value."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import click

from rl_tui.agents.hyperparameters import Parameter, Range

if TYPE_CHECKING:
    from rl_tui.lab.run.changes import ChangeText


class OptionValue(click.ParamType):  # type: ignore[type-arg]  # generic in newer versions only
    """A kind of option value."""


class ParameterValue(OptionValue):
    """A value of a hyper-parameter: a number in its range or one of its words."""

    def __init__(self, parameter: Parameter) -> None:
        self.parameter = parameter
        numbers = ["number"] if parameter.range else []
        self.name = "|".join([*numbers, *parameter.words])

    def get_metavar(self, param: click.Parameter, ctx: click.Context | None = None) -> str:
        """Return what the help shows in place of a value."""
        return self.name.replace("number", "NUMBER")

    def convert(self, value: object, param: click.Parameter | None, ctx: click.Context | None) -> float | str:
        """Return the number or word; fails naming what is expected."""
        number = number_in(value)
        if isinstance(value, str) and value in self.parameter.words:
            return value
        if number is None or not self.parameter.accepts(number):
            self.fail(f"{value} is not {self.parameter.expected}", param, ctx)
        return number


class Whole(OptionValue):
    """A whole number from ``low`` to ``high``."""

    name = "N"

    def __init__(self, low: int, high: float = math.inf) -> None:
        self.range = Range(low, high)

    def convert(self, value: object, param: click.Parameter | None, ctx: click.Context | None) -> int:
        """Return the number; fails naming the range."""
        try:
            number: int | None = int(str(value))
        except ValueError:
            number = None
        if number is None or number not in self.range:
            self.fail(f"{value} is not a whole number in {self.range}", param, ctx)
        return number


class Real(OptionValue):
    """A finite number from ``low`` to ``high``."""

    name = "NUMBER"

    def __init__(self, low: float = -math.inf, high: float = math.inf) -> None:
        self.range = Range(low, high)

    def convert(self, value: object, param: click.Parameter | None, ctx: click.Context | None) -> float:
        """Return the number; fails naming the range."""
        number = number_in(value)
        if number is None or not math.isfinite(number) or number not in self.range:
            self.fail(f"{value} is not a number in {self.range}", param, ctx)
        return number


class ChangeValue(OptionValue):
    """A change on the way, STEP:NAME=VALUE."""

    name = "STEP:NAME=VALUE"

    def convert(self, value: object, param: click.Parameter | None, ctx: click.Context | None) -> ChangeText:
        """Return the change; fails naming what is expected."""
        from rl_tui.lab.run.changes import ChangeText, read_change

        if isinstance(value, ChangeText):
            return value
        try:
            return read_change(str(value))
        except ValueError as fault:
            self.fail(str(fault), param, ctx)


def number_in(value: object) -> float | None:
    """Return the number that an option's text spells, None if it spells none."""
    try:
        return float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        return None
