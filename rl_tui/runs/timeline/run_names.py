"""Names of runs shown together, made from their differences."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import takewhile
from typing import Final, NamedTuple

from rl_tui.agents.catalogue import POLICY_BY_ID, algorithm_row, parameters_of
from rl_tui.agents.hyperparameters import PARAMETERS, SAMPLE_AVERAGE, Hyperparameters
from rl_tui.runs.recipe import (
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

# Names by settings


ALGORITHM: Final = "algorithm"
_SEED: Final = "seed"
Features = Mapping[str, float | str]


def run_names(recipes: Sequence[Recipe]) -> list[str]:
    """Return distinct names for `recipes`: their differences from the first.

    The first is named by everything that differs in another.
    """
    if not recipes:
        return []
    base, *others = (_features(recipe) for recipe in recipes)
    differing = {name for other in others for name in _different(base, other, recipes[0])}
    contrast = [feature_text(name, value) for name, value in base.items() if name in differing]
    names = [", ".join(contrast), *(difference(recipes[0], other) for other in recipes[1:])]
    return distinct(
        [name or algorithm_row(each.algorithm).name for name, each in zip(names, recipes, strict=True)]
    )


def difference(base: Recipe, other: Recipe) -> str:
    """Describe how `other` differs from `base`, such as `SARSA, α 0.5`."""
    features = _features(other)
    names = _different(_features(base), features, base)
    return ", ".join(feature_text(name, features[name]) for name in names)


def _different(base: Features, other: Features, known: Recipe) -> Iterator[str]:
    """Yield the names of different settings, with values without effect from `known`."""
    for name, value in other.items():
        before = base[name] if name in base else known.hyperparameters.value(name)
        if value != before:
            yield name


def features_of(algorithm: str, values: Hyperparameters, seed: int) -> Features:
    """Return all settings with an effect. Equivalent ones give equal results."""
    features: dict[str, float | str] = {ALGORITHM: algorithm}
    for name in parameters_of(algorithm, values.policy):
        features[name] = values.value(name)
    if values.sample_average and "alpha" in features:
        features["alpha"] = SAMPLE_AVERAGE
        for name in ("step_size_schedule", "alpha_min", "alpha_decay"):
            del features[name]
    _without_idle_schedule(features, "step_size_schedule", "alpha")
    _without_idle_schedule(features, "epsilon_schedule", "epsilon")
    features[_SEED] = seed
    return features


def _features(recipe: Recipe) -> Features:
    return features_of(recipe.algorithm, recipe.hyperparameters, recipe.seed)


def _without_idle_schedule(features: dict[str, float | str], schedule: str, scheduled: str) -> None:
    decay = f"{scheduled}_decay"
    if decay in features and (features[schedule] == "constant" or features[decay] == 0.0):
        features[decay] = 0.0
        del features[schedule], features[f"{scheduled}_min"]


def feature_text(name: str, value: float | str) -> str:
    """Describe a setting in a few words, such as `α 0.5`."""
    if name == ALGORITHM:
        return algorithm_row(str(value)).name
    if name == "policy":
        return POLICY_BY_ID[str(value)].name
    symbol = name if name == _SEED else PARAMETERS[name].symbol
    if value == SAMPLE_AVERAGE:
        return f"{symbol} 1/N"
    return f"{symbol} {value if isinstance(value, str) else _number(value)}"


def _number(value: float) -> str:
    short = f"{value:g}"
    text = short if float(short) == value else str(value)
    return f"−{text[1:]}" if text.startswith("-") else text


def distinct(names: Sequence[str]) -> list[str]:
    """Add numbers to repeated names."""
    return [
        name if name not in names[:place] else f"{name} ({names[:place].count(name) + 1})"
        for place, name in enumerate(names)
    ]


# Names of branches


_MOST_NAMED: Final = 2
Journal = tuple[JournalEntry, ...]


class LanePast(NamedTuple):
    """The facts that name a run."""

    begun: Recipe
    """Start of the run."""
    now: Recipe
    """The recipe with current settings."""
    branch: str
    journal: Journal
    """All changes on the branch."""


def lane_names(lanes: Sequence[LanePast], unit: str) -> list[str]:
    """Return distinct names for runs, branches like `branch 2: ε 0.3 from step 400`."""
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
    """Name a branch by the changes not shared with all branches `beside` it."""
    alike = zip(journal, *beside, strict=False)
    shared = sum(1 for _ in takewhile(lambda entries: all(each == entries[0] for each in entries), alike))
    deeds = list(dict(_deed(entry, unit) for entry in journal[shared:]).values())
    if len(deeds) > _MOST_NAMED:
        deeds[_MOST_NAMED:] = [f"{len(deeds) - _MOST_NAMED} more"]
    return f"{name}: {', '.join(deeds)}" if deeds else name


def _deed(entry: JournalEntry, unit: str) -> tuple[tuple[str, int], str]:
    """Return a description and a key that groups related changes, such as those of a slider."""
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
    family = [place for place, each in enumerate(lanes) if each.begun == lane.begun]
    names = {lanes[place].branch for place in family}
    return family if len(names) == len(family) else [lanes.index(lane)]
