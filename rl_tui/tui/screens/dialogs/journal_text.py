"""The journal of a branch in words: which setting was changed when, and which steps were taken by hand."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby

from rl_tui.agents.catalogue import BY_ID, POLICY_BY_ID
from rl_tui.agents.hyperparameters import PARAMETERS
from rl_tui.lab.run.recipe import JournalEntry, Recipe, SetParameter, SwitchAlgorithm, TakeAction
from rl_tui.tui.draw.names import action_name
from rl_tui.tui.panels.controls.settings import option_text
from rl_tui.tui.theme.glyphs import Glyphs
from rl_tui.worlds.world import World


@dataclass(frozen=True, slots=True)
class JournalLine:
    """What was done after ``step`` steps; ``by_hand`` counts steps of a person, up to step ``last``."""

    step: int
    last: int
    what: str
    by_hand: int = 0

    @property
    def text(self) -> str:
        """The line: ``step 1,200: α 0.1 → 0.5``, ``steps 3,400–3,460: 61 by hand``."""
        first = self.step + bool(self.by_hand)  # a setting applies after its step, a person takes the next
        when = f"step {first:,}" if self.last <= first else f"steps {first:,}–{self.last:,}"
        return f"{when}: {self.what}"


def journal_lines(
    journal: Sequence[JournalEntry], recipe: Recipe, world: World, glyphs: Glyphs
) -> list[JournalLine]:
    """Return ``journal`` in lines: one a setting and step, one for steps by hand in a row."""
    lines: list[JournalLine] = []
    before = _Before(recipe)
    for (kind, _), group in groupby(_keyed(journal), key=lambda each: each[0]):
        entries = [entry for _, entry in group]
        first, last = entries[0], entries[-1]
        if isinstance(first.change, TakeAction):
            what = f"{len(entries)} by hand"
            if len(entries) == 1:
                what = f"by hand {action_name(world, first.change.action, glyphs)}"
            lines.append(JournalLine(first.step, last.step + 1, what, len(entries)))
        else:
            was, is_now = before.change(last.change)
            lines.append(JournalLine(first.step, first.step, f"{kind} {was} → {is_now}".strip()))
    return lines


def _keyed(journal: Sequence[JournalEntry]) -> Iterator[tuple[tuple[str, int], JournalEntry]]:
    """Yield each entry with what makes it one line with its neighbours: kind, and where the line began."""
    began, previous = 0, None
    for entry in journal:
        change = entry.change
        if isinstance(change, TakeAction):
            follows = previous is not None and isinstance(previous.change, TakeAction)
            if not follows or previous is None or entry.step != previous.step + 1:
                began = entry.step
            yield ("by hand", began), entry
        elif isinstance(change, SetParameter):
            yield (PARAMETERS[change.name].symbol, entry.step), entry
        else:
            yield ("", entry.step), entry
        previous = entry


class _Before:
    """What was in force before each change, from the recipe on."""

    def __init__(self, recipe: Recipe) -> None:
        self._algorithm = recipe.algorithm
        self._values = recipe.hyperparameters

    def change(self, change: SetParameter | SwitchAlgorithm | TakeAction) -> tuple[str, str]:
        """Return how what is changed was called before, and is called from there on."""
        if isinstance(change, SwitchAlgorithm):
            was, self._algorithm = self._algorithm, change.algorithm
            return BY_ID[was].name, BY_ID[change.algorithm].name
        if isinstance(change, SetParameter):
            before = self._values.value(change.name)
            self._values = self._values.changed(change.name, change.value)
            return _called(change.name, before), _called(change.name, change.value)
        return "", ""


def _called(name: str, value: float | str) -> str:
    return POLICY_BY_ID[str(value)].name if name == "policy" else option_text(value)
