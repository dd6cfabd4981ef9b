"""The command line that reproduces a run."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Final

from rl_tui.agents.hyperparameters import PARAMETERS
from rl_tui.common.errors import UserError
from rl_tui.common.findings import command_line
from rl_tui.common.text_file import UnreadableError, read_text
from rl_tui.runs.changes import written_change, written_value
from rl_tui.runs.library import recipe_for, without_effect
from rl_tui.runs.recipe import JournalEntry, OrderSweep, Recipe, SetParameter, SwitchAlgorithm, TakeAction
from rl_tui.worlds.files import catalogue
from rl_tui.worlds.files.scenario import PREFIX, Scenario
from rl_tui.worlds.gym.modules import OPTION, module_of

_REPLAY: Final = "rl-tui replay SESSION.json"
MOST_CHANGES: Final = 200
LONGEST_LINE: Final = 100_000
"""Longest command in bytes. Some systems limit a word to 131,072."""


def recipe_line(
    recipe: Recipe, journal: Sequence[JournalEntry], step: int, action_names: Sequence[str]
) -> str:
    """Write the `rl-tui train` command that repeats a run up to `step`, quoted for a shell.

    Step 0 trains as long as the scenario says. Raises UserError if the journal is too long for a line, or no
    file holds the scenario.
    """
    entries = _without_passing(entries_until(journal, step))
    if len(entries) > MOST_CHANGES:
        raise UserError(
            f"{len(entries):,} changes are too many for one line: save the session with m s, then "
            f"{_REPLAY} repeats the run"
        )
    words = [
        "rl-tui",
        "train",
        scenario_name(recipe.scenario),
        *allowance(recipe.scenario),
        *_settings(recipe, entries),
        "--seed",
        str(recipe.seed),
    ]
    if step > 0:
        words += ["--steps", str(step)]
    for entry in entries:
        words += ["--change", written_change(entry, action_names)]
    line = command_line(words)
    if len(line.encode()) > LONGEST_LINE:
        raise UserError(
            f"the edits are too long for one line: save the session with m s, then {_REPLAY} repeats the run"
        )
    return line


def entries_until(journal: Sequence[JournalEntry], step: int) -> list[JournalEntry]:
    """Return the entries that apply at `step`, without its actions."""
    return [
        entry
        for entry in journal
        if entry.step < step or (entry.step == step and not isinstance(entry.change, TakeAction))
    ]


def _without_passing(entries: Sequence[JournalEntry]) -> list[JournalEntry]:
    """Drop settings that the next entry overwrites, as a slider does."""
    kept: list[JournalEntry] = []
    for entry in entries:
        if kept and _is_taken_back(kept[-1], entry):
            kept.pop()
        kept.append(entry)
    return kept


def _is_taken_back(entry: JournalEntry, after: JournalEntry) -> bool:
    one, other = entry.change, after.change
    if entry.step != after.step:
        return False
    if isinstance(one, OrderSweep) and isinstance(other, OrderSweep):
        return True  # only the last order counts
    if not (isinstance(one, SetParameter) and isinstance(other, SetParameter)):
        return False
    return one.name == other.name != "policy"


def scenario_name(scenario: Scenario) -> str:
    """Return the id of `scenario` if that finds the same text, else its file."""
    if scenario.id.startswith(PREFIX):
        return scenario.id
    try:
        found = catalogue.find(scenario.id)
    except UserError:
        found = None
    if found is not None and found.text == scenario.text:
        return scenario.id
    if _holds(scenario.source, scenario.text):
        return str(scenario.source)
    raise UserError(
        f"{scenario.source} no longer contains this scenario: save the session with m s, then "
        f"{_REPLAY} repeats the run"
    )


def allowance(scenario: Scenario) -> list[str]:
    """Return the option that allows its environment, if any."""
    from rl_tui.worlds.gym.section import GymnasiumSection

    section = scenario.section
    module = module_of(section.id) if isinstance(section, GymnasiumSection) else ""
    return [OPTION, module] if module else []


def _holds(file: Path, text: str) -> bool:
    try:
        return read_text(file) == text
    except UnreadableError:
        return False


def _settings(recipe: Recipe, entries: Sequence[JournalEntry]) -> list[str]:
    """Return the options that differ and have an effect, or may have one later."""
    usual = recipe_for(recipe.scenario)
    idle = [] if any(map(_brings_others, entries)) else without_effect(recipe, PARAMETERS)
    options = [] if recipe.algorithm == usual.algorithm else ["--algorithm", recipe.algorithm]
    for name in PARAMETERS:
        value = recipe.hyperparameters.value(name)
        if value != usual.hyperparameters.value(name) and name not in idle:
            options += [f"--{name.replace('_', '-')}", written_value(value)]
    return options


def _brings_others(entry: JournalEntry) -> bool:
    change = entry.change
    return isinstance(change, SwitchAlgorithm) or (
        isinstance(change, SetParameter) and change.name == "policy"
    )
