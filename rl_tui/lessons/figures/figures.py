"""The figures of a lesson, recomputed from their expressions."""

from __future__ import annotations

import ast
import inspect
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

from rl_tui.common.errors import UserError
from rl_tui.common.findings import Finding, near, shown
from rl_tui.lessons.figures import exact, runs
from rl_tui.lessons.figures import subject as world_facts
from rl_tui.lessons.figures.expression import FigureError, SeedMean, evaluate, read_expression
from rl_tui.lessons.figures.step_budget import StepBudget
from rl_tui.lessons.figures.subject import (
    ARGUMENTS,
    OTHER_WORLD,
    SETTINGS,
    FigureSubject,
    plain_name,
    subject_of,
)
from rl_tui.lessons.figures.written import WrittenNumber, in_digits_of, written_number

if TYPE_CHECKING:
    from rl_tui.lessons.file.schema import Figure
    from rl_tui.lessons.lesson import Lesson


# Functions in expressions


@dataclass(frozen=True, slots=True)
class FigureFunction:
    """A function of expressions. `work` takes a FigureSubject first, unless mathematical. `more` are further
    named arguments.
    """

    name: str
    work: Callable[..., Any]
    meaning: str
    more: tuple[str, ...] = ()
    needs_subject: bool = True

    @property
    def signature(self) -> inspect.Signature:
        """Its arguments without the subject."""
        parameters = list(inspect.signature(self.work).parameters.values())
        named = [each for each in parameters if each.kind is not inspect.Parameter.VAR_KEYWORD]
        plain = [each.replace(annotation=inspect.Parameter.empty) for each in named]
        return inspect.Signature(plain[1:] if self.needs_subject else plain)

    @property
    def arguments(self) -> tuple[str, ...]:
        """Names of all arguments."""
        return (*self.signature.parameters, *self.more)


def _rows(*functions: Callable[..., Any], more: tuple[str, ...] = ()) -> list[FigureFunction]:
    return [FigureFunction(each.__name__, each, _meaning(each), more) for each in functions]


def _meaning(function: Callable[..., Any]) -> str:
    """Return the first line of a docstring, which people read, without "Return"."""
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
        _plain("exp", _exp, "The number e to the power x."),
        _plain("round", _round, "The number rounded to `digits` decimals."),
    )
}


def called(
    name: str,
    arguments: list[Any],
    by_name: Mapping[str, Any],
    subject_with: Callable[[dict[str, Any]], FigureSubject],
) -> Any:
    """Call a function of expressions. Raises FigureError.

    Settings among the arguments that are not its own change its subject: `subject_with` returns that.
    """
    row = FUNCTIONS.get(name)
    if row is None:
        raise FigureError(f"unknown function {name}; use a function of lesson files{near(name, FUNCTIONS)}")
    own = {key: value for key, value in by_name.items() if key in row.arguments}
    others = {key: value for key, value in by_name.items() if key not in row.arguments}
    if not row.needs_subject:
        return _mathematics(row, arguments, by_name)
    known = (*OTHER_WORLD, *SETTINGS)
    for key in others:
        if plain_name(key) not in known:
            raise FigureError(
                f"{name} has no argument {key}; use one of its own, or a setting"
                f"{near(key, (*row.arguments, *known))}"
            )
    try:
        row.signature.bind(*arguments, **{key: own[key] for key in own if key not in row.more})
    except TypeError as fault:
        raise FigureError(f"{name}: {fault}; write {name}{row.signature}") from fault
    return row.work(subject_with(others), *arguments, **own)


def _mathematics(row: FigureFunction, arguments: list[Any], by_name: Mapping[str, Any]) -> float:
    for value in (*arguments, *by_name.values()):
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise FigureError(f"{row.name} of {shown(value)} is not possible; use numbers")
    try:
        return float(row.work(*(float(each) for each in arguments), **by_name))
    except (TypeError, ValueError, OverflowError) as fault:
        raise FigureError(
            f"{row.name}: {fault}; write {row.name}{row.signature}, with numbers for which it has a value"
        ) from fault


# Recomputed figures


OVER_SEEDS: Final = frozenset(
    ("mean", "error_of_mean", "median", "least", "greatest", "share", "count", "ahead")
)
"""Functions that train many runs, skipped by a quick check."""


