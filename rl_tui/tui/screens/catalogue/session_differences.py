"""What tells sessions of the same title apart."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from contextlib import suppress

from rl_tui.agents.catalogue import BY_ID, POLICY_BY_ID
from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.common.words import counted
from rl_tui.lab.sessions.session import StoredSession
from rl_tui.lab.timeline.run_names import feature_text, features_of

_SCENARIO = "scenario"
_LANES = "lanes"
_Features = Mapping[str, float | str]


def differences(sessions: Sequence[StoredSession]) -> list[list[str]]:
    """Return, for each of ``sessions``, in a few words each what others of its title have otherwise.

    Scenario, algorithm, settings in force, seed and lanes count, in this order; the step is not among them.
    """
    by_title = defaultdict[str, list[_Features]](list)
    every = [_features(session) for session in sessions]
    for session, features in zip(sessions, every, strict=True):
        by_title[session.title].append(features)
    return [
        [
            _text(name, value)
            for name, value in features.items()
            if any(other.get(name) != value for other in by_title[session.title])
        ]
        for session, features in zip(sessions, every, strict=True)
    ]


def _features(session: StoredSession) -> _Features:
    """Return what there is to tell of ``session``; what this version does not know is left out."""
    document = session.document
    lane = document.lanes[document.shown]
    features: dict[str, float | str] = {_SCENARIO: document.scenario.id}
    values = Hyperparameters()
    for name, value in lane.settings_in_force.items():
        with suppress(ValueError):
            values = values.changed(name, value)
    if lane.algorithm_in_force in BY_ID and values.policy in POLICY_BY_ID:
        features.update(features_of(lane.algorithm_in_force, values, lane.seed))
    return {**features, _LANES: len(document.lanes)}


def _text(name: str, value: float | str) -> str:
    if name == _SCENARIO:
        return str(value)
    return counted(int(value), "lane") if name == _LANES else feature_text(name, value)
