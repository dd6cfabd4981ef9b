"""Recipe and journal, which determine a run."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Final, NamedTuple

from rl_tui.agents.catalogue import SweepPhase
from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.common.errors import UserError
from rl_tui.common.findings import near
from rl_tui.common.streams import Streams, streams
from rl_tui.worlds.editing.edit import Edit
from rl_tui.worlds.files.scenario import Scenario
from rl_tui.worlds.world import World

UNLIMITED: Final = 2**62
"""More steps or episodes than any run can have."""
SEED_DRAWS_WORLD: Final = "each seed has its own world here; r n starts again with a new seed and world"
_MOST_TOLD: Final = 20


@dataclass(frozen=True, slots=True)
class Recipe:
    """The start of a run. The same recipe and journal give the same bits."""

    scenario: Scenario
    algorithm: str = "q-learning"
    hyperparameters: Hyperparameters = field(default_factory=Hyperparameters)
    seed: int = 0


class Beginning(NamedTuple):
    """A new world, and the random streams after building it."""

    world: World
    streams: Streams


def begin(recipe: Recipe, known: World | None = None) -> Beginning:
    """Build the world of `recipe`, or reuse `known` if the seed does not matter. Raises UserError."""
    drawn = streams(recipe.seed)
    if known is not None and not recipe.scenario.section.drawn_from_seed:
        return Beginning(known, drawn)
    return Beginning(recipe.scenario.build(drawn.world), drawn)


@dataclass(frozen=True, slots=True)
class SetParameter:
    """Set a hyperparameter."""

    name: str
    value: float | str


@dataclass(frozen=True, slots=True)
class SwitchAlgorithm:
    """Switch to another algorithm, keeping Q and visits."""

    algorithm: str


@dataclass(frozen=True, slots=True)
class TakeAction:
    """A step with the user's action, by number, or by name if the world may have changed."""

    action: int | str


@dataclass(frozen=True, slots=True)
class OrderSweep:
    """Order a planner's next sweep: evaluation or improvement."""

    phase: SweepPhase


@dataclass(frozen=True, slots=True)
class EditWorld:
    """Apply `edits` to the world at once."""

    edits: tuple[Edit, ...]


@dataclass(frozen=True, slots=True)
class UndoEdit:
    """Undo the last edit of the world."""


@dataclass(frozen=True, slots=True)
class RedoEdit:
    """Redo the edit that was last undone."""


Setting = SetParameter | SwitchAlgorithm
WorldChange = EditWorld | UndoEdit | RedoEdit
Change = Setting | TakeAction | OrderSweep | WorldChange


@dataclass(frozen=True, slots=True)
class JournalEntry:
    """A `change` made after `step` steps. Entries of one step apply in order."""

    step: int
    change: Change


def action_called(name: str, action_names: Sequence[str]) -> int | None:
    """Return the number of an action, or None. Spaces matter only if names differ by them."""
    for wanted in (name, name.strip()):
        if wanted in action_names:
            return action_names.index(wanted)
    without = [each.replace(" ", "") for each in action_names]
    wanted = name.replace(" ", "")
    return without.index(wanted) if without.count(wanted) == 1 else None


def no_such_action(name: str, action_names: Sequence[str]) -> str:
    """Return a message with the available actions."""
    known = ", ".join(action_names[:_MOST_TOLD]) + (", …" if len(action_names) > _MOST_TOLD else "")
    return f"there is no such action{near(name.strip(), action_names)}; take one of {known}"


def changed_recipe(recipe: Recipe, *changes: Setting) -> Recipe:
    """Return `recipe` with `changes` to its start. Raises UserError."""
    for change in changes:
        if isinstance(change, SwitchAlgorithm):
            recipe = replace(recipe, algorithm=change.algorithm)
        else:
            values = changed_parameter(recipe.hyperparameters, change.name, change.value)
            recipe = replace(recipe, hyperparameters=values)
    return recipe


def changed_parameter(values: Hyperparameters, name: str, value: object) -> Hyperparameters:
    """Return `values` with another `value` of `name`. Raises UserError."""
    try:
        return values.changed(name, value)
    except ValueError as fault:
        raise UserError(str(fault)) from fault
