"""Small lessons with tasks, and measures of runs."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from rl_tui.lessons.file.schema import Attempt, Condition
from rl_tui.lessons.judging.measures import MEASURES, MissingError, Value
from rl_tui.lessons.judging.moment import JudgedMoment, Kept
from rl_tui.lessons.lesson import Lesson, lesson_of
from rl_tui.runs.library import find, recipe_for
from rl_tui.runs.recipe import Recipe
from rl_tui.runs.run import Run

HEAD = 'title = "t"\nsummary = "s"\nminutes = 3\ngoals = ["g"]\n'


def inline(table: dict[str, Any]) -> str:
    return "{ " + ", ".join(f"{key} = {_value(value)}" for key, value in table.items()) + " }"


def _value(value: Any) -> str:
    if isinstance(value, dict):
        return inline(value)
    if isinstance(value, list):
        return "[" + ", ".join(map(_value, value)) + "]"
    if isinstance(value, bool):
        return str(value).lower()
    return repr(value) if not isinstance(value, str) else '"' + value + '"'


def task_text(*conditions: dict[str, Any], scenario: str = "student", more: str = "", **settings: Any) -> str:
    rows = ", ".join(inline({"text": "c", **each}) for each in conditions)
    setup = f'[setups.run]\nscenario = "{scenario}"\nsettings = {inline(settings)}\n'
    page = f'[[pages]]\nid = "only"\ntitle = "P"\n[pages.task]\ndo = "d"\nconditions = [{rows}]\n'
    return HEAD + setup + page + more


def lesson_with(*conditions: dict[str, Any], **others: Any) -> Lesson:
    return lesson_of(task_text(*conditions, **others), Path("sample.toml"))


def attempt(**fields: Any) -> Attempt:
    return Attempt.model_validate({"name": "a", **fields})


def recipe_in(scenario: str, seed: int = 0, **settings: Any) -> Recipe:
    return recipe_for(find(scenario), settings, seed)


def condition(measure: str, **fields: Any) -> Condition:
    return Condition.model_validate({"text": "c", "measure": measure, "equals": 0.0, **fields})


def measured(run: Run, measure: str, kept: Kept | None = None, **arguments: Any) -> Value | None:
    moment = JudgedMoment(run, run.recipe, kept or Kept())
    try:
        return MEASURES[measure].of(moment, condition(measure, **arguments))
    except MissingError:
        return None
