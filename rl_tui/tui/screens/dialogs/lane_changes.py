"""What is different in another run beside the one shown, and whether it can be."""

from __future__ import annotations

from rl_tui.agents.catalogue import parameters_of
from rl_tui.agents.hyperparameters import PARAMETERS
from rl_tui.common.errors import UserError
from rl_tui.lab.run.recipe import Recipe, SetParameter, Setting, SwitchAlgorithm, changed_recipe
from rl_tui.lab.run.settings import settings_for
from rl_tui.lab.timeline.run_names import difference
from rl_tui.worlds.mdp.space import FiniteSpace

ALGORITHM = "algorithm"


def what_may_differ(recipe: Recipe) -> tuple[str, ...]:
    """Return ``algorithm`` and the hyper-parameters that count for ``recipe``, those of schedules last."""
    names = parameters_of(recipe.algorithm, recipe.hyperparameters.policy)
    return (ALGORITHM, *sorted(names, key=lambda name: PARAMETERS[name].schedule))


def lane_changes(space: FiniteSpace, recipe: Recipe, name: str, value: float | str) -> tuple[Setting, ...]:
    """Return what makes another run of ``recipe`` that has ``value`` for ``name``.

    Raises UserError where that cannot work in ``space`` or is no difference.
    """
    setting = SwitchAlgorithm(str(value)) if name == ALGORITHM else SetParameter(name, value)
    changes = settings_for(space, recipe, setting)
    if not difference(recipe, changed_recipe(recipe, *changes)):
        raise UserError("that is no difference from this lane: choose another value")
    return changes
