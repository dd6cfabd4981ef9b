"""A map with all that is around it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rl_tui.screen.panels.surroundings.bodies import Pose, body_strips
from rl_tui.screen.panels.surroundings.margins import LabelledPart, Margins, labelled
from rl_tui.worlds.drawing import Grid

if TYPE_CHECKING:
    from textual.strip import Strip

    from rl_tui.live.snapshot import Snapshot
    from rl_tui.screen.theme.look import Look


def surrounded(
    strips: list[Strip], snapshot: Snapshot, part: LabelledPart, margins: Margins, width: int, look: Look
) -> list[Strip]:
    """Return ``strips`` of ``part`` of the map of ``snapshot`` in its margins, ``width`` cells wide."""
    grid, space = snapshot.world.drawing, snapshot.world.space
    assert isinstance(grid, Grid)
    if grid.axes is not None:
        strips = labelled(strips, grid.axes, part, margins, width, look)
    if grid.body is None or not margins.body:
        return strips
    last = snapshot.counters.last_step
    action = "" if last is None or last.planned else space.action_names[int(space.pair_action[last.pair])]
    pose = Pose(grid.body.kind, grid.body.pose(snapshot.counters.state), action)
    return [*body_strips(pose, width, margins.body, look), *strips]
