"""The table of the figures of the book, without heavy imports."""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING, Final, Protocol, cast

if TYPE_CHECKING:
    from rl_tui.studies.book_figures.figure import MeasuredFigure
    from rl_tui.studies.book_figures.measuring import Measuring

BOOK: Final = "Sutton & Barto, Reinforcement Learning, 2nd edition"


@dataclass(frozen=True, slots=True)
class BookFigure:
    """A figure of the book."""

    id: str
    title: str
    source: str
    module: str
    """Module with its function `measure`."""
    book_runs: int | None
    """Number of runs in the book, or None if unknown."""
    runs: int
    """Default number of our runs."""


class _Measure(Protocol):
    def __call__(self, measuring: Measuring, runs: int) -> MeasuredFigure: ...


FIGURES: Final = {
    figure.id: figure
    for figure in (
        BookFigure(
            id="2.2",
            title="ε-greedy methods on the ten-armed testbed",
            source="figure 2.2, page 29",
            module="rl_tui.studies.book_figures.testbed",
            book_runs=2_000,
            runs=2_000,
        ),
        BookFigure(
            id="6.3",
            title="Cliff walking: interim and asymptotic performance by step size",
            source="figure 6.3, page 133, after van Seijen and others, 2009",
            module="rl_tui.studies.book_figures.step_sizes",
            book_runs=50_000,
            runs=1_000,
        ),
        BookFigure(
            id="cliff",
            title="Cliff walking: rewards while SARSA and Q-learning learn",
            source="example 6.6, page 132",
            module="rl_tui.studies.book_figures.cliff",
            book_runs=None,
            runs=1_000,
        ),
        BookFigure(
            id="8.2",
            title="Dyna-Q in a maze, by the number of planning steps",
            source="figure 8.2, page 165",
            module="rl_tui.studies.book_figures.dyna_maze",
            book_runs=30,
            runs=30,
        ),
    )
}
"""All figures by id."""


def measure(figure: BookFigure, measuring: Measuring, runs: int) -> MeasuredFigure:
    """Recompute `figure` with means over `runs` runs. Raises UserError."""
    return cast("_Measure", import_module(figure.module).measure)(measuring, runs)
