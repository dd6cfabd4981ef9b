"""Which settings an atlas of the surroundings of a run varies, and the values that they take there."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Final

from rl_tui.agents.catalogue import BY_ID, parameters_of
from rl_tui.agents.hyperparameters import PARAMETERS, Hyperparameters, Parameter
from rl_tui.agents.idle_parameters import why_idle
from rl_tui.lab.run.recipe import Recipe
from rl_tui.lab.sweeps.variation import Variation

MOST_COLUMNS: Final = 11
MOST_ROWS: Final = 7
_STEPS: Final = (1.0, 2.0, 2.5, 5.0, 10.0)
_HALF_DECADES: Final = 3  # on either side of the value in force
_DOUBLINGS: Final = 3
_DIGITS: Final = 2
_REACH: Final = 5.0  # so many times the value in force, from 0 on, where a slider is linear


def axes_of(recipe: Recipe, *, is_bandit: bool) -> tuple[Variation, ...]:
    """Return the settings that matter most for what ``recipe`` learns by: rows, then columns; one or none.

    The value in force is one of the values of each, as it stands. Columns are the setting that most
    algorithms have (a step size); rows the one that fewest have, which is what makes this algorithm or this
    policy another one.
    """
    values = recipe.hyperparameters
    names = _candidates(recipe.algorithm, values, is_bandit=is_bandit)
    if not names:
        return ()
    commonest = max(names, key=_spread)
    own = [name for name in names if name != commonest]
    columns = _variation(commonest, values, MOST_COLUMNS)
    if not own:
        return (columns,)
    return _variation(min(own, key=_rank), values, MOST_ROWS), columns


def _candidates(algorithm: str, values: Hyperparameters, *, is_bandit: bool) -> list[str]:
    """Return the numbers that decide how ``algorithm`` learns, in the order of the controls panel.

    What a planner has too is no way to learn, but part of the question: γ, and what estimates start from.
    """
    planned = {name for row in BY_ID.values() if row.planner for name in row.parameters}
    return [
        name
        for name in parameters_of(algorithm, values.policy)
        if name not in planned
        and PARAMETERS[name].range is not None
        and not PARAMETERS[name].schedule
        and not (name == "alpha" and values.sample_average)
        and not why_idle(name, algorithm, values, is_bandit=is_bandit)
    ]


def _spread(name: str) -> int:
    """Return how many algorithms have the parameter ``name`` themselves."""
    return sum(name in row.parameters for row in BY_ID.values())


def _rank(name: str) -> tuple[bool, int, int]:
    """Return a low number for what few algorithms have; the policy's own come behind the algorithm's.

    Bounds of accuracy, which have neither a slider nor whole numbers, come last.
    """
    parameter = PARAMETERS[name]
    is_bound = parameter.slide is None and not parameter.whole
    return is_bound, _spread(name) or len(BY_ID), list(PARAMETERS).index(name)


def _variation(name: str, values: Hyperparameters, most: int) -> Variation:
    parameter, now = PARAMETERS[name], float(values.value(name))
    usual = Hyperparameters().value(name)
    around = values_around(parameter, now, float(usual) if not isinstance(usual, str) else 1.0, most)
    whole = [int(each) if parameter.whole else each for each in around]
    return Variation(name, tuple(whole))


def values_around(parameter: Parameter, now: float, usual: float, most: int) -> list[float]:
    """Return some ``most`` values of ``parameter``, ascending; ``now``, the one in force, is one of them.

    Where its slider is linear they lie at equal distances, from its low end to five times ``now`` at most;
    where it is logarithmic at equal ratios around ``now``. What has no slider is doubled and halved if it is
    whole, else taken ten times; from 0, where ratios lead nowhere, ``usual`` is what they start from.
    """
    slide = parameter.slide
    if slide is not None and not slide.logarithmic:
        reach = _REACH * (now - slide.low)
        high = min(slide.high, slide.low + reach) if reach > 0.0 else slide.high
        around: Iterable[float] = _even(slide.low, high, most - 1)
    else:
        base = now or usual or 1.0
        around = _in_ratios(parameter, base)
    allowed = {round(each) if parameter.whole else each for each in around}
    if parameter.range is not None and 0.0 in parameter.range and parameter.slide is None:
        allowed.add(0.0)
    sound = {float(each) for each in allowed if parameter.accepts(each)}
    return sorted(sound | {now})


def _even(low: float, high: float, most: int) -> list[float]:
    """Return numbers from ``low`` to ``high`` at equal, round distances, at most ``most`` of these."""
    width = high - low
    magnitude = 10.0 ** math.floor(math.log10(width / most))
    step = next(each * magnitude for each in _STEPS if width / (each * magnitude) < most + 1e-9)
    return [_rounded(low + number * step) for number in range(math.floor(width / step + 1e-9) + 1)]


def _in_ratios(parameter: Parameter, base: float) -> list[float]:
    if parameter.slide is not None:
        powers = range(-_HALF_DECADES, _HALF_DECADES + 1)
        low, high = parameter.slide.low, parameter.slide.high
        around = [_rounded(base * 10.0 ** (power / 2.0), _DIGITS) for power in powers]
        return [each for each in around if low <= each <= high]
    ratio = 2.0 if parameter.whole else 10.0
    return [_rounded(base * ratio**power) for power in range(-_DOUBLINGS, _DOUBLINGS + 1)]


def _rounded(number: float, digits: int = 12) -> float:
    return float(f"{number:.{digits}g}")
