"""A study as JSON and back: what its process sends, line by line."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, fields
from typing import Any

import numpy as np

from rl_tui.lab.many_seeds.figures import (
    Estimate,
    LaneStudy,
    PairedDifference,
    SeedCurve,
    SeedStudy,
    StudyState,
)


def as_json(study: SeedStudy) -> dict[str, Any]:
    """Return ``study`` as JSON, every bit of its numbers."""
    plain = {each.name: getattr(study, each.name) for each in fields(study)}
    return {**plain, "lanes": [_lane_as_json(lane) for lane in study.lanes]}


def of_json(document: Mapping[str, Any]) -> SeedStudy:
    """Return the study that ``document`` has. Raises KeyError, TypeError or ValueError where it has none."""
    lanes = tuple(_lane_of_json(lane) for lane in document["lanes"])
    return SeedStudy(**{**document, "state": StudyState(document["state"]), "lanes": lanes})


def _lane_as_json(lane: LaneStudy) -> dict[str, Any]:
    return {
        "estimates": {name: asdict(each) for name, each in lane.estimates.items()},
        "this_seed": dict(lane.this_seed),
        "differences": {name: asdict(each) for name, each in lane.differences.items()},
        "curve": [lane.curve.episode.tolist(), lane.curve.mean.tolist(), lane.curve.stderr.tolist()],
    }


def _lane_of_json(document: Mapping[str, Any]) -> LaneStudy:
    episode, *means = document["curve"]
    mean, stderr = (np.array(each, np.float64) for each in means)
    return LaneStudy(
        estimates={name: Estimate(**each) for name, each in document["estimates"].items()},
        this_seed=document["this_seed"],
        differences={
            name: PairedDifference(Estimate(**each["mean"]), each["greater"], each["equal"])
            for name, each in document["differences"].items()
        },
        curve=SeedCurve(np.array(episode, np.int64), mean, stderr),
    )
