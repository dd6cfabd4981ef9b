"""Return per episode: what was earned, what the greedy policy is worth, and the best there is."""

from __future__ import annotations

from typing import Final

from textual.strip import Strip

from rl_tui.agents.catalogue import algorithm_row
from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.runs.answers.policy_kind import PolicyKind
from rl_tui.runs.recipe import Recipe
from rl_tui.screen.draw.canvas import Piece, strips_of
from rl_tui.screen.draw.chart_plot import Plot
from rl_tui.screen.draw.scale import Scale, settled
from rl_tui.screen.kit.panel import Panel
from rl_tui.screen.kit.snapshot_facts import has_estimates, is_new_run, passes_too_fast
from rl_tui.screen.panels.curve.area import says_something
from rl_tui.screen.panels.curve.axis import episode_axis
from rl_tui.screen.panels.curve.chart import draw_chart, plot_of, spark_line
from rl_tui.screen.panels.curve.data import CurveData, curve_data, is_decided, unit_of
from rl_tui.screen.panels.curve.lane_text import (
    PlotColumns,
    lane_heads,
    lane_remark,
    plot_columns,
    steps_note,
)
from rl_tui.screen.panels.curve.seed_band import seed_remark, with_room_for
from rl_tui.screen.panels.curve.text import amount, below_note, decimals_of_labels, gap_note, heads, remark
from rl_tui.screen.panels.curve.words import GREEDY, TITLES
from rl_tui.screen.panels.policies.studied import studied_answer

WAITING: Final = "the world is being built"
Words = tuple[str, ...]


