"""The World panel of a bandit."""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from textual.strip import Strip

from rl_tui.agents.hyperparameters import SAMPLE_AVERAGE, StepSize
from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.bandit import true_means
from rl_tui.screen.draw.canvas import Canvas
from rl_tui.screen.draw.names import pair_in_words
from rl_tui.screen.kit.numbers_in_common import all_q
from rl_tui.screen.kit.panel import BoardPanel, Legend, LegendSign
from rl_tui.screen.kit.scrolling import scrolled_to
from rl_tui.screen.kit.snapshot_facts import is_new_run, is_secret
from rl_tui.screen.panels import arm_bars
from rl_tui.screen.panels.world.shown_policy import drawn_pairs
from rl_tui.screen.panels.world.view import WorldView
from rl_tui.worlds.editing.arms_draft import ArmsDraft
from rl_tui.worlds.mdp.space import FloatArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP
from rl_tui.worlds.world import World

HEADING: Final = "Arms · Q ± standard error"


class ArmsView(WorldView):
    """The arms from top to bottom."""

    scale = arm_bars.NO_SCALE
    _top = 0
    _shown = _each = 1

    def enter(self, world: World, *, goes_on: bool = False) -> None:
        """Switch to ``world``. Raises TypeError without arms or a transition table."""
        if not world.is_bandit or world.mdp is None:
            raise TypeError("an ArmsView needs a world with a table and Arms as its drawing")
        super().enter(world, goes_on=goes_on)
        self._mdp = world.mdp
        self.heading = HEADING

    def show(self, snapshot: Snapshot) -> None:
        """Draw ``snapshot``. The scale only widens during a run."""
        if is_new_run(self.snapshot, snapshot):
            self.scale = arm_bars.NO_SCALE
            self.number_forms.clear()
        super().show(snapshot)

    def drawing(self, snapshot: Snapshot, width: int, height: int) -> list[Strip]:
        """Draw the visible arms and the axis."""
        means = None if is_secret(snapshot) else true_means_now(self._mdp, snapshot)
        drawn = drawn_pairs(self._mdp, snapshot)
        arms = tuple(
            arm._replace(
                cursor=pair == self.shown_cursor,
                stops=pair in snapshot.playback.breakpoints.pairs,
                greedy=arm.greedy if drawn is None else pair in drawn[0],
            )
            for pair, arm in enumerate(arms_of(self._mdp, snapshot, means))
        )
        self.scale = arm_bars.grown(self.scale, [value for arm in arms for value in arm.extent()])
        scale = arm_bars.shown_scale(self.scale)
        each = arm_bars.rows_an_arm(len(arms), height)
        shown = min(len(arms), max(1, height // each))
        self._top = max(0, min(self._top, len(arms) - shown))
        self._shown, self._each = shown, each
        hidden = len(arms) - shown
        parts = [f"↑↓ {self._top + 1}–{self._top + shown} of {len(arms)}"] if hidden else []
        if len(arms) * each >= height:  # no row left for the axis
            parts.append(self._ends(scale))
        self.footing = self.fitting(("  ".join(parts[:count]) for count in range(len(parts), 0, -1)), width)
        names = arm_bars.names_width(arms, self.look)
        form = self.number_forms.form("estimates", all_q(snapshot), arm_bars.value_width(width, names))
        in_view = arms[self._top : self._top + shown]
        canvas = Canvas(width, height, self.look.palette.text)
        arm_bars.draw_arms(canvas, in_view, scale, self.look, each, names, form)
        return canvas.strips()

    def signs(self) -> Legend:
        """List the signs."""
        palette, glyphs = self.look.palette, self.look.glyphs
        truth = (
            LegendSign(arm_bars.true_mean_glyph(self.look), "true mean", palette.strong),
            LegendSign(glyphs.best_arm, "best arm", palette.strong),
        )
        return (
            LegendSign(glyphs.whisker, "standard error", palette.text),
            *(truth if self.snapshot is not None and not is_secret(self.snapshot) else ()),
            LegendSign(glyphs.agent, "last pull", palette.agent),
            LegendSign(glyphs.cursor, "greedy", palette.best),
            LegendSign(glyphs.bar_end, "estimate", palette.text),
        )

    @property
    def stance(self) -> object:
        """Cursor, visible arms and scale."""
        return self.cursor, self._top, self.scale

    def align_with(self, twin: BoardPanel) -> None:
        """Take the twin's stance, with a common scale."""
        super().align_with(twin)
        if isinstance(twin, ArmsView):
            self._top = twin._top if self.takes_stance_of(twin) else self._top
            self.scale = arm_bars.grown(self.scale, twin.scale)

    def carried(self, place: int, before: Snapshot, now: Snapshot) -> int | None:
        """Return the arm's place after an edit."""
        old, new = before.editor.base, now.editor.base
        if isinstance(old, ArmsDraft) and isinstance(new, ArmsDraft):
            arm = old.arm_ids[place]
            return new.arm_ids.index(arm) if arm in new.arm_ids else None
        return self.place_in(place, before.world, now.world)

    def place_in(self, place: int, world: World, other: World) -> int | None:
        """Return the arm with the same number."""
        return place if place < other.space.pairs else None

    def agent_place(self, snapshot: Snapshot) -> int:
        """Return the last pulled arm, or 0."""
        last = snapshot.counters.last_step
        return last.pair if last is not None and not last.planned else 0

    def moved(self, place: int, rows: int, columns: int) -> int:
        """Return the arm ``rows`` below."""
        return max(0, min(place + rows, self.world.space.pairs - 1))

    def place_at(self, x: int, y: int) -> int | None:
        """Return the arm in row ``y``."""
        place = y // self._each
        return self._top + place if place < self._shown else None

    def state_at(self, place: int) -> int | None:
        """Return None: an arm is a pair."""
        return None

    def name_at(self, place: int) -> str:
        """Return the name of the arm."""
        return pair_in_words(self.world, place, self.look.glyphs)

    def pairs_at(self, place: int) -> range:
        """Return the arm's only pair."""
        return range(place, place + 1)

    def place_of(self, pair: int) -> int:
        """Return the arm of ``pair``."""
        return pair

    @property
    def page_size(self) -> tuple[int, int]:
        """The number of visible arms."""
        return self._shown, 1

    def keep_in_view(self, place: int) -> None:
        """Scroll until the arm is visible."""
        self._top = scrolled_to(self._top, place, self._shown)

    def pan(self, rows: int, columns: int) -> None:
        """Scroll by ``rows`` arms."""
        self._top += rows

    def follow(self) -> None:
        """Go back to the first arm."""
        self._top = 0

    def _ends(self, scale: arm_bars.ArmsScale) -> str:
        low, high = (arm_bars.bound_text(end, self.look.glyphs) for end in scale)
        return f"{low}…{'+' if scale.high > 0.0 else ''}{high}"


def true_means_now(mdp: TabularMDP, snapshot: Snapshot) -> FloatArray | None:
    """Return the present true means q*(a), [P]."""
    if mdp.drift_std > 0.0 and snapshot.counters.step > 0:
        return None if snapshot.exact_answer.solution is None else snapshot.exact_answer.solution.q
    return true_means(mdp)


def noise_of_rewards(mdp: TabularMDP, q: FloatArray) -> FloatArray:
    """Return the standard deviation of a reward per pair, [P].

    For rewards of two values the estimate replaces the hidden mean: √((q − low)(high − q)).
    """
    values = np.unique(mdp.reward)
    if len(values) != 2 or mdp.reward_std.any() or len(mdp.reward) == mdp.pairs:
        variance = np.bincount(mdp.outcome_pair, mdp.probability * mdp.reward_std**2, minlength=mdp.pairs)
        return np.asarray(np.sqrt(variance))
    low, high = values
    inside = np.clip(q, low, high)
    return np.asarray(np.sqrt((inside - low) * (high - inside)))


def standard_error(noise: float, pulls: int, alpha: StepSize) -> float:
    """Return the standard deviation of an estimate after ``pulls`` (≥ 1) rewards.

    ``noise`` is σ of one reward. A sample average leaves σ/√N. A constant step size weights rewards by α(1 −
    α)^(N−i) (equation 2.6), which leaves σ·√(α/(2 − α)·(1 − (1 − α)^2N)). The bias from Q₀, (1 − α)^N, is not
    counted.
    """
    if alpha == SAMPLE_AVERAGE:
        return noise / math.sqrt(pulls)
    step_size = float(alpha)
    return noise * math.sqrt(step_size / (2.0 - step_size) * (1.0 - (1.0 - step_size) ** (2 * pulls)))


def arms_of(mdp: TabularMDP, snapshot: Snapshot, means: FloatArray | None) -> tuple[arm_bars.Arm, ...]:
    """Collect the known facts about each arm."""
    q, visits = snapshot.agent.q.tolist(), snapshot.agent.visits.tolist()
    noise, values = noise_of_rewards(mdp, snapshot.agent.q), snapshot.agent.hyperparameters
    alpha: StepSize = SAMPLE_AVERAGE if values.sample_average else values.alpha
    anything = any(visits)
    best_estimate = max(q)
    last = None if snapshot.counters.last_step is None else snapshot.counters.last_step.pair
    best_mean = float(means.max()) if means is not None else None
    return tuple(
        arm_bars.Arm(
            name=mdp.action_names[int(mdp.pair_action[pair])],
            estimate=q[pair],
            error=standard_error(float(noise[pair]), visits[pair], alpha) if visits[pair] else None,
            pulls=visits[pair],
            greedy=anything and q[pair] == best_estimate,
            last=pair == last,
            mean=float(means[pair]) if means is not None else None,
            best=best_mean is not None and means is not None and float(means[pair]) == best_mean,
        )
        for pair in mdp.pairs_of(0)
    )
