"""What a run begins with and what is changed on its way, to a document and back."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

from rl_tui.agents.catalogue import BY_ID
from rl_tui.agents.hyperparameters import PARAMETERS, Hyperparameters
from rl_tui.common.errors import UserError
from rl_tui.common.findings import near, shown
from rl_tui.lab.run.changes import read_world, written_world
from rl_tui.lab.run.recipe import (
    Change,
    EditWorld,
    JournalEntry,
    OrderSweep,
    Recipe,
    RedoEdit,
    SetParameter,
    SwitchAlgorithm,
    TakeAction,
    UndoEdit,
)
from rl_tui.lab.sessions.document import MOST_ENTRIES, Entry, StoredScenario, Value
from rl_tui.worlds.files.gymnasium_ids import PREFIX, environment_scenario
from rl_tui.worlds.files.scenario import Scenario, scenario_of


def stored_scenario(scenario: Scenario) -> dict[str, str]:
    """Return ``scenario`` as JSON. Raises UserError where its file is not known."""
    if scenario.id.startswith(PREFIX):
        return {"id": scenario.id, "kind": "gymnasium", "title": scenario.title}
    if not scenario.text:
        raise UserError(f"the file of scenario {scenario.id} is not known")
    return {"id": scenario.id, "kind": "file", "title": scenario.title, "text": scenario.text}


def stored_recipe(recipe: Recipe) -> dict[str, Any]:
    """Return ``recipe`` without its scenario as JSON."""
    return {
        "seed": recipe.seed,
        "algorithm": recipe.algorithm,
        "hyperparameters": recipe.hyperparameters.as_dict(),
    }


def stored_journal(journal: Iterable[JournalEntry]) -> list[dict[str, Any]]:
    """Return ``journal`` as JSON. Raises UserError where it is longer than what is read again."""
    stored = [_stored_entry(entry) for entry in journal]
    if len(stored) > MOST_ENTRIES:
        raise UserError(f"there are more than {MOST_ENTRIES:,} changes")
    return stored


def _stored_entry(entry: JournalEntry) -> dict[str, Any]:
    match entry.change:
        case SetParameter(name, value):
            return {"step": entry.step, "set": name, "to": value}
        case SwitchAlgorithm(algorithm):
            return {"step": entry.step, "algorithm": algorithm}
        case TakeAction(action):
            return {"step": entry.step, "take": action}
        case EditWorld() | UndoEdit() | RedoEdit():
            return {"step": entry.step, "world": written_world(entry.change)}
        case OrderSweep(phase):
            return {"step": entry.step, "sweep": phase}


# And back. ``place`` is where it stands in the document


def scenario_from(stored: StoredScenario) -> Scenario:
    """Return the scenario. Raises UserError, in one line, where it cannot be played."""
    if stored.kind == "gymnasium":
        return environment_scenario(stored.id)
    try:
        return scenario_of(stored.text, Path(f"{stored.id}.toml"), ask_environment=False)
    except UserError as fault:
        raise UserError(f"its scenario cannot be played: {str(fault).splitlines()[0]}") from fault


def recipe_from(
    scenario: Scenario, algorithm: str, settings: Mapping[str, Value], seed: int, place: str
) -> Recipe:
    """Return the recipe of these. Raises UserError where a setting does not fit."""
    _check_algorithm(algorithm, f"{place}.algorithm")
    hyperparameters = Hyperparameters()
    for name, value in settings.items():
        hyperparameters = _changed(hyperparameters, name, value, f"{place}.hyperparameters")
    return Recipe(scenario, algorithm, hyperparameters, seed)


def journal_from(stored: Iterable[Entry], place: str, end: int, latest: int = 0) -> Iterator[JournalEntry]:
    """Yield the entries of ``stored``, all of them changes that can be made; ``latest`` is the step of the
    one before them.

    Raises UserError where one cannot be made, is out of order, or comes after ``end`` steps.
    """
    _check_order(0, latest, end, place)
    for number, each in enumerate(stored):
        _check_order(latest, each.step, end, place)
        latest = each.step
        yield JournalEntry(each.step, _change(each, f"{place}.journal[{number}]"))


def _check_order(before: int, step: int, end: int, place: str) -> None:
    if not before <= step <= end:
        raise UserError(f"{place}.journal: step {step} is out of order or beyond its end")


def _change(entry: Entry, place: str) -> Change:
    kinds = ("set", "algorithm", "take", "sweep", "world")
    given = [key for key in kinds if getattr(entry, key) is not None]
    if len(given) != 1 or (entry.to is None) == (entry.set is not None):
        raise UserError(f"{place} is no change; expected set and to, algorithm, take, sweep, or world")
    if entry.set is not None and entry.to is not None:
        values = _changed(Hyperparameters(), entry.set, entry.to, place)
        return SetParameter(entry.set, values.value(entry.set))
    if entry.algorithm is not None:
        _check_algorithm(entry.algorithm, f"{place}.algorithm")
        return SwitchAlgorithm(entry.algorithm)
    if entry.sweep is not None:
        return OrderSweep(entry.sweep)
    if entry.world is not None:
        try:
            return read_world(entry.world)
        except ValueError as fault:
            raise UserError(f"{place}.world: {fault}") from fault
    return TakeAction(0 if entry.take is None else entry.take)


def _check_algorithm(algorithm: str, place: str) -> None:
    if algorithm not in BY_ID:
        raise UserError(f"{place} is {shown(algorithm)}, which is not known{near(algorithm, BY_ID)}")


def _changed(values: Hyperparameters, name: str, value: Value, place: str) -> Hyperparameters:
    if name not in PARAMETERS:
        raise UserError(f"{place}: there is no hyper-parameter {shown(name)}{near(name, PARAMETERS)}")
    try:
        return values.changed(name, value)
    except ValueError as fault:
        raise UserError(f"{place}: {fault}") from fault
