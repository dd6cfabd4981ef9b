"""What runs side by side are called: by what is different in them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Final

from rl_tui.agents.catalogue import POLICY_BY_ID, algorithm_row, parameters_of
from rl_tui.agents.hyperparameters import PARAMETERS, SAMPLE_AVERAGE, Hyperparameters
from rl_tui.lab.run.recipe import Recipe

ALGORITHM: Final = "algorithm"
_SEED: Final = "seed"
Features = Mapping[str, float | str]


def run_names(recipes: Sequence[Recipe]) -> list[str]:
    """Return a name for each of ``recipes``, all of them distinct: what is different from the first one.

    The first is named by all that any other has otherwise. Pass the settings in force.
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
    """Return in a few words what ``other`` has otherwise than ``base``: ``SARSA, α 0.5``; empty if nothing.

    Only what counts for the algorithm and policy of ``other`` is named.
    """
    features = _features(other)
    names = _different(_features(base), features, base)
    return ", ".join(feature_text(name, features[name]) for name in names)


def _different(base: Features, other: Features, known: Recipe) -> Iterator[str]:
    """Yield what ``other`` has otherwise; what does not count in ``base`` is looked up in ``known``."""
    for name, value in other.items():
        before = base[name] if name in base else known.hyperparameters.value(name)
        if value != before:
            yield name


def features_of(algorithm: str, values: Hyperparameters, seed: int) -> Features:
    """Return all that counts, by name, alike for settings that come to the same."""
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
    """Leave no more than a decay of 0 of a schedule that changes nothing."""
    decay = f"{scheduled}_decay"
    if decay in features and (features[schedule] == "constant" or features[decay] == 0.0):
        features[decay] = 0.0
        del features[schedule], features[f"{scheduled}_min"]


def feature_text(name: str, value: float | str) -> str:
    """Return in a few words that the feature ``name`` has this ``value``: ``α 0.5``."""
    if name == ALGORITHM:
        return algorithm_row(str(value)).name
    if name == "policy":
        return POLICY_BY_ID[str(value)].name
    symbol = name if name == _SEED else PARAMETERS[name].symbol
    if value == SAMPLE_AVERAGE:
        return f"{symbol} 1/N"
    return f"{symbol} {value if isinstance(value, str) else _number(value)}"


def _number(value: float) -> str:
    """Return ``value`` in short, unless that is another number."""
    short = f"{value:g}"
    text = short if float(short) == value else str(value)
    return f"−{text[1:]}" if text.startswith("-") else text


def distinct(names: Sequence[str]) -> list[str]:
    """Return ``names``, numbered where one comes again."""
    return [
        name if name not in names[:place] else f"{name} ({names[:place].count(name) + 1})"
        for place, name in enumerate(names)
    ]
