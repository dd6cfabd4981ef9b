"""What determines a run, and the list of what was changed on the way."""

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
"""More steps or episodes than any run comes to."""
SEED_DRAWS_WORLD: Final = "another seed draws another world here; r n starts again in that one"
_MOST_TOLD: Final = 20


@dataclass(frozen=True, slots=True)
class Recipe:
    """How a run starts: the same recipe and journal give the same bits. ``seed`` is an integer, 0 or more."""

    scenario: Scenario
    algorithm: str = "q-learning"
    hyperparameters: Hyperparameters = field(default_factory=Hyperparameters)
    seed: int = 0


class Beginning(NamedTuple):
    """A recipe's world and the streams it was drawn from, which the run goes on with."""

    world: World
    streams: Streams


def begin(recipe: Recipe, known: World | None = None) -> Beginning:
    """Build the world of ``recipe``; ``known`` is a world to take instead where the seed does not shape it.

    Raises UserError where the world cannot be built.
    """
    drawn = streams(recipe.seed)
    if known is not None and not recipe.scenario.section.drawn_from_seed:
        return Beginning(known, drawn)
    return Beginning(recipe.scenario.build(drawn.world), drawn)


@dataclass(frozen=True, slots=True)
class SetParameter:
    """A hyper-parameter is set to a value from here on."""

    name: str
    value: float | str


@dataclass(frozen=True, slots=True)
class SwitchAlgorithm:
    """Another algorithm takes over, keeping Q and visits."""

    algorithm: str


@dataclass(frozen=True, slots=True)
class TakeAction:
    """A person takes the next step in place of the agent, with this action.

    It is the name of one, or its number where the names are not known yet.
    """

    action: int | str


@dataclass(frozen=True, slots=True)
class OrderSweep:
    """The next sweep of a planner evaluates its policy, or improves it, whatever is due by itself."""

    phase: SweepPhase


@dataclass(frozen=True, slots=True)
class EditWorld:
    """The world is another one from here on: these ``edits`` are made in it, all at once."""

    edits: tuple[Edit, ...]


@dataclass(frozen=True, slots=True)
class UndoEdit:
    """The world is again what it was before the last edit that is not undone."""


@dataclass(frozen=True, slots=True)
class RedoEdit:
    """The world is again what it was before the last edit was undone."""


Setting = SetParameter | SwitchAlgorithm
WorldChange = EditWorld | UndoEdit | RedoEdit
Change = Setting | TakeAction | OrderSweep | WorldChange


@dataclass(frozen=True, slots=True)
class JournalEntry:
    """``change`` applies after ``step`` steps, before the next one; entries of one step apply in order."""

    step: int
    change: Change


def action_called(name: str, action_names: Sequence[str]) -> int | None:
    """Return the number of the action of that name, to which spaces may belong; None where there is none."""
    for wanted in (name, name.strip()):
        if wanted in action_names:
            return action_names.index(wanted)
    return None


def no_such_action(name: str, action_names: Sequence[str]) -> str:
    """Return that none is called so, and which there are."""
    known = ", ".join(action_names[:_MOST_TOLD]) + (", …" if len(action_names) > _MOST_TOLD else "")
    return f"there is no such action{near(name.strip(), action_names)}; take one of {known}"


def changed_recipe(recipe: Recipe, *changes: Setting) -> Recipe:
    """Return ``recipe`` with ``changes`` from the start. Raises UserError where a value does not fit."""
    for change in changes:
        if isinstance(change, SwitchAlgorithm):
            recipe = replace(recipe, algorithm=change.algorithm)
        else:
            values = changed_parameter(recipe.hyperparameters, change.name, change.value)
            recipe = replace(recipe, hyperparameters=values)
    return recipe


def changed_parameter(values: Hyperparameters, name: str, value: object) -> Hyperparameters:
    """Return ``values`` with another ``value`` of ``name``.

    Raises UserError, with the range, if the value does not fit.
    """
    try:
        return values.changed(name, value)
    except ValueError as fault:
        raise UserError(str(fault)) from fault
