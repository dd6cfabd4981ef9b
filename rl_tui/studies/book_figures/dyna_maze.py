"""Figure 8.2: steps per episode of Dyna-Q in the maze of example 8.1, by the number of planning steps.

γ = 0.95, α = 0.1, ε = 0.1, 50 episodes (Sutton & Barto, 2nd ed., pages 164 and 165).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

from rl_tui.agents.exact.policy_figures import figures, uniform_policy
from rl_tui.runs.recipe import begin
from rl_tui.studies.book_figures.drawing import BAND, panel_of, summary_of_comparisons
from rl_tui.studies.book_figures.figure import BookComparison, MeasuredCurve, MeasuredFigure
from rl_tui.studies.book_figures.measuring import Measuring, recipe_of
from rl_tui.studies.pictures.picture import Chart, Picture, close_axis, fixed_axis

EPISODES: Final = 50
STEPS: Final = "steps per episode"
SHORT: Final = 20.0
"""Mean steps of a short episode. The shortest path has 14, about 17 with exploration."""
# For each number of planning steps: the episode from which the book finds ε-optimal behaviour, and its
# margin
BOOK: Final = {0: (25, 5), 5: (5, 2), 50: (3, 1)}
_TEXT: Final = "text, example 8.1"


def measure(measuring: Measuring, runs: int) -> MeasuredFigure:
    """Train `runs` times for each number of planning steps."""
    measuring.expect(len(BOOK) * runs * EPISODES)
    made = {
        planning: measuring.train(
            "maze",
            runs,
            EPISODES,
            algorithm="dyna-q",
            policy="epsilon-greedy",
            planning_steps=planning,
            alpha=0.1,
            gamma=0.95,
            epsilon=0.1,
        )["curve"]
        for planning in BOOK
    }
    curves = tuple(
        MeasuredCurve(
            STEPS, name_of(planning), curve["episode"], curve["length_mean"], curve["length_stderr"]
        )
        for planning, curve in made.items()
    )
    table = _table(made)
    return MeasuredFigure(table, curves, _picture(curves, table, runs), _notes())


def name_of(planning: int) -> str:
    """Return the name of a curve."""
    return f"{planning} planning steps" if planning else "0 planning steps (direct RL only)"


def _table(made: dict[int, dict[str, list[Any]]]) -> tuple[BookComparison, ...]:
    return (
        *(
            BookComparison(
                f"first episode of at most {SHORT:g} steps on average, {planning} planning steps",
                f"about {episode}",
                _TEXT,
                episode - margin,
                episode + margin,
                first_short(made[planning]),
            )
            for planning, (episode, margin) in BOOK.items()
        ),
        BookComparison(
            "steps of the first episode, 0 planning steps",
            "about 1700",
            _TEXT,
            1650.0,
            1750.0,
            made[0]["length_mean"][0],
            made[0]["length_stderr"][0],
        ),
    )


def first_short(curve: dict[str, list[Any]]) -> float | None:
    """Return the first short episode of `curve`, or None."""
    episodes = zip(curve["episode"], curve["length_mean"], strict=True)
    return next((float(episode) for episode, length in episodes if length <= SHORT), None)


def _picture(curves: tuple[MeasuredCurve, ...], table: Sequence[BookComparison], runs: int) -> Picture:
    later = tuple(
        MeasuredCurve(each.panel, each.name, each.x[1:], each.mean[1:], each.stderr[1:]) for each in curves
    )
    return Picture(
        title="Dyna maze: steps per episode by the number of planning steps",
        summary=summary_of_comparisons(
            f"One chart over the episodes 2 to {EPISODES}, with a curve for each number of planning steps.",
            table,
        ),
        panels=(
            Chart(
                "Steps per episode",
                close_axis("episodes", [2, EPISODES]),
                fixed_axis("", [0, 200, 400, 600, 800]),
                panel_of(later, STEPS),
            ),
        ),
        notes=(f"Means of {runs:,} runs. The first episode is left out, as in the book.",),
        band=BAND,
    )


def _notes() -> tuple[str, ...]:
    return (
        "Nothing is learned before the goal is found, so the first episode is a random walk, of "
        f"exactly {steps_of_a_random_walk():.1f} steps on average in this maze. The book says about 1700.",
    )


def steps_of_a_random_walk() -> float | None:
    """Compute the expected steps to the goal under the random policy."""
    mdp = begin(recipe_of("maze")).world.mdp
    return None if mdp is None else figures(mdp, uniform_policy(mdp), 1.0).steps
