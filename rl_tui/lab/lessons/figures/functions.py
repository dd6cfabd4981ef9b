"""What expressions of figures may call: a row each, with its meaning in one line."""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Final

from rl_tui.common.findings import near, shown
from rl_tui.lab.lessons.figures import exact, runs, world_facts
from rl_tui.lab.lessons.figures.expression import FigureError
from rl_tui.lab.lessons.figures.measuring import ARGUMENTS
from rl_tui.lab.lessons.figures.subject import OTHER_WORLD, SETTINGS, FigureSubject, plain_name


@dataclass(frozen=True, slots=True)
class FigureFunction:
    """A function of expressions: ``work`` takes a FigureSubject first, but for one of plain mathematics.

    ``more`` are arguments by name that it takes beside those of its signature.
    """

    name: str
    work: Callable[..., Any]
    meaning: str
    more: tuple[str, ...] = ()
    needs_subject: bool = True

    @property
    def signature(self) -> inspect.Signature:
        """Its arguments, the subject left out."""
        parameters = list(inspect.signature(self.work).parameters.values())
        named = [each for each in parameters if each.kind is not inspect.Parameter.VAR_KEYWORD]
        plain = [each.replace(annotation=inspect.Parameter.empty) for each in named]
        return inspect.Signature(plain[1:] if self.needs_subject else plain)

    @property
    def arguments(self) -> tuple[str, ...]:
        """The names of all its arguments."""
        return (*self.signature.parameters, *self.more)


def _rows(*functions: Callable[..., Any], more: tuple[str, ...] = ()) -> list[FigureFunction]:
    return [FigureFunction(each.__name__, each, _meaning(each), more) for each in functions]


def _meaning(function: Callable[..., Any]) -> str:
    """Return what ``function`` is worth: the first line of its docstring, which begins with Return."""
    line = (inspect.getdoc(function) or "").partition("\n")[0].removeprefix("Return ")
    return line[:1].upper() + line[1:]


def _plain(name: str, work: Callable[..., Any], meaning: str) -> FigureFunction:
    return FigureFunction(name, work, meaning, needs_subject=False)


def _round(x: float, digits: float = 0) -> float:
    return round(x, int(digits))


def _abs(x: float) -> float:
    return abs(x)


def _sqrt(x: float) -> float:
    return math.sqrt(x)


def _log(x: float) -> float:
    return math.log(x)


def _log10(x: float) -> float:
    return math.log10(x)


def _exp(x: float) -> float:
    return math.exp(x)


def _min(*numbers: float) -> float:
    return min(numbers)


def _max(*numbers: float) -> float:
    return max(numbers)


_LENGTH: Final = ("steps", "episodes", "changes")
FUNCTIONS: Final[Mapping[str, FigureFunction]] = {
    row.name: row
    for row in (
        *_rows(
            exact.optimal_value,
            exact.optimal_q,
            exact.optimal_return,
            exact.best_return,
            exact.unlimited_return,
            exact.policy_value,
            exact.policy_return,
            exact.policy_steps,
            exact.policy_ends,
            exact.policy_unlimited_return,
            exact.soft_return,
            exact.soft_steps,
            exact.flip,
            exact.way_flip,
            exact.flips,
            exact.first_update_chance,
            exact.mean_episodes,
            exact.median_episodes,
            world_facts.states,
            world_facts.live_states,
            world_facts.pairs,
            world_facts.actions,
            world_facts.time_limit,
            world_facts.budget,
            world_facts.reward,
            world_facts.chance,
        ),
        *_rows(runs.run, runs.attempt, more=ARGUMENTS),
        *_rows(
            runs.mean,
            runs.error_of_mean,
            runs.median,
            runs.least,
            runs.greatest,
            runs.ahead,
            more=(*_LENGTH, *ARGUMENTS),
        ),
        *_rows(runs.share, runs.count, more=(*_LENGTH, *runs.TESTS, *ARGUMENTS)),
        _plain("abs", _abs, "The number without its sign."),
        _plain("min", _min, "The least of the numbers."),
        _plain("max", _max, "The greatest of the numbers."),
        _plain("sqrt", _sqrt, "The square root."),
        _plain("log", _log, "The natural logarithm."),
        _plain("log10", _log10, "The logarithm to base 10."),
        _plain("exp", _exp, "The number e to that power."),
        _plain("round", _round, "The number rounded to so many decimals."),
    )
}


def called(
    name: str,
    arguments: list[Any],
    by_name: Mapping[str, Any],
    subject_with: Callable[[dict[str, Any]], FigureSubject],
) -> Any:
    """Return what the function of this ``name`` comes to.

    Of the arguments ``by_name`` those that are settings, and none of its own, make another subject:
    ``subject_with`` returns it. Raises FigureError.
    """
    row = FUNCTIONS.get(name)
    if row is None:
        raise FigureError(f"{name}(…)", f"the name of a function{near(name, FUNCTIONS)}")
    own = {key: value for key, value in by_name.items() if key in row.arguments}
    others = {key: value for key, value in by_name.items() if key not in row.arguments}
    if not row.needs_subject:
        return _mathematics(row, arguments, by_name)
    known = (*OTHER_WORLD, *SETTINGS)
    for key in others:
        if plain_name(key) not in known:
            raise FigureError(
                f"{name}(… {key} = …)",
                f"an argument of {name}, or a setting{near(key, (*row.arguments, *known))}",
            )
    try:
        row.signature.bind(*arguments, **{key: own[key] for key in own if key not in row.more})
    except TypeError as fault:
        raise FigureError(f"{name}(…): {fault}", f"{name}{row.signature}") from fault
    return row.work(subject_with(others), *arguments, **own)


def _mathematics(row: FigureFunction, arguments: list[Any], by_name: Mapping[str, Any]) -> float:
    for value in (*arguments, *by_name.values()):
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise FigureError(f"{row.name}({shown(value)})", f"{row.name} of numbers")
    try:
        return float(row.work(*(float(each) for each in arguments), **by_name))
    except (TypeError, ValueError, OverflowError) as fault:
        raise FigureError(
            f"{row.name}(…): {fault}", f"{row.name}{row.signature} of numbers it has a value for"
        ) from fault
