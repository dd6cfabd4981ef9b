"""The policy that a person drew as a file, and the command that evaluates it."""

from __future__ import annotations

import json
import shlex

from rl_tui.runs.answers.policy_values import DrawnPolicy
from rl_tui.runs.changes import written_value
from rl_tui.runs.export.recipe_line import allowance, scenario_name
from rl_tui.runs.policy_file import policy_document
from rl_tui.runs.recipe import Recipe
from rl_tui.worlds.mdp.space import FiniteSpace


def policy_text(space: FiniteSpace, drawn: DrawnPolicy) -> str:
    """Return ``drawn`` as the JSON that ``rl-tui evaluate`` reads."""
    return json.dumps(policy_document(space, drawn.pairs(space)), indent=1, ensure_ascii=False) + "\n"


def evaluate_line(recipe: Recipe, file: str) -> str:
    """Return the command that says what the policy in ``file`` is worth, quoted for a shell.

    γ is that of ``recipe``. Raises UserError where no file holds the scenario.
    """
    scenario = recipe.scenario
    seed = ["--seed", str(recipe.seed)] if scenario.section.drawn_from_seed else []
    gamma = written_value(recipe.hyperparameters.gamma)
    words = ["rl-tui", "evaluate", scenario_name(scenario), *allowance(scenario)]
    return shlex.join([*words, "--policy", file, "--gamma", gamma, *seed])
