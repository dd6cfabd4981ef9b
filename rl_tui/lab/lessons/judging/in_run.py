"""What a run came to at the step where the truth of a prediction is due, to stand beside the answer."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

from rl_tui.common.errors import UserError
from rl_tui.lab.lessons.judging.journal_reader import entries_before
from rl_tui.lab.lessons.judging.measures import MEASURES, MissingError, NotYetError, Value
from rl_tui.lab.lessons.record import NO_STEP, Given, LessonRecord
from rl_tui.lab.lessons.setups import recipe_of

if TYPE_CHECKING:
    from rl_tui.lab.lessons.judging.moment import Kept
    from rl_tui.lab.lessons.schema import Measured
    from rl_tui.lab.run.recipe import JournalEntry, Recipe
    from rl_tui.lab.run.run import Run

FARTHEST: Final = 20_000
"""A run that has gone past a step beyond this one is not replayed to it."""


class _Known(NamedTuple):
    given: Given
    recipe: Recipe
    journal: tuple[JournalEntry, ...]
    value: Value | None


class InRun:
    """Measures it at that very step: of the run where it stands there, else of a replay of its branch.

    What was measured is kept while the run stands earlier on, until it comes there by another way.
    """

    def __init__(self) -> None:
        self._known: _Known | None = None

    def of(self, record: LessonRecord, run: Run, kept: Kept) -> Value | None:
        """Return the measure, in words why it has no value, or None: not due, not known, none asked for."""
        ask, given = record.lesson.page(record.page).prediction, record.given_on(record.page)
        if ask is None or ask.shows is None or given is None or given.step == NO_STEP:
            return None
        known, due = self._known, given.step + ask.steps
        is_same = known is not None and known.given == given and known.recipe is run.recipe
        if run.step < due:
            return known.value if known is not None and is_same else None
        entries = entries_before(run.journal, due)
        if known is not None and is_same and known.journal == entries:
            return known.value
        try:
            setup = recipe_of(record.lesson, record.lesson.setup_of(record.page))
            value = _measured(ask.shows, run, setup, entries, due, kept)
        except NotYetError:
            return None
        except UserError as reason:
            value = str(reason)
        self._known = _Known(given, run.recipe, entries, value)
        return value


def _measured(
    shows: Measured, run: Run, setup: Recipe, entries: tuple[JournalEntry, ...], due: int, kept: Kept
) -> Value | None:
    from rl_tui.lab.lessons.judging.moment import JudgedMoment, Kept
    from rl_tui.lab.run.run import Run

    if run.step > due:
        if due > FARTHEST:
            return None
        earlier = Run(run.recipe, evaluate=False)
        earlier.follow(entries, due)
        run, kept = earlier, Kept()
    try:
        return MEASURES[shows.measure].of(JudgedMoment(run, setup, kept), shows)
    except MissingError as reason:
        return str(reason)