class LessonFigures:
    """Computes each figure of a lesson once, within the `budget` of steps."""

    def __init__(self, lesson: Lesson, budget: StepBudget | None = None) -> None:
        self._lesson = lesson
        self._known: dict[Any, Any] = {}
        self._budget = budget or StepBudget()
        self._by_name = {name.replace("-", "_"): name for name in lesson.figures}
        self._values: dict[str, Any] = {}
        self._faults: dict[str, UserError] = {}
        self._under_way: list[str] = []

    def value(self, name: str) -> Any:
        """Return a number or a text. Raises UserError without one."""
        if name in self._faults:
            raise self._faults[name]
        if name not in self._values:
            if name in self._under_way:
                circle = " → ".join([*self._under_way[self._under_way.index(name) :], name])
                raise FigureError(f"{circle} is a cycle; a figure must not depend on itself")
            self._under_way.append(name)
            try:
                with self._budget.of_figure(name):
                    self._values[name] = self._worked_out(self._lesson.figures[name])
            except UserError as fault:
                self._faults[name] = fault
                raise
            except RecursionError:
                raise FigureError("figures are nested too deeply; use fewer levels") from None
            finally:
                self._under_way.pop()
        return self._values[name]

    def subject_of_page(self, page: str) -> FigureSubject:
        """Return the subject of a page's setup. Raises UserError."""
        return subject_of(self._lesson, self._lesson.setup_of(page), {}, self._known, self._budget)

    def needs_seeds(self, name: str) -> bool:
        """Return True if a figure needs many seeds."""
        ahead, seen = [name], {name}
        while ahead:
            try:
                tree = read_expression(self._lesson.figures[ahead.pop()].by)
            except FigureError:
                continue  # reported when it is computed
            names = {each.id for each in ast.walk(tree) if isinstance(each, ast.Name)}
            if OVER_SEEDS & names:
                return True
            new = {self._by_name[each] for each in names if each in self._by_name} - seen
            ahead += new
            seen |= new
        return False

    def finding(self, name: str) -> Finding | None:
        """Return the error of a figure, if any."""
        figure = self._lesson.figures[name]
        if plain_name(name) in SETTINGS and figure.by.strip() != name:
            return Finding(("figures", name), f"{shown(name)} is already a setting; choose another name")
        try:
            exact = self.value(name)
        except FigureError as fault:
            return Finding(("figures", name, "by"), fault.found, fault.expected)
        except UserError as fault:
            return Finding(("figures", name, "by"), f"cannot be computed: {fault}")
        wrong = _why_wrong(figure.value, exact)
        return None if wrong is None else Finding(("figures", name, "value"), shown(figure.value), wrong)

    def _worked_out(self, figure: Figure) -> Any:
        setup = figure.setup or next(iter(self._lesson.setups))
        tree = read_expression(figure.by)

        def subject_with(overrides: dict[str, Any]) -> FigureSubject:
            return subject_of(self._lesson, setup, overrides, self._known, self._budget)

        def look(name: str) -> Any:
            if plain_name(name) in SETTINGS:
                return subject_with({}).setting(name)
            if name in self._by_name:
                return self.value(self._by_name[name])
            known = (*self._by_name, *SETTINGS)
            raise FigureError(shown(name), f"the name of a figure or of a setting{near(name, known)}")

        def call(name: str, arguments: list[Any], by_name: dict[str, Any]) -> Any:
            return called(name, arguments, by_name, subject_with)

        return evaluate(tree, look, call)


def _why_wrong(value: str, exact: Any) -> str | None:
    if isinstance(exact, str):
        return None if value == exact else shown(exact)
    if isinstance(exact, bool) or not isinstance(exact, int | float):
        return f"a number or a string, but the expression gives {shown(exact)}"
    written = written_number(value)
    error = exact.error if isinstance(exact, SeedMean) else None
    recomputed = in_digits_of(exact, value) + (
        f" ± {in_digits_of(error, value)}" if error is not None else ""
    )
    if written is None:
        return f"a number, such as {recomputed}"
    if not written.agrees_with(exact):
        return recomputed
    return _why_error_wrong(written, error, recomputed)


def _why_error_wrong(written: WrittenNumber, error: float | None, recomputed: str) -> str | None:
    if written.error is None:
        return None
    if error is None:
        return "a number without ±, because it is not a mean over seeds"
    return None if written.error.agrees_with(error) else recomputed
