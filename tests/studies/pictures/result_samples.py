"""JSON documents in the form that commands print."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

STEP_SIZES = (0.01, 0.1, 1.0)
EPSILONS = (0.0, 0.1)
ARRIVAL = {"restricted_mean": 7.0, "restricted_low": 6.0, "restricted_high": 8.0}


def spread(mean: float | None, **more: Any) -> dict[str, Any]:
    if mean is None:
        empty = dict.fromkeys(("mean", "median", "iqm", "low", "high"))
        return {**empty, "count": 0, **more}
    figures = {"mean": mean, "median": mean, "iqm": mean, "low": mean - 1.0, "high": mean + 1.0, "count": 30}
    return {**figures, **more}


def area(settings: Mapping[str, Any]) -> float:
    words = {"sarsa": 0.5, "q-learning": 0.25, "cliff": 0.0, "maze": 3.0}
    return sum(float(words.get(value, value)) for value in settings.values() if not isinstance(value, bool))


def sweep(*cells: Mapping[str, Any], **more: Any) -> dict[str, Any]:
    made = [
        {
            **settings,
            "runs": 30,
            "failed": 0,
            "area": spread(area(settings)),
            "arrival": spread(None, count=30, arrived=20, **ARRIVAL),
            "like_best": place < 2,
        }
        for place, settings in enumerate(cells)
    ]
    document = {
        "scenario": "cliff",
        "measures": [
            {"id": "area", "title": "return per episode"},
            {"id": "arrival", "title": "episodes to 5 %"},
        ],
        "measure": "area",
        "cells": made,
        "best": {**made[0], "again": made[0]},
        "steps_per_second": 1.0,
    }
    return {**document, **more}


def grid(*algorithms: str) -> list[dict[str, Any]]:
    return [
        {"alpha": alpha, "epsilon": epsilon, **({"algorithm": algorithm} if algorithm else {})}
        for alpha in STEP_SIZES
        for epsilon in EPSILONS
        for algorithm in algorithms or ("",)
    ]


def runs(columns: Mapping[str, Sequence[float | None]], count: int = 3, **more: Any) -> dict[str, Any]:
    rows = [{"seed": seed} for seed in range(count)]
    return {"scenario": "cliff", "algorithm": "sarsa", "runs": rows, "summary": {}, "curve": columns, **more}


def written(folder: Path, document: object, name: str = "results.json") -> Path:
    path = folder / name
    path.write_text(json.dumps(document), encoding="utf-8")
    return path
