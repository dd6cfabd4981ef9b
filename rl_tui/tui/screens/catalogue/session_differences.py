"""What tells sessions of the same title apart."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from contextlib import suppress

from rl_tui.agents.catalogue import BY_ID, POLICY_BY_ID
from rl_tui.agents.hyperparameters import PARAMETERS, Hyperparameters
from rl_tui.common.words import counted
from rl_tui.lab.sessions.session import StoredSession
from rl_tui.lab.timeline.run_names import feature_text, features_of

_SCENARIO = "scenario"
_LANES = "lanes"
_Features = Mapping[str, float | str]


def differences(sessions: Sequence[StoredSession]) -> list[list[str]]:
    """Return, for each of ``sessions``, in a few words each what it has otherwise than most of its title.

    Scenario, algorithm, settings in force, seed and lanes count, in this order; the step is not among them.
    Of two that are equally common the one of the session that stands last is the usual one.
    """
    by_title = defaultdict[str, list[_Features]](list)
    every = [_features(session) for session in sessions]
    for session, features in zip(sessions, every, strict=True):
        by_title[session.title].insert(0, features)
    usual = {title: _usual(alike) for title, alike in by_title.items()}
    return [
        [_text(name, value) for name, value in features.items() if usual[session.title][name] != value]
        for session, features in zip(sessions, every, strict=True)
    ]


def settings_of(session: StoredSession) -> list[str]:
    """Return in a few words each the numbers in force in ``session`` that a slider sets."""
    features = _features(session)
    return [feature_text(name, features[name]) for name in features if _has_slider(name)]


def _usual(sessions: Sequence[_Features]) -> _Features:
    names = dict.fromkeys(name for features in sessions for name in features)
    values = {name: [features[name] for features in sessions if name in features] for name in names}
    return {name: max(there, key=there.count) for name, there in values.items()}


def _has_slider(name: str) -> bool:
    return name in PARAMETERS and PARAMETERS[name].slide is not None


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
