"""From the rows of seeds to means, paired differences and a mean curve, and those as JSON and back."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, fields
from typing import Any

import numpy as np

from rl_tui.lab.experiments.many_runs import summary
from rl_tui.lab.many_seeds.figures import (
    Estimate,
    LaneStudy,
    PairedDifference,
    SeedCurve,
    SeedStudy,
    StudyState,
)

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


def as_json(study: SeedStudy) -> dict[str, Any]:
    """Return ``study`` as JSON, every bit of its numbers."""
    plain = {each.name: getattr(study, each.name) for each in fields(study)}
    return {**plain, "lanes": [_lane_as_json(lane) for lane in study.lanes]}


def of_json(told: Mapping[str, Any]) -> SeedStudy:
    """Return the study that ``told`` says. Raises KeyError, TypeError or ValueError where it says none."""
    lanes = tuple(_lane_of_json(lane) for lane in told["lanes"])
    return SeedStudy(**{**told, "state": StudyState(told["state"]), "lanes": lanes})


def _lane_as_json(lane: LaneStudy) -> dict[str, Any]:
    return {
        "estimates": {name: asdict(each) for name, each in lane.estimates.items()},
        "this_seed": dict(lane.this_seed),
        "differences": {name: asdict(each) for name, each in lane.differences.items()},
        "curve": [lane.curve.episode.tolist(), lane.curve.mean.tolist(), lane.curve.stderr.tolist()],
    }


def _lane_of_json(told: Mapping[str, Any]) -> LaneStudy:
    episode, *means = told["curve"]
    mean, stderr = (np.array(each, np.float64) for each in means)
    return LaneStudy(
        estimates={name: Estimate(**each) for name, each in told["estimates"].items()},
        this_seed=told["this_seed"],
        differences={
            name: PairedDifference(Estimate(**each["mean"]), each["greater"], each["equal"])
            for name, each in told["differences"].items()
        },
        curve=SeedCurve(np.array(episode, np.int64), mean, stderr),
    )
