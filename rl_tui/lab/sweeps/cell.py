"""A cell of a sweep: one combination of the settings that vary, and the key under which its runs are kept."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Final

from rl_tui.agents.catalogue import BY_ID, parameters_of
from rl_tui.agents.hyperparameters import PARAMETERS, SAMPLE_AVERAGE, Hyperparameters
from rl_tui.agents.idle_parameters import why_idle
from rl_tui.lab.experiments.training import Goal
from rl_tui.lab.run.recipe import Recipe
from rl_tui.lab.sweeps.cells.content import WorldContent
from rl_tui.lab.sweeps.variation import Value, written

KEY_FORMAT: Final = 1
"""Raised when the key itself is made in another way."""
KERNELS: Final = 1
"""Raised when the same recipe and seed come to other steps or estimates than before, bit for bit."""
FIGURES: Final = 1
"""Raised when the same run comes to other figures, or to figures of another meaning."""

# Figures are those of the greedy policy, whose ties this decides, whatever the agent's own policy is
_ALWAYS: Final = ("ties",)
_STEP_SIZE: Final = ("step_size_schedule", "alpha_min", "alpha_decay")


@dataclass(frozen=True, eq=False)
class Cell:
    """One combination of settings: what is trained there, under every seed alike."""

    index: int
    """Its number in the plan, from 0."""
    settings: Mapping[str, Value]
    """The value of each setting that varies, by its name, in the order of the plan."""
    recipe: Recipe
    """How its runs start; the seed is the first of the plan."""
    goal: Goal
    """So many episodes each run is trained for."""
    content: WorldContent
    """The world of its runs."""

    @cached_property
    def identity(self) -> dict[str, Any]:
        """All that its runs come from but for the seed, in one form: what its key is a hash of."""
        return {
            "format": KEY_FORMAT,
            "kernels": KERNELS,
            "figures": FIGURES,
            "world": self.content.digest,
            "algorithm": self.recipe.algorithm,
            "policy": None if BY_ID[self.recipe.algorithm].planner else self.recipe.hyperparameters.policy,
            "parameters": used_parameters(
                self.recipe.algorithm, self.recipe.hyperparameters, is_bandit=self.content.is_bandit
            ),
            "episodes": self.goal.episodes,
        }

    @cached_property
    def key(self) -> str:
        """The sha256, in hexadecimal, of the text of its identity."""
        return hashlib.sha256(self.identity_text.encode()).hexdigest()

    @cached_property
    def identity_text(self) -> str:
        """Its identity as JSON with sorted keys and no spaces."""
        return json.dumps(self.identity, sort_keys=True, separators=(",", ":"), allow_nan=False)

    @property
    def text(self) -> str:
        """Its settings in one line: ``alpha=0.1 algorithm=sarsa``."""
        return settings_text(self.settings)


@dataclass(frozen=True)
class SkippedCell:
    """A combination of settings that cannot work together, and why."""

    index: int
    settings: Mapping[str, Value]
    reason: str


def settings_text(settings: Mapping[str, Value]) -> str:
    """Return ``settings`` in one line: ``alpha=0.1 algorithm=sarsa``."""
    return " ".join(f"{name}={written(value)}" for name, value in settings.items())


def used_parameters(
    algorithm: str, values: Hyperparameters, *, is_bandit: bool
) -> dict[str, int | float | str]:
    """Return the hyper-parameters that make a difference, each in one form: what is equal is written alike.

    Those that algorithm and policy do not use are left out, and so are those that change nothing as things
    stand, such as where a decay of 0 would end.
    """
    used: dict[str, int | float | str] = {}
    for name in dict.fromkeys((*parameters_of(algorithm, values.policy), *_ALWAYS)):
        if name == "policy" or why_idle(name, algorithm, values, is_bandit=is_bandit):
            continue
        if values.sample_average and name in ("alpha", *_STEP_SIZE):
            used["alpha"] = SAMPLE_AVERAGE  # alpha may say so, or its schedule
            continue
        value = values.value(name)
        if not isinstance(value, str):
            value = int(value) if PARAMETERS[name].whole else float(value) + 0.0  # no zero below zero
        used[name] = value
    return used