class ReturnCurve(Panel, can_focus=True):
    """The curve of a run. Its vertical axis changes in steps only, and starts afresh with a new run.

    ``hints`` are ways to write keys, the longest first, which take the place of the caption.
    """

    scale: Scale | None = None
    _is_of_steps = False
    _band: tuple[object, bool] = (None, False)
    _hints: Words = ()
    _unit = "episode"

    def begin_with(self, recipe: Recipe) -> None:
        """Name what ``recipe`` will show until the first snapshot does."""
        plans = algorithm_row(recipe.algorithm).planner
        self._unit = unit_of(plans=plans, is_bandit=recipe.scenario.kind == "bandit")

    @property
    def hints(self) -> Words:
        """The keys in the heading, empty for none."""
        return self._hints

    @hints.setter
    def hints(self, hints: Words) -> None:
        if hints != self._hints:
            self._hints = hints
            self.redraw()

    def depends_on(self, snapshot: Snapshot) -> object:
        """Return results, exact answers and how the agent explores; of estimates only whether they differ."""
        values, episodes = snapshot.agent.hyperparameters, snapshot.counters.episodes
        answers, playback, lanes = snapshot.answers, snapshot.playback, snapshot.run_group.lanes
        return (
            *(snapshot.world, snapshot.world_changes, snapshot.results, snapshot.study),
            *(snapshot.agent.algorithm, values.policy, values.epsilon_at(episodes), is_decided(snapshot)),
            *(episodes, snapshot.program is None, has_estimates(snapshot)),
            *(snapshot.timeline.in_past, snapshot.timeline.furthest, snapshot.counters.episode_step > 0),
            episode_axis(snapshot).right,
            *(snapshot.exact_answer.expected_return, snapshot.exact_answer.refused),
            *(answers.is_hidden, answers.kept_back, answers.first_update, answers.studied),
            *(answers.policies.get(PolicyKind.BEHAVIOUR), studied_answer(snapshot)),
            *(
                playback.phase is Phase.SPENT,
                _runs(snapshot),
                passes_too_fast(snapshot),
                snapshot.run_group.shown,
            ),
            *((each.name, each.algorithm, each.episodes, each.results) for each in lanes),
        )

    def show(self, snapshot: Snapshot) -> None:
        """Draw ``snapshot``; the past of a run has the same axis as its present."""
        if is_new_run(self.snapshot, snapshot):
            self.scale = self.drawn_from = None
        super().show(snapshot)

    def picture(self, snapshot: Snapshot | None, width: int, height: int) -> list[Strip]:
        """Return the picture of the curve of ``snapshot``."""
        if snapshot is None:
            self.heading = self.fitting([TITLES[self._unit]], width)
            return strips_of([[Piece(f" {WAITING}", self.look.palette.dim)]], width, height, self.look)
        data = curve_data(snapshot)
        scale = self._settled(data, snapshot)
        if height == 1:
            line = spark_line(data, scale, self.look, width, self._brief(data, decimals_of_labels(scale)))
            return strips_of([line], width, 1, self.look)
        columns = plot_columns(snapshot, self.look, width)
        plot = plot_of(data, scale, columns, height)
        key = plot, bool(data.lanes), data.seeds, data.is_of_steps
        if self._band[0] != key or not _runs(snapshot):
            self._band = key, self._has_middle_half(data, plot)
        self.heading = self._headed(snapshot, data, plot, columns, width)
        return draw_chart(data, plot, columns, self.look, (width, height), has_band=self._band[1])

    def _has_middle_half(self, data: CurveData, plot: Plot) -> bool:
        """Return whether there is a middle half, and a band of it says something."""
        if not data.furthest or data.lanes or data.seeds or data.is_of_steps or data.is_bandit:
            return False
        return says_something(plot, data.curve, data.mean, self.look)

    def _settled(self, data: CurveData, snapshot: Snapshot) -> Scale:
        """Return the vertical axis: steady in a run, in the past as in the present, else what fits best."""
        if data.is_of_steps is not self._is_of_steps:
            self.scale, self._is_of_steps = None, data.is_of_steps
        if snapshot.timeline.in_past and self.scale is not None:
            return self.scale
        low, high = with_room_for(data.range, data.seeds)
        scale = settled(self.scale if _runs(snapshot) else None, low, high)
        if low or high:
            # else nothing stood on it, and how soon the exact answer came must not be seen later
            self.scale = scale
        return scale

    def _headed(
        self, snapshot: Snapshot, data: CurveData, plot: Plot, columns: PlotColumns, width: int
    ) -> str:
        """Return the heading: title, what is drawn, and as many notes as there is room for."""
        glyphs, decimals = self.look.glyphs, decimals_of_labels(plot.scale)
        titles = heads(data, has_band=self._band[1])
        if self.hints:
            return self.fitting([*(f"{titles[-1]} · {each}" for each in self.hints), titles[-1]], width)
        # at full speed numbers would change in every frame
        is_calm = not passes_too_fast(snapshot)
        notes: list[Words] = [remark(snapshot, data, glyphs, decimals, with_figures=is_calm)]
        if data.lanes:
            titles = lane_heads(data, titles, glyphs)
            notes = [lane_remark(data, self.look, counts_seeds=snapshot.program is None), steps_note(data)]
        elif not columns.labels and is_calm and (brief := self._brief(data, decimals)):
            titles = f"{titles[-1]} · {brief}", titles[-1]
        elif data.seeds:
            notes.insert(0, seed_remark(data.seeds, self.look))
        if is_calm and snapshot.program is None:
            notes.append(below_note(data, plot, glyphs, decimals))
        notes = [each for each in (*notes, gap_note(data, plot)) if each]
        head = self.fitting(titles[1:] if notes and len(titles) > 2 else titles, width)
        for note in notes:
            head = self.fitting([f"{head} · {form}" for form in note], width) or head
        return head

    def _brief(self, data: CurveData, decimals: int) -> str:
        """Return the newest numbers in a few words: of each run, else of the agent and its greedy policy."""
        numbered = [(f"{lane.number} ", lane.value) for lane in data.lanes]
        numbered = numbered or [("", data.mean_now), (f"{GREEDY} ", data.greedy_now)]
        glyphs = self.look.glyphs
        return "  ".join(f"{name}{amount(x, decimals, glyphs)}" for name, x in numbered if x is not None)


def _runs(snapshot: Snapshot) -> bool:
    return snapshot.playback.phase is Phase.RUNNING
