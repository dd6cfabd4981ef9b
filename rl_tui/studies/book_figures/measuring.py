"""Training for a figure: shipped scenarios, explicit settings, common seeds."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any, Final

import numpy as np

from rl_tui.runs.library import recipe_for
from rl_tui.runs.recipe import Recipe
from rl_tui.runs.training.many_runs import many_runs
from rl_tui.runs.training.seeded_runs import Goal, OnProgress, no_compiling, no_progress
from rl_tui.worlds.files.scenario import read_scenario
from rl_tui.worlds.files.shipped import SUFFIX, shipped_folder
from rl_tui.worlds.mdp.space import FloatArray

SETTINGS: Final = {"initial_q": 0.0, "ties": "random", "epsilon_decay": 0.0, "alpha_decay": 0.0}
"""Settings of all figures that the book does not give."""
MOST_BINS: Final = 1_000


class Measuring:
    """Trains for several figures, with seeds from `seed` on."""

    def __init__(
        self,
        seed: int = 0,
        on_progress: OnProgress = no_progress,
        on_compiling: Callable[[], None] = no_compiling,
    ) -> None:
        self._seed = seed
        self._on_progress = on_progress
        self._on_compiling = on_compiling
        self._episodes = 0
        self._done = 0

    def expect(self, episodes: int) -> None:
        """Add `episodes` to the total of the progress."""
        self._episodes += episodes

    def train(self, scenario: str, runs: int, episodes: int, **settings: object) -> dict[str, Any]:
        """Train a shipped scenario and return the document of `train --runs --json`.

        It has a bin for each episode up to a thousand. Raises UserError.
        """
        recipe = recipe_of(scenario, self._seed, **settings)
        before = self._done

        def on_progress(done: int, wanted: int) -> None:
            self._on_progress(before + done, self._episodes)

        document = many_runs(
            recipe,
            runs,
            Goal(episodes=episodes),
            on_progress=on_progress,
            on_compiling=self._on_compiling,
            most_bins=MOST_BINS,
        )
        self._done += runs * episodes
        return document


def recipe_of(scenario: str, seed: int = 0, **settings: object) -> Recipe:
    """Return the recipe of the shipped `scenario`, not of a user's."""
    file = shipped_folder() / f"{scenario}{SUFFIX}"
    return recipe_for(read_scenario(file), {**SETTINGS, **settings}, seed)


def of_runs(document: dict[str, Any], name: str) -> FloatArray:
    """Return the number `name` of each run, `[runs]`."""
    return np.array([row[name] for row in document["runs"]], dtype=np.float64)


def mean_and_error(values: FloatArray | Sequence[float]) -> tuple[float, float | None]:
    """Return the mean of `values`, `[n]`, and its standard error."""
    count = len(values)
    error = float(np.std(values, ddof=1)) / math.sqrt(count) if count > 1 else None
    return float(np.mean(values)), error
