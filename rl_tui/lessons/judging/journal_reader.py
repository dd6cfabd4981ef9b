"""Facts from a journal, read entry by entry."""

from __future__ import annotations

import hashlib
import json
from bisect import bisect_left
from collections.abc import Sequence
from operator import attrgetter

from rl_tui.runs.changes import name_and_value
from rl_tui.runs.recipe import JournalEntry, Recipe, Setting, SwitchAlgorithm, TakeAction, changed_recipe


class JournalReader:
    """Reads the changes before a step of a run."""

    def __init__(self) -> None:
        self._recipe: Recipe | None = None
        self._last: JournalEntry | None = None
        self._digest: RunDigest
        self.step = 0
        """The step that was read last."""
        self.count = 0
        """Number of entries before that step."""
        self.taken = 0
        """Number of the user's actions among them."""
        self.changes = 0
        """Settings changed after the first step."""
        self.orders = 0
        """Sweeps ordered."""
        self.start: Recipe
        """The recipe with the settings of the first step."""
        self.switch_waits = False
        """True if another algorithm is set but has taken no step."""

    def read(self, recipe: Recipe, journal: Sequence[JournalEntry], step: int, names: Sequence[str]) -> None:
        """Read a growing journal up to `step`."""
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
        """True if nothing was changed after the first step, and the user took no action."""
        return not (self.taken or self.changes or self.orders)

    @property
    def digest(self) -> str:
        """Digest at this step."""
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
    """Return the changes that affect the first `step` steps."""
    return tuple(journal[: bisect_left(journal, step, key=attrgetter("step"))])


def run_digest(recipe: Recipe, journal: Sequence[JournalEntry], step: int, names: Sequence[str]) -> str:
    """Return a digest that identifies a run after `step` steps."""
    digest = RunDigest(recipe)
    for entry in entries_before(journal, step):
        digest.add(entry, names)
    return digest.at(step)


class RunDigest:
    """Computes `run_digest` incrementally, for long journals."""

    def __init__(self, recipe: Recipe) -> None:
        document = {
            "scenario": recipe.scenario.text or recipe.scenario.id,
            "algorithm": recipe.algorithm,
            "hyperparameters": recipe.hyperparameters.as_dict(),
            "seed": recipe.seed,
        }
        self._hash = hashlib.sha256(_line(document))

    def add(self, entry: JournalEntry, names: Sequence[str]) -> None:
        """Add the next change."""
        self._hash.update(_line([entry.step, *name_and_value(entry.change, names)]))

    def at(self, step: int) -> str:
        """Return the digest after `step`, once earlier changes are added."""
        whole = self._hash.copy()
        whole.update(_line(step))
        return whole.hexdigest()


def _line(document: object) -> bytes:
    return json.dumps(document, sort_keys=True).encode() + b"\n"
