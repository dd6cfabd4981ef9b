"""What is said above and below the map."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

from rl_tui.common.words import counted
from rl_tui.lab.atlas.figures import Atlas, AtlasState
from rl_tui.tui.draw import numbers
from rl_tui.tui.screens.atlas.picture import ALIKE, BEST, AtlasScene, setting_name, value_name

_ROOM: Final = 6
_STARTING: Final = "the first cell is being trained"


def head(scene: AtlasScene, runs: int, how_long: str = "") -> str:
    """Return what is mapped, how far it has come, and ``how_long`` the rest takes where that is known."""
    atlas = scene.atlas
    each = "" if atlas.episodes is None else f" of {counted(atlas.episodes, 'episode')}"
    return f"a cell is the mean of {counted(runs, 'seed')}{each}: {progress(atlas, how_long)}"


def progress(atlas: Atlas, how_long: str) -> str:
    """Return how many runs are done, and ``how_long`` the rest takes; at the end, what came of it."""
    done = f"{atlas.done:,} of {counted(atlas.planned, 'run')}"
    if atlas.state is AtlasState.FAILED:
        return f"it failed, {atlas.message}"
    if atlas.state is AtlasState.STARTING:
        return ", ".join(filter(None, (_STARTING, how_long)))
    if atlas.state is AtlasState.OUT_OF_TIME:
        return f"{done}: {atlas.message}"
    if atlas.state is AtlasState.DONE:
        return f"all {counted(atlas.planned, 'run')} done"
    return ", ".join(filter(None, (done, how_long)))


def legend(scene: AtlasScene) -> str:
    """Return what colours and marks mean."""
    glyphs, ends = scene.look.glyphs, scene.ends
    if ends is None:
        return ""
    first, last = (numbers.value(end, _ROOM, glyphs) for end in ends)
    names = ("least", "greatest") if scene.measure.larger_is_better is None else ("worst", "best")
    marks = f"{BEST} best  {ALIKE} not different from it  " if scene.standings is not None else ""
    return f"{marks}[ ] in force  {names[0]} {first}, {names[1]} {last}"


def cell_line(scene: AtlasScene, seed: int) -> str:
    """Return what the runs of the cell under the cursor say, and which of them enter opens."""
    places = scene.cells.places(scene.cursor)
    settings = "  ".join(
        f"{setting_name(each)} {value_name(each, place)}"
        for each, place in zip(scene.cells.variations, places, strict=True)
    )
    return f"{settings}: {_figures(scene)}; enter opens seed {seed}"


def _figures(scene: AtlasScene) -> str:
    index, glyphs = scene.cursor, scene.look.glyphs
    if index in scene.atlas.impossible:
        return f"cannot be: {scene.atlas.impossible[index]}"
    cell = scene.atlas.cells.get(index)
    if cell is None:
        return "not done yet"
    found = cell.figures.get(scene.measure.id, {})
    parts = []
    value = cell.value(scene.measure)
    if value is not None:
        parts.append(f"mean {numbers.value(value, _ROOM, glyphs)}{_interval(scene, found)}")
    if found.get("median") is not None:
        parts.append(f"median {numbers.value(found['median'], _ROOM, glyphs)}")
    if scene.measure.may_never_arrive and "arrived" in found:
        parts.append(f"{found['arrived']} of {cell.runs - cell.failed} arrived")
    parts.append(counted(cell.runs, "run"))
    if cell.failed:
        parts.append(f"{cell.failed} broke down ({cell.failure})")
    return ", ".join(parts)


def _interval(scene: AtlasScene, found: Mapping[str, Any]) -> str:
    low, high = found.get("low"), found.get("high")
    if low is None or high is None:
        return ""
    ends = (numbers.value(end, _ROOM, scene.look.glyphs) for end in (low, high))
    return " (95 %: {} to {})".format(*ends)
