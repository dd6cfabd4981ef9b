"""One sentence on what is being learned."""

from __future__ import annotations

from textual.strip import Strip

from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.screen.draw.canvas import Piece, shortened, strips_of
from rl_tui.screen.kit.snapshot_facts import has_estimates, has_optimal_policy, valued_states
from rl_tui.screen.panels.status_line import StatusLine, waiting_line


class CaptionLine(StatusLine):
    """One row on what is learned, or why the run waits."""

    replaces_header = is_in_view = False

    def depends_on(self, snapshot: Snapshot) -> object:
        """Return a constant while invisible: captions are expensive."""
        return None if self.is_in_view else ()

    def picture(self, snapshot: Snapshot | None, width: int, height: int) -> list[Strip]:
        """Return the caption, padded with blank rows."""
        look, line = self.look, None
        if self.replaces_header:
            line = waiting_line(snapshot, look, width, unanswered=self.unanswered, scenario=self.title)
        if line is None and snapshot is not None:
            text = look.glyphs.spelled(caption(snapshot))
            line = [Piece(shortened(text, width, look.glyphs.ellipsis), look.palette.text)]
        return strips_of([line or []], width, height, look)


def caption(snapshot: Snapshot) -> str:
    """Describe how the estimates change."""
    if not snapshot.counters.step and snapshot.playback.phase is Phase.PAUSED:
        return "Nothing is learned yet. space: run, s: take one step."
    if not has_estimates(snapshot):
        return "No table was found in your program yet, so its learning is not shown."
    if snapshot.world.is_bandit:
        return "Each pull moves the estimate of its arm towards what it paid."
    if has_optimal_policy(snapshot):
        return "Optimal policy found: no other policy is better."
    counted = valued_states(snapshot)
    if counted is None:
        return "Values spread over the map."  # only a part of the values is known
    with_value, states = counted
    agent = snapshot.agent
    if not with_value and (agent.q == agent.hyperparameters.initial_q).all():
        return "Nothing is learned yet: that begins with the first reward."
    if not with_value:
        return "Some estimates have changed, but V is still the same everywhere."
    if with_value < states:
        return f"Values spread: {with_value:,} of {states:,} states have a value so far."
    return f"Values settle: all {states:,} states have a value."
