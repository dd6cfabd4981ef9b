"""Figure 6.3: three TD control methods on the cliff, soon and in the long run, by their step size.

Interim performance is the mean return of the first 100 episodes, asymptotic performance of 100,000, with ε =
0.1 and γ = 1 (Sutton & Barto, 2nd ed., page 133; H. van Seijen, H. van Hasselt, S. Whiteson, M. Wiering: A
Theoretical and Empirical Analysis of Expected Sarsa, ADPRL 2009).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from rl_tui.studies.book_figures.cliff import SETTINGS
from rl_tui.studies.book_figures.drawing import BAND, drawn, summary_of_comparisons
from rl_tui.studies.book_figures.figure import BookComparison, MeasuredCurve, MeasuredFigure, read_off
from rl_tui.studies.book_figures.measuring import Measuring, mean_and_error, of_runs
from rl_tui.studies.pictures.picture import Chart, Picture, close_axis, fixed_axis
from rl_tui.worlds.mdp.space import FloatArray

STEP_SIZES: Final = tuple(round(0.1 + 0.05 * place, 2) for place in range(19))
INTERIM, ASYMPTOTIC = 100, 100_000
"""Number of episodes in each mean."""
ASYMPTOTIC_RUNS: Final = 10
"""As in the book. More add little, because each is a mean of many episodes."""
NAMES: Final = {"expected-sarsa": "Expected SARSA", "sarsa": "SARSA", "q-learning": "Q-learning"}
RETURNS: Final = "sum of rewards per episode"

Returns = dict[tuple[str, float], FloatArray]
"""Mean return per episode in each run, by algorithm and step size."""


def measure(
    measuring: Measuring,
    runs: int,
    step_sizes: Sequence[float] = STEP_SIZES,
    episodes: int = ASYMPTOTIC,
) -> MeasuredFigure:
    """Train for interim and, at most ten times over `episodes`, for asymptotic performance."""
    long_runs = min(runs, ASYMPTOTIC_RUNS)
    cells = [(algorithm, step_size) for algorithm in NAMES for step_size in step_sizes]
    measuring.expect(len(cells) * (runs * INTERIM + long_runs * episodes))

    def returns(cell: tuple[str, float], count: int, length: int) -> FloatArray:
        algorithm, alpha = cell
        made = measuring.train("cliff", count, length, algorithm=algorithm, alpha=alpha, **SETTINGS)
        return of_runs(made, "return_mean")

    soon = {cell: returns(cell, runs, INTERIM) for cell in cells}
    late = {cell: returns(cell, long_runs, episodes) for cell in cells}
    curves = tuple(
        _curve(f"{name}, {when}", algorithm, of, step_sizes)
        for algorithm, name in NAMES.items()
        for when, of in (("asymptotic", late), ("interim", soon))
    )
    table = _table(soon, late, step_sizes[0], step_sizes[-1])
    note = (
        f"Interim: episodes 1 to {INTERIM}, means of {runs:,} runs. Asymptotic: {episodes:,} episodes, means "
        f"of {long_runs} runs."
    )
    return MeasuredFigure(table, curves, _picture(curves, table, note), (note,))


def _curve(name: str, algorithm: str, returns: Returns, step_sizes: Sequence[float]) -> MeasuredCurve:
    figures = [mean_and_error(returns[algorithm, alpha]) for alpha in step_sizes]
    return MeasuredCurve(
        RETURNS, name, step_sizes, [mean for mean, _ in figures], [error for _, error in figures]
    )


def _table(soon: Returns, late: Returns, first: float, last: float) -> tuple[BookComparison, ...]:
    text = "text, section 6.6"
    expected = NAMES["expected-sarsa"]
    return (
        read_off(
            f"asymptotic, {expected}, α = {last:g}", -22, 4, *mean_and_error(late["expected-sarsa", last])
        ),
        read_off(f"asymptotic, Q-learning, α = {last:g}", -50, 5, *mean_and_error(late["q-learning", last])),
        read_off(f"asymptotic, SARSA, α = {first:g}", -23, 4, *mean_and_error(late["sarsa", first])),
        BookComparison(
            f"asymptotic, {expected}: α = {last:g} minus α = {first:g}",
            "no degradation",
            text,
            0.0,
            float("inf"),
            *mean_and_error(late["expected-sarsa", last] - late["expected-sarsa", first]),
        ),
        BookComparison(
            f"asymptotic, SARSA: α = {last:g} minus α = {first:g}",
            "degrades",
            text,
            -float("inf"),
            0.0,
            *mean_and_error(late["sarsa", last] - late["sarsa", first]),
        ),
        *(
            BookComparison(
                f"interim, {expected} minus {NAMES[other]}, each with its best α",
                "better",
                text,
                0.0,
                float("inf"),
                *mean_and_error(_best(soon, "expected-sarsa") - _best(soon, other)),
            )
            for other in ("sarsa", "q-learning")
        ),
    )


def _best(returns: Returns, algorithm: str) -> FloatArray:
    return max(
        (values for (name, _), values in returns.items() if name == algorithm), key=lambda each: each.mean()
    )


def _picture(curves: Sequence[MeasuredCurve], table: Sequence[BookComparison], note: str) -> Picture:
    return Picture(
        title="Cliff walking: TD control by step size, early and in the long run",
        summary=summary_of_comparisons(
            "One chart over the step size α. Each of three methods has two curves: the mean return of "
            "an episode among the first 100, and in the long run.",
            table,
        ),
        panels=(
            Chart(
                "Sum of rewards per episode",
                close_axis("step size α", curves[0].x),
                fixed_axis("", [-160, -120, -80, -40, 0]),
                tuple(drawn(curve, place // 2, dashed=bool(place % 2)) for place, curve in enumerate(curves)),
            ),
        ),
        notes=(f"{note} Below −160 the curves are cut, as in the book.",),
        band=BAND,
    )
