"""What lanes are called: by what is different in them, and branches of one run by where they part."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import takewhile
from typing import Final, NamedTuple

from rl_tui.lab.run.recipe import (
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
from rl_tui.lab.timeline.run_names import ALGORITHM, distinct, feature_text, run_names

_MOST_NAMED: Final = 2
Journal = tuple[JournalEntry, ...]


class LanePast(NamedTuple):
    """What a lane is named by."""

    begun: Recipe
    """What the run was made from."""
    now: Recipe
    """The same with the settings in force."""
    branch: str
    """The name of the branch in force."""
    journal: Journal
    """All that was changed on it."""


def lane_names(lanes: Sequence[LanePast], unit: str) -> list[str]:
    """Return a name for each of ``lanes``, all of them distinct.

    Branches of one run, which began alike, are named by the branch and what was done there only:
    ``branch 2: ε 0.3 from step 400``. All others are named by :func:`run_names`. ``unit`` is what a step is
    called.
    """
    families = [_family(lane, lanes) for lane in lanes]
    heads = sorted({family[0] for family in families})
    begun = [lanes[head].begun if len(families[head]) > 1 else lanes[head].now for head in heads]
    known = dict(zip(heads, run_names(begun), strict=True))
    names = []
    for lane, family in zip(lanes, families, strict=True):
        is_branch = len(family) > 1
        parts = [] if is_branch and len(heads) == 1 else [known[family[0]]]
        if is_branch:
            journals = [lanes[number].journal for number in family]
            parts.append(branch_in_words(lane.branch, lane.journal, journals, unit))
        names.append(", ".join(parts))
    return distinct(names)


def branch_in_words(name: str, journal: Journal, beside: Iterable[Journal], unit: str) -> str:
    """Return the ``name`` of a branch and what is in its ``journal``, but for what it shares with all others.

    ``beside`` are the journals of those; ``unit`` is what a step is called.
    """
    alike = zip(journal, *beside, strict=False)
    shared = sum(1 for _ in takewhile(lambda entries: all(each == entries[0] for each in entries), alike))
    deeds = list(dict(_deed(entry, unit) for entry in journal[shared:]).values())
    if len(deeds) > _MOST_NAMED:
        deeds[_MOST_NAMED:] = [f"{len(deeds) - _MOST_NAMED} more"]
    return f"{name}: {', '.join(deeds)}" if deeds else name


def _deed(entry: JournalEntry, unit: str) -> tuple[tuple[str, int], str]:
    """Return what is one deed with others, such as a slider that was dragged, and how it is called."""
    change, step = entry.change, entry.step
    match change:
        case SetParameter(name, value):
            return (name, step), f"{feature_text(name, value)} from {unit} {step:,}"
        case SwitchAlgorithm(algorithm):
            return (ALGORITHM, step), f"{feature_text(ALGORITHM, algorithm)} from {unit} {step:,}"
        case OrderSweep():
            return ("sweeps", 0), "sweeps by hand"
        case TakeAction():
            return ("by hand", 0), f"{unit}s by hand"
        case EditWorld() | UndoEdit() | RedoEdit():
            return ("world", 0), "world drawn"


def _family(lane: LanePast, lanes: Sequence[LanePast]) -> list[int]:
    """Return the places of the branches of the run that ``lane`` is a branch of; its own where it is alone.

    Lanes that merely began alike, on branches of the same name, are no branches of one run.
    """
    family = [place for place, each in enumerate(lanes) if each.begun == lane.begun]
    names = {lanes[place].branch for place in family}
    return family if len(names) == len(family) else [lanes.index(lane)]
