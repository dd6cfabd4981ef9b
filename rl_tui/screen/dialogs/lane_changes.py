"""Differences of another run."""

from __future__ import annotations

from rl_tui.agents.catalogue import parameters_of
from rl_tui.agents.hyperparameters import PARAMETERS, why_idle
from rl_tui.common.errors import UserError
from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.recipe import Recipe, SetParameter, Setting, SwitchAlgorithm, changed_recipe
from rl_tui.runs.settings import settings_for
from rl_tui.runs.timeline.run_names import branch_in_words, difference
from rl_tui.worlds.drawing import Arms
from rl_tui.worlds.mdp.space import FiniteSpace

ALGORITHM = "algorithm"


def what_may_differ(recipe: Recipe) -> tuple[str, ...]:
    """Return ``algorithm`` and the settings that count for ``recipe``, those of schedules last."""
    names = [
        name
        for name in parameters_of(recipe.algorithm, recipe.hyperparameters.policy)
        if recipe.scenario.kind != "bandit"
        or not why_idle(name, recipe.algorithm, recipe.hyperparameters, is_bandit=True)
    ]
    return (ALGORITHM, *sorted(names, key=lambda name: PARAMETERS[name].schedule))


def lane_changes(space: FiniteSpace, recipe: Recipe, name: str, value: float | str) -> tuple[Setting, ...]:
    """Return the changes for another run of ``recipe`` with ``value`` for ``name``.

    Raises:
        UserError: The value does not work in ``space``, or makes no difference.
    """
    setting = SwitchAlgorithm(str(value)) if name == ALGORITHM else SetParameter(name, value)
    changes = settings_for(space, recipe, setting)
    if not difference(recipe, changed_recipe(recipe, *changes)):
        raise UserError("this changes nothing. Choose another value")
    return changes


def branches_beside(snapshot: Snapshot) -> dict[int, str]:
    """Return the branches that can be opened beside the run, in words."""
    timeline, is_bandit = snapshot.timeline, isinstance(snapshot.world.drawing, Arms)
    unit, here = "pull" if is_bandit else "step", timeline.current.journal
    pasts = [lane.past for lane in snapshot.run_group.lanes if lane.past is not None]
    there = [past.journal for past in pasts if past.begun == snapshot.recipe]
    return {
        number: f"{branch_in_words(branch.name, branch.journal, [here], unit)} · to {unit} {branch.end:,}"
        for number, branch in enumerate(timeline.branches)
        if number != timeline.branch and branch.journal not in there
    }
