"""Recipes that tests share."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from rl_tui.runs.figures import training_figures
from rl_tui.runs.library import find, recipe_for
from rl_tui.runs.recipe import JournalEntry, Recipe
from rl_tui.runs.run import Run
from rl_tui.runs.training.seeded_runs import Goal, train


def recipe(scenario: str, seed: int = 0, **overrides: Any) -> Recipe:
    return recipe_for(find(scenario), overrides, seed)


def bandit(budget: int, seed: int = 0, **overrides: Any) -> Recipe:
    scenario = find("bandit")
    section = scenario.section.model_copy(update={"budget": budget})
    return recipe_for(replace(scenario, section=section), overrides, seed)


def replay(made_from: Recipe, journal: Sequence[JournalEntry], step: int) -> Run:
    run = Run(made_from)
    run.follow(journal, step)
    return run


def one_run(made_from: Recipe, goal: Goal) -> dict[str, Any]:
    run = Run(made_from, evaluate=False)
    return training_figures(run, train(run, goal))
