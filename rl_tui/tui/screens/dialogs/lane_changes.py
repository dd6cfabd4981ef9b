"""What is different in another run beside the one shown, and whether it can be."""

from __future__ import annotations

from dataclasses import replace

from rl_tui.agents.catalogue import parameters_of
from rl_tui.agents.compatibility import check_compatible
from rl_tui.agents.hyperparameters import PARAMETERS
from rl_tui.common.errors import UserError
from rl_tui.lab.run.recipe import Recipe, SetParameter, SwitchAlgorithm
from rl_tui.lab.timeline.run_names import difference
from rl_tui.tui.screens.playground.agent_actions import ParameterValue, params_together, with_values
from rl_tui.worlds.mdp.space import FiniteSpace

ALGORITHM = "algorithm"


def what_may_differ(recipe: Recipe) -> tuple[str, ...]:
    """Return ``algorithm`` and the hyper-parameters that count for ``recipe``, those of schedules last."""
    names = parameters_of(recipe.algorithm, recipe.hyperparameters.policy)
    return (ALGORITHM, *sorted(names, key=lambda name: PARAMETERS[name].schedule))


def lane_changes(
    space: FiniteSpace, recipe: Recipe, name: str, value: float | str
) -> tuple[SetParameter | SwitchAlgorithm, ...]:
    """Return what makes another run of ``recipe`` that has ``value`` for ``name``.

    Raises UserError where that cannot work in ``space`` or is no difference.
    """
    if name == ALGORITHM:
        algorithm = str(value)
        check_compatible(space, algorithm, recipe.hyperparameters)
        _check_difference(recipe, replace(recipe, algorithm=algorithm))
        return (SwitchAlgorithm(algorithm),)

    def fault(params: list[ParameterValue]) -> str:
        try:
            check_compatible(space, recipe.algorithm, with_values(recipe.hyperparameters, params))
        except (UserError, ValueError) as error:
            return str(error)
        return ""

    params = params_together(recipe.hyperparameters, name, value, fault)
    reason = fault(params)
    if reason:
        raise UserError(reason)
    other = replace(recipe, hyperparameters=with_values(recipe.hyperparameters, params))
    _check_difference(recipe, other)
    return tuple(SetParameter(each, setting) for each, setting in params)


def _check_difference(recipe: Recipe, other: Recipe) -> None:
    if not difference(recipe, other):
        raise UserError("that is no difference from this lane: choose another value")
