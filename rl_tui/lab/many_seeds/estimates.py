"""From the rows of seeds to means and paired differences."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from rl_tui.lab.experiments.many_runs import summary
from rl_tui.lab.many_seeds.figures import Estimate, PairedDifference

Row = Mapping[str, Any]


def estimate_of(values: Iterable[float | None]) -> Estimate | None:
    """Return the mean of the values that are there, as ``train --runs --json`` has it; None without any."""
    found = summary(list(values))
    mean, count = found["mean"], found["count"]
    return None if mean is None or count is None else Estimate(mean, found["stderr"], int(count))


def difference_of(shown: Sequence[float | None], other: Sequence[float | None]) -> PairedDifference | None:
    """Return ``shown`` less ``other``, seed by seed; None where no seed has both."""
    pairs = [(a, b) for a, b in zip(shown, other, strict=True) if a is not None and b is not None]
    mean = estimate_of(a - b for a, b in pairs)
    if mean is None:
        return None
    return PairedDifference(mean, sum(a > b for a, b in pairs), sum(a == b for a, b in pairs))


def estimates_of(rows: Sequence[Row], names: Iterable[str]) -> dict[str, Estimate]:
    """Return the mean over ``rows`` of each figure that any of them has."""
    found = {name: estimate_of(row[name] for row in rows) for name in names}
    return {name: estimate for name, estimate in found.items() if estimate is not None}


def differences_of(
    shown: Sequence[Row], other: Sequence[Row], names: Iterable[str]
) -> dict[str, PairedDifference]:
    """Return the rows of the lane shown less those of another one, for each figure that both have."""
    found = {
        name: difference_of([row[name] for row in shown], [row[name] for row in other]) for name in names
    }
    return {name: difference for name, difference in found.items() if difference is not None}
