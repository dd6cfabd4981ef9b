"""Settings that must change together."""

from __future__ import annotations

from rl_tui.agents.compatibility import check_compatible
from rl_tui.agents.hyperparameters import SAMPLE_AVERAGE, Hyperparameters
from rl_tui.common.errors import UserError
from rl_tui.runs.recipe import Recipe, SetParameter, Setting, changed_recipe
from rl_tui.worlds.mdp.space import FiniteSpace


def settings_for(space: FiniteSpace, recipe: Recipe, setting: Setting) -> tuple[Setting, ...]:
    """Return the changes that make `setting` work, some with a step size. Raises UserError."""
    number = _step_size(recipe.hyperparameters) if isinstance(setting, SetParameter) else ()
    if not number:
        return _checked(space, recipe, setting)
    assert isinstance(setting, SetParameter)
    if setting.name in ("alpha", "step_size_schedule") and setting.value != SAMPLE_AVERAGE:
        return _checked(space, recipe, *(each for each in number if each.name != setting.name), setting)
    try:
        return _checked(space, recipe, setting)
    except UserError:
        if setting.name != "policy":
            raise
        return _checked(space, recipe, *number, setting)


def _checked(space: FiniteSpace, recipe: Recipe, *settings: Setting) -> tuple[Setting, ...]:
    changed = changed_recipe(recipe, *settings)
    check_compatible(space, changed.algorithm, changed.hyperparameters)
    return settings


def _step_size(values: Hyperparameters) -> tuple[SetParameter, ...]:
    number = values.without_average()
    return tuple(
        SetParameter(name, number.value(name))
        for name in ("step_size_schedule", "alpha")
        if number.value(name) != values.value(name)
    )
