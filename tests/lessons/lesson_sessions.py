"""A lesson, and sessions of it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import Any

from rl_tui.lessons.file.setups import recipe_of
from rl_tui.lessons.file.view import Given, LessonRecord, Passed, begun
from rl_tui.lessons.judging.journal_reader import run_digest
from rl_tui.lessons.lesson import Lesson, lesson_of
from rl_tui.live.record import Record
from rl_tui.live.sessions.session import encoded
from rl_tui.runs.recipe import Change, JournalEntry, Recipe, TakeAction, begin
from rl_tui.runs.timeline.branches import Branch, RunRecord

TEXT = """
title = "An evening"
summary = "One evening, step by step."
minutes = 5
goals = ["Take a step"]

[figures]
best = { value = "0", by = "0" }

[setups.evening]
scenario = "student"
settings = { algorithm = "q-learning", alpha = 0.5, gamma = 0.9, epsilon = 0.0 }
seed = 0

[setups.lake]
scenario = "frozenlake"
seed = 0

[[pages]]
id = "start"
title = "Begin"
setup = "evening"
text = "An evening."

[[pages]]
id = "guess"
title = "Guess"
prediction = { ask = "What will it be?", answer = -1.5, tolerance = 0.005, steps = 1 }

[[pages]]
id = "quiz"
title = "Quiz"
[pages.question]
ask = "Which?"
choices = [{ text = "this", reply = "No." }, { text = "that", reply = "Yes.", right = true }]

[[pages]]
id = "go"
title = "Go by yourself"
[pages.task]
do = "Take two steps with α at least 0.3."
conditions = [
  { text = "two steps by hand", measure = "taken", equals = 2 },
  { text = "two steps in all", measure = "steps", equals = 2 },
  { text = "α is large", measure = "alpha", at_least = 0.3 },
]

[[pages]]
id = "never"
title = "Earn more than there is"
[pages.task]
do = "Earn a million."
conditions = [{ text = "a million", measure = "expected_return", at_least = 1_000_000 }]
proof = { condition = 0, best = "best" }

[[pages]]
id = "lake"
title = "On the lake"
setup = "lake"
[pages.task]
do = "Take fifty steps."
conditions = [{ text = "fifty steps", measure = "steps", at_least = 50 }]
"""


def lesson(source: str = "evening.toml", text: str = TEXT) -> Lesson:
    return lesson_of(text, Path(source))


def setup(of: Lesson, name: str = "evening", **settings: Any) -> Recipe:
    recipe = recipe_of(of, name)
    for setting, value in settings.items():
        recipe = replace(recipe, hyperparameters=recipe.hyperparameters.changed(setting, value))
    return recipe


def taken(*steps: int) -> tuple[JournalEntry, ...]:
    return entries(*((step, TakeAction(0)) for step in steps))


def entries(*changes: tuple[int, Change]) -> tuple[JournalEntry, ...]:
    return tuple(JournalEntry(step, change) for step, change in changes)


def run_of(recipe: Recipe, end: int = 0, journal: Iterable[JournalEntry] = ()) -> RunRecord:
    return RunRecord(recipe, (Branch("branch 1", tuple(journal), None, 0, end, end),))


def digest_at(recipe: Recipe, step: int = 0, journal: tuple[JournalEntry, ...] = ()) -> str:
    return run_digest(recipe, journal, step, begin(recipe).world.space.action_names)


def guess(of: Lesson, answer: float = -1.5, step: int = 0, **how: Any) -> Given:
    """An answer to the prediction at step 0 of a run, unless ``how`` differs."""
    return Given("guess", answer, abs(answer + 1.5) < 0.01, step, digest_at(setup(of), step, **how))


def all_done(of: Lesson) -> LessonRecord:
    return replace(
        begun(of).open("lake"),
        given=(guess(of), Given("quiz", 0, False), Given("quiz", 1, True)),
        passed=(
            Passed("go", setup(of), taken(0, 1), 2),
            Passed("never", setup(of), claim=True),
            Passed("lake", setup(of, "lake"), (), 60),
        ),
        skipped=("start",),
        hints=(("go", 2),),
        finished=True,
    )


def record(taking: LessonRecord | None, *runs: RunRecord) -> Record:
    of = lesson() if taking is None else taking.lesson
    return Record(runs or (run_of(setup(of)),), speed=10.0, lesson=taking)


def write(folder: Path, name: str, taking: LessonRecord | None, *runs: RunRecord) -> Path:
    path = folder / name
    path.write_bytes(encoded(record(taking, *runs)))
    return path
