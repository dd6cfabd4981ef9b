"""All figures of a lesson, worked out again."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING, Any, Final

from rl_tui.common.errors import UserError
from rl_tui.common.findings import Finding, near, shown
from rl_tui.lab.lessons.figures.expression import FigureError, SeedMean, evaluate, read_expression
from rl_tui.lab.lessons.figures.functions import called
from rl_tui.lab.lessons.figures.step_budget import StepBudget
from rl_tui.lab.lessons.figures.subject import SETTINGS, FigureSubject, plain_name, subject_of
from rl_tui.lab.lessons.figures.written import WrittenNumber, in_digits_of, written_number

if TYPE_CHECKING:
    from rl_tui.lab.lessons.lesson import Lesson
    from rl_tui.lab.lessons.schema import Figure

OVER_SEEDS: Final = frozenset(
    ("mean", "error_of_mean", "median", "least", "greatest", "share", "count", "ahead")
)
"""Functions whose work is many runs: what a quick check leaves out."""


class LessonFigures:
    """Works out the figures of ``lesson``, each once, by runs that keep within ``budget``."""

    def __init__(self, lesson: Lesson, budget: StepBudget | None = None) -> None:
        self._lesson = lesson
        self._known: dict[Any, Any] = {}
        self._budget = budget or StepBudget()
        self._by_name = {name.replace("-", "_"): name for name in lesson.figures}
        self._values: dict[str, Any] = {}
        self._faults: dict[str, UserError] = {}
        self._under_way: list[str] = []

    def value(self, name: str) -> Any:
        """Return the figure of this name: a number or a text. Raises UserError where it has none."""
        if name in self._faults:
            raise self._faults[name]
        if name not in self._values:
            if name in self._under_way:
                circle = " → ".join([*self._under_way[self._under_way.index(name) :], name])
                raise FigureError(f"{circle}, a circle", "figures that do not ask for themselves")
            self._under_way.append(name)
            try:
                with self._budget.of_figure(name):
                    self._values[name] = self._worked_out(self._lesson.figures[name])
            except UserError as fault:
                self._faults[name] = fault
                raise
            except RecursionError:
                raise FigureError("figures of figures of figures, too deep", "a shorter way") from None
            finally:
                self._under_way.pop()
        return self._values[name]

    def subject_of_page(self, page: str) -> FigureSubject:
        """Return the subject of the setup that applies on a page. Raises UserError."""
        return subject_of(self._lesson, self._lesson.setup_of(page), {}, self._known, self._budget)

    def needs_seeds(self, name: str) -> bool:
        """Return whether a figure, or one that it asks for, takes runs over many seeds."""
        ahead, seen = [name], {name}
        while ahead:
            try:
                tree = read_expression(self._lesson.figures[ahead.pop()].by)
            except FigureError:
                continue  # told when it is worked out
            names = {each.id for each in ast.walk(tree) if isinstance(each, ast.Name)}
            if OVER_SEEDS & names:
                return True
            new = {self._by_name[each] for each in names if each in self._by_name} - seen
            ahead += new
            seen |= new
        return False

    def finding(self, name: str) -> Finding | None:
        """Return what is wrong with a figure; None where it is so."""
        figure = self._lesson.figures[name]
        if plain_name(name) in SETTINGS and figure.by.strip() != name:
            return Finding(
                ("figures", name), shown(name), f"another name: {name} is the setting of that name"
            )
        try:
            exact = self.value(name)
        except FigureError as fault:
            return Finding(("figures", name, "by"), fault.found, fault.expected)
        except UserError as fault:
            return Finding(("figures", name, "by"), str(fault), "what can be worked out")
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
    """Return what was expected in place of the written ``value``; None where it is right."""
    if isinstance(exact, str):
        return None if value == exact else shown(exact)
    if isinstance(exact, bool) or not isinstance(exact, int | float):
        return f"a figure that is a number or a text; this one is {shown(exact)}"
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
        return "a number without ±: this one is no mean over seeds"
    return None if written.error.agrees_with(error) else recomputed
