"""Snapshots of several runs, made by hand."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

from samples import curve, lake, marks
from snapshots import changed

from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.results import Curve, RunResults
from rl_tui.runs.timeline.lane_view import LaneView

# name, algorithm, changed settings, highest mean return, greedy return, episodes
LANES: tuple[tuple[str, str, dict[str, Any], float, float, int], ...] = (
    ("α 0.1", "q-learning", {}, 0.5, 0.73, 12_500),
    ("α 0.5", "q-learning", {"alpha": 0.5}, 0.32, 0.6, 14_000),
    ("SARSA", "sarsa", {}, 0.44, 0.7, 11_000),
    ("softmax, τ 0.3", "q-learning", {"policy": "softmax", "temperature": 0.3}, 0.62, 0.74, 9_000),
)


def lane_views(count: int) -> tuple[LaneView, ...]:
    q, base = _lake().agent.q, _lake().agent.hyperparameters
    return tuple(
        LaneView(
            name=name,
            algorithm=algorithm,
            hyperparameters=_changed(base, changes),
            step=150_000,
            episodes=episodes,
            q=q * (1.0 - 0.1 * number),
            results=RunResults(
                curve=curve(400, 0.0, high, episodes // 400),
                marks=marks(30, 0.0, greedy, episodes),
                return_last_100=high,
                greedy_return=greedy,
            ),
        )
        for number, (name, algorithm, changes, high, greedy, episodes) in enumerate(LANES[:count])
    )


def side_by_side(count: int, shown: int = 0, **changes: Any) -> Snapshot:
    lanes = lane_views(count)
    return paired(changed(showing(_lake(), lanes[shown]), lanes=lanes, shown=shown, **changes))


def paired(snapshot: Snapshot) -> Snapshot:
    group = snapshot.run_group
    others = [number for number in range(len(group.lanes)) if number != group.shown]
    return replace(snapshot, run_group=replace(group, beside=next(iter(others), None)))


def showing(snapshot: Snapshot, lane: LaneView) -> Snapshot:
    return changed(
        snapshot,
        algorithm=lane.algorithm,
        hyperparameters=lane.hyperparameters,
        step=lane.step,
        episodes=lane.episodes,
        q=lane.q,
        curve=lane.results.curve,
        marks=lane.results.marks,
        return_last_100=lane.results.return_last_100,
        greedy_return=lane.results.greedy_return,
    )


def without_episodes(lane: LaneView) -> LaneView:
    return changed(lane, step=0, episodes=0, curve=Curve(), marks=marks(0, 0.0, 0.0, 0), return_last_100=None)


@cache
def _lake() -> Snapshot:
    return lake()


def _changed(values: Hyperparameters, changes: dict[str, Any]) -> Hyperparameters:
    for name, value in changes.items():
        values = values.changed(name, value)
    return values
