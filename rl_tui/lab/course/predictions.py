"""The predictions in a session: how many were right, and how many were made before the run moved."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Final, NamedTuple

from rl_tui.lab.lessons.judging.conditions import elsewhere
from rl_tui.lab.lessons.judging.journal_reader import RunDigest
from rl_tui.lab.lessons.record import Given, LessonRecord
from rl_tui.lab.lessons.setups import recipe_of
from rl_tui.lab.run.recipe import JournalEntry, Recipe, TakeAction, begin

if TYPE_CHECKING:
    from rl_tui.lab.lessons.lesson import Lesson
    from rl_tui.lab.live.record import Record

_MOST_ENTRIES: Final = 1_000_000
"""Changes that are gone through, of all runs; what is locked with later ones stays unknown."""


class PredictionScore(NamedTuple):
    """Of the ``made`` ones, how many were ``right``, and how many are ``locked``: given at a step to which a
    run in the session came, or which its setup begins with, all that was changed before included.
    """

    right: int = 0
    made: int = 0
    locked: int = 0


NO_PREDICTIONS: Final = PredictionScore()


class _Known(NamedTuple):
    """A run of the session, which came to ``end``."""

    recipe: Recipe
    journal: Sequence[JournalEntry]
    end: int


def predictions_in(taken: LessonRecord, lesson: Lesson, record: Record) -> PredictionScore:
    """Return the predictions of ``taken``, of which ``record`` has the runs.

    What is right is what ``lesson`` says. Of each page the first answer counts. Raises UserError where a
    setup cannot be played.
    """
    asked = {page.id: page.prediction for page in lesson.counted_predictions if page.prediction is not None}
    made = [given for page in asked if (given := taken.given_on(page)) is not None]
    right = sum(asked[given.page].is_right(given.answer) for given in made)
    known = [_Known(each.recipe, each.journal, each.step) for each in taken.passed]
    known += [
        _Known(lane.recipe, branch.journal, branch.end) for lane in record.lanes for branch in lane.branches
    ]
    setups = dict.fromkeys(lesson.setup_of(given.page) for given in made)
    locked = sum(
        _locked(lesson, setup, [given for given in made if lesson.setup_of(given.page) == setup], known)
        for setup in setups
    )
    return PredictionScore(right, len(made), locked)


def _locked(lesson: Lesson, setup: str, made: Sequence[Given], known: Sequence[_Known]) -> int:
    """Return how many of ``made``, all of one setup, were given where one of its runs has been."""
    begins = recipe_of(lesson, setup)
    names = begin(begins).world.space.action_names
    steps = sorted({given.step for given in made if given.step >= 0})
    found = set(_digests(_Known(begins, (), max(steps, default=0)), steps, names))
    entries = 0
    for run in known:
        entries += len(run.journal)
        if entries <= _MOST_ENTRIES and not elsewhere(begins, run.recipe) and _is_possible(run, names):
            found.update(_digests(run, steps, names))
    return sum((given.step, given.digest) in found for given in made)


def _is_possible(run: _Known, names: Sequence[str]) -> bool:
    """Return whether every action that a person took is there at all."""
    taken = (entry.change.action for entry in run.journal if isinstance(entry.change, TakeAction))
    return all(action in names if isinstance(action, str) else action < len(names) for action in taken)


def _digests(run: _Known, steps: Sequence[int], names: Sequence[str]) -> Iterator[tuple[int, str]]:
    """Yield the digests of ``run`` at those of ``steps``, ascending, to which it came."""
    digest, place = RunDigest(run.recipe), 0
    for step in steps:
        if step > run.end:
            return
        while place < len(run.journal) and run.journal[place].step < step:
            digest.add(run.journal[place], names)
            place += 1
        yield step, digest.at(step)
