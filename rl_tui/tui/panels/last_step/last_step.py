"""The last step: what the agent chose and why, what the environment did, and the update with its numbers."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from textual.strip import Strip

from rl_tui.lab.last_step.story import story_of
from rl_tui.lab.live.snapshot import Snapshot
from rl_tui.tui.draw.pieces import Line, Piece, strips_of
from rl_tui.tui.draw.to_ascii import to_ascii
from rl_tui.tui.panels.last_step.step_lines import StepWriter
from rl_tui.tui.panels.last_step.words import words_of
from rl_tui.tui.panels.legend import Legend, LegendSign
from rl_tui.tui.panels.panel import Panel
from rl_tui.tui.panels.snapshot_facts import keeps_back, passes_too_fast
from rl_tui.tui.theme.look import Look
from rl_tui.worlds.drawing import Arms

NOTHING_YET: Final = "no step yet: s takes one"
ENDED: Final = "ended its episode"
ENDED_SWEEP: Final = "ended its sweep"
NOT_REPLAYED_YET: Final = "the last step is told once it is replayed"
OF_ANOTHER_WORLD: Final = "no step yet in this world: s takes one"
NOT_OF_THE_TABLE: Final = "this step is none that the world's table has"
_USUAL_ROWS: Final = 8  # of the longest form
_ROOM_ON_BORDER: Final = 76
_LEAST_ROWS: Final = 4  # below this the loop has no lines of its own


class LastStepPanel(Panel):
    """The loop in five parts (state, action, reward, next state, update); in one row the update alone.

    It is drawn from the last step of the snapshot only, so that all its numbers belong together.
    """

    def picture(self, snapshot: Snapshot | None, width: int, height: int) -> list[Strip]:
        """Return the picture of the last step of ``snapshot``."""
        self.heading = self.fitting((*self.captioned("Last step"), "Last step"), width)
        self.footing = _which(snapshot)
        lines = last_step_lines(snapshot, self.look, width, height)
        self.free_rows = height - max(len(lines), _USUAL_ROWS)
        return strips_of(lines, width, height, self.look)

    def legend(self, snapshot: Snapshot) -> Legend:
        """Return the signs of an update and of what the environment did."""
        palette, is_bandit = self.look.palette, isinstance(snapshot.world.drawing, Arms)
        delta, plans = to_ascii("δ", self.look.glyphs), snapshot.agent.row.planner
        tells_chances = snapshot.world.mdp is not None and not (
            is_bandit or plans or keeps_back(snapshot, "model")
        )
        story = story_of(snapshot)
        if story is not None and story.state_backup is not None:
            chance = LegendSign("p", "probability", palette.strong)
            keeps = snapshot.agent.row.takes_orders
            policy = LegendSign(to_ascii("π", self.look.glyphs), "policy", palette.strong)
            return (policy, chance) if keeps else (chance,)
        has_delta = story is None or story.has_equation
        # beside the numbers on the border it would come and go with their digits
        has_room = self.free_rows > 0 or self.size.width >= _ROOM_ON_BORDER
        return (
            *([LegendSign(delta, "TD error", palette.strong)] if has_delta else []),
            *([LegendSign("p", "probability", palette.strong)] if tells_chances and has_room else []),
        )


def _which(snapshot: Snapshot | None) -> str:
    """Return which step it was; nothing while they pass too fast to tell, since a title redraws the panel.

    One number of an episode is on screen at a time, that on the top line: where the next one begins, the one
    that ended is not numbered any more.
    """
    story = None if snapshot is None or passes_too_fast(snapshot) else story_of(snapshot)
    if story is None:
        return ""
    last, ended = story.last, story.ends_episode
    if last.planned:
        return f"step {last.step:,} · {ENDED_SWEEP if ended else f'sweep {last.episode:,}'}"
    if story.is_bandit:
        return f"pull {last.step:,}"
    return f"step {last.step:,} · {ENDED if ended else f'episode {last.episode:,}'}"


def nothing_yet(snapshot: Snapshot | None) -> str:
    """Return why there is no last step to tell of."""
    if snapshot is not None and snapshot.program is not None and snapshot.counters.step:
        return NOT_OF_THE_TABLE
    if snapshot is None or snapshot.counters.step == 0:
        return NOTHING_YET
    changes = snapshot.world_changes
    return OF_ANOTHER_WORLD if changes and changes[-1].step == snapshot.counters.step else NOT_REPLAYED_YET


def last_step_lines(snapshot: Snapshot | None, look: Look, width: int, height: int) -> list[Line]:
    """Return what the panel says in ``height`` rows of ``width`` cells, at most so many lines."""
    story = None if snapshot is None else story_of(snapshot)
    if snapshot is None or story is None:
        return [[Piece(" ", look.palette.text), Piece(nothing_yet(snapshot), look.palette.dim)]]
    if keeps_back(snapshot, "model"):
        story = replace(story, chance=None)
    writer = StepWriter(words_of(story, look.glyphs), look, width)
    return (writer.tall(height) if height >= _LEAST_ROWS else writer.short(height))[:height]
