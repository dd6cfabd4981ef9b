"""Snapshots of a run, and variants."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import fields, is_dataclass, replace
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, TypeVar

from rl_tui.live.pins import NO_PINS
from rl_tui.live.questions import Questions
from rl_tui.live.record import Record
from rl_tui.live.snapshot import Phase, PlaybackView, Snapshot
from rl_tui.live.snapshot_builder import SnapshotBuilder
from rl_tui.live.viewport import Viewport
from rl_tui.runs.exact_answers import PENDING, Answer
from rl_tui.runs.timeline.branches import RunRecord, Timeline
from rl_tui.runs.timeline.lane_view import LaneView, RunGroupView

if TYPE_CHECKING:
    from rl_tui.runs.run import Run

Picture = TypeVar("Picture", Snapshot, LaneView)


def snapshot_of(
    run: Run,
    phase: Phase = Phase.PAUSED,
    *,
    message: str = "",
    exact_answer: Answer = PENDING,
    viewport: Viewport | None = None,
) -> Snapshot:
    lane: Any = SimpleNamespace(run=run, timeline=Timeline(), trail=(), begun_at=None)
    questions = Questions(Record((RunRecord(run.recipe),)), lambda: None, automatic=False)
    questions.viewport = viewport
    questions.exact = SimpleNamespace(of=lambda _: exact_answer)  # type: ignore[assignment]
    group, playback = RunGroupView(), PlaybackView(phase, message)
    return SnapshotBuilder().of_lane(lane, group, 0, playback, questions, NO_PINS, has_trail=False)


def changed(picture: Picture, **changes: Any) -> Picture:
    own = {name: changes.pop(name) for name in _names(picture) if name in changes}
    inner: dict[str, dict[str, Any]] = defaultdict(dict)
    for group in _names(picture):
        for name in _names(getattr(picture, group)):
            if name in changes and group not in ("world", "recipe", "timeline", "cell"):
                inner[group][name] = changes.pop(name)
    assert not changes, f"there is no {', '.join(changes)}"
    groups = {group: _replaced(getattr(picture, group), given) for group, given in inner.items()}
    return replace(picture, **groups, **own)


def _names(group: Any) -> list[str]:
    if isinstance(group, Answer):
        return list(group._fields)
    return [each.name for each in fields(group)] if is_dataclass(group) else []


def _replaced(group: Any, given: dict[str, Any]) -> Any:
    return group._replace(**given) if isinstance(group, Answer) else replace(group, **given)
