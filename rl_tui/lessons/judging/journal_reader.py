"""What a journal says of how a run was made, read entry by entry."""

from __future__ import annotations

import hashlib
import json
from bisect import bisect_left
from collections.abc import Sequence
from operator import attrgetter

from rl_tui.runs.changes import name_and_value
from rl_tui.runs.recipe import JournalEntry, Recipe, Setting, SwitchAlgorithm, TakeAction, changed_recipe


class JournalReader:
    """Reads what was changed before a step of a run: whatever is later, or still waits, does not count.

    What was read is kept, so that of a journal that grows only what is new is gone through.
    """

    def __init__(self) -> None:
        self._recipe: Recipe | None = None
        self._last: JournalEntry | None = None
        self._digest: RunDigest
        self.step = 0
        """The step that was read last."""
        self.count = 0
        """How many entries the journal has before it."""
        self.taken = 0
        """How many steps of them a person took."""
        self.changes = 0
        """How many settings were changed after the first step."""
        self.orders = 0
        """How many sweeps were ordered."""
        self.start: Recipe
        """The recipe with the settings of the first step."""
        self.switch_waits = False
        """Whether another algorithm is set that has taken no step yet."""

    def read(self, recipe: Recipe, journal: Sequence[JournalEntry], step: int, names: Sequence[str]) -> None:
        """Take in the entries of ``journal`` before ``step``; ``names`` are the actions'."""
        count = bisect_left(journal, step, key=attrgetter("step"))
        goes_on = recipe is self._recipe and self.count <= count
        if not goes_on or (self.count and journal[self.count - 1] is not self._last):
            self._begin(recipe)
        for entry in journal[self.count : count]:
            self._take_in(entry, names)
        self.step = step
        self.switch_waits = any(isinstance(entry.change, SwitchAlgorithm) for entry in journal[count:])

    @property
    def is_as_begun(self) -> bool:
        """Whether nothing was done after the first step, and no step was taken by a person."""
        return not (self.taken or self.changes or self.orders)

    @property
    def digest(self) -> str:
        """That of the run as it stood at the step."""
        return self._digest.at(self.step)

    def _begin(self, recipe: Recipe) -> None:
        self._recipe, self._last, self._digest = recipe, None, RunDigest(recipe)
        self.start, self.count = recipe, 0
        self.taken, self.changes, self.orders = 0, 0, 0

    def _take_in(self, entry: JournalEntry, names: Sequence[str]) -> None:
        change = entry.change
        if isinstance(change, TakeAction):
            self.taken += 1
        elif not isinstance(change, Setting):
            self.orders += 1
        elif entry.step:
            self.changes += 1
        else:
            self.start = changed_recipe(self.start, change)
        self._digest.add(entry, names)
        self._last, self.count = entry, self.count + 1


def entries_before(journal: Sequence[JournalEntry], step: int) -> tuple[JournalEntry, ...]:
    """Return the changes with which the first ``step`` steps were taken."""
    return tuple(journal[: bisect_left(journal, step, key=attrgetter("step"))])


def run_digest(recipe: Recipe, journal: Sequence[JournalEntry], step: int, names: Sequence[str]) -> str:
    """Return what tells a run as it stood after ``step`` steps from any other; ``names`` are its actions'."""
    digest = RunDigest(recipe)
    for entry in entries_before(journal, step):
        digest.add(entry, names)
    return digest.at(step)


class RunDigest:
    """Works out :func:`run_digest` entry by entry, so that a long journal is gone through once."""

    def __init__(self, recipe: Recipe) -> None:
        document = {
            "scenario": recipe.scenario.text or recipe.scenario.id,
            "algorithm": recipe.algorithm,
            "hyperparameters": recipe.hyperparameters.as_dict(),
            "seed": recipe.seed,
        }
        self._hash = hashlib.sha256(_line(document))

    def add(self, entry: JournalEntry, names: Sequence[str]) -> None:
        """Take in the next change; ``names`` are the actions'."""
        self._hash.update(_line([entry.step, *name_and_value(entry.change, names)]))

    def at(self, step: int) -> str:
        """Return the digest after ``step`` steps, all changes before that taken in."""
        whole = self._hash.copy()
        whole.update(_line(step))
        return whole.hexdigest()


def _line(document: object) -> bytes:
    return json.dumps(document, sort_keys=True).encode() + b"\n"
