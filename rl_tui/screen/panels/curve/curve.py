"""Return per episode: what was earned, what the greedy policy is worth, and the best there is."""

from __future__ import annotations

from typing import Final

from rich.cells import cell_len
from textual.strip import Strip

from rl_tui.agents.catalogue import algorithm_row
from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.runs.answers.policy_kind import PolicyKind
from rl_tui.runs.recipe import Recipe
from rl_tui.screen.draw import numbers
from rl_tui.screen.draw.canvas import Piece, strips_of
from rl_tui.screen.draw.chart_plot import Plot
from rl_tui.screen.draw.scale import Scale, settled
from rl_tui.screen.draw.to_ascii import separated
from rl_tui.screen.kit.panel import Legend, LegendSign, Panel, legend_text
from rl_tui.screen.kit.snapshot_facts import has_estimates, is_new_run, passes_too_fast
from rl_tui.screen.panels.curve.chart import draw_chart, plot_columns, plot_of, spark_line
from rl_tui.screen.panels.curve.data import CurveData, curve_data, is_decided, unit_of
from rl_tui.screen.panels.curve.lane_text import lane_remark, lane_titles, steps_note
from rl_tui.screen.panels.curve.seed_band import seed_bands, seed_sign, with_room_for
from rl_tui.screen.panels.curve.text import all_words, below_note, decimals_for, gap_note, remark, titles
from rl_tui.screen.panels.curve.words import TITLES
from rl_tui.screen.panels.curve.world_marks import world_signs
from rl_tui.screen.panels.policies.studied import studied_answer
from rl_tui.worlds.drawing import Arms

WAITING: Final = "the world is being built"
Words = tuple[str, ...]
_ROOM_FOR_REMARK: Final = 10  # rows; with fewer the remark goes into the border


class ReturnCurve(Panel, can_focus=True):
    """The curve of a run. Its vertical axis changes in steps only, and starts afresh with a new run.

    ``hints`` are ways to write keys, the longest first, that stand on the border in place of all else.
    """

    scale: Scale | None = None
    _hints: Words = ()
    _unit = "episode"

    def begin_with(self, recipe: Recipe) -> None:
        """Name what ``recipe`` will show until the first snapshot does."""
        plans = algorithm_row(recipe.algorithm).planner
        self._unit = unit_of(plans=plans, is_bandit=recipe.scenario.kind == "bandit")

    @property
    def hints(self) -> Words:
        """The keys on the border, empty for none."""
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
            *(episodes, snapshot.program is None, has_estimates(snapshot), snapshot.timeline.in_past),
            *(snapshot.exact_answer.expected_return, snapshot.exact_answer.refused),
            *(answers.is_hidden, answers.kept_back, answers.first_update, answers.studied),
            *(answers.policies.get(PolicyKind.BEHAVIOUR), studied_answer(snapshot)),
            *(playback.phase is Phase.SPENT, passes_too_fast(snapshot), snapshot.run_group.shown),
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
            self.heading = self.fitting(TITLES[self._unit], width)
            return strips_of([[Piece(f" {WAITING}", self.look.palette.dim)]], width, height, self.look)
        data = curve_data(snapshot)
        low, high = with_room_for(data.range, data.seeds)
        scale = settled(self.scale, low, high, may_shrink=not snapshot.timeline.in_past)
        if low or high:
            # else nothing stood on it, and how soon the exact answer came must not be seen later
            self.scale = scale
        if height == 1:
            line = spark_line(data, scale, self.look, width, self._brief(data))
            return strips_of([line], width, 1, self.look)
        decimals = decimals_for(*scale.outer_labels)
        in_border = height < _ROOM_FOR_REMARK
        plot = plot_of(data, scale, self.look, width, height)
        heads, words, below = self._words(snapshot, data, plot, width, in_border)
        if data.unit == "episode" and not data.lanes:
            heads = (*self.captioned(heads[0]), *heads)
        room = width - self._kept_for_legend(snapshot) if in_border else width
        gap = gap_note(data, plot)
        said = self.fitting(all_words(words, below, () if in_border else gap), room)
        for note in (steps_note(data), gap if in_border else ()):
            # where they come and go, the rest stays as it is
            said = self.fitting([f"{said} · {each}" if said else each for each in note], room) or said
        self.heading = self.fitting(heads, width)
        self.footing = self.fitting(self.hints, width) or (said if in_border else "")
        if not said or in_border:
            return draw_chart(data, scale, self.look, decimals, width, height)
        line = [Piece(f"    {separated(said, self.look.glyphs)}", self.look.palette.dim)]
        chart = draw_chart(data, scale, self.look, decimals, width, height - 1)
        return [*chart, *strips_of([line], width, 1, self.look)]

    def _brief(self, data: CurveData) -> str:
        """Return the figures of now in a few words: of each run, else of the agent and its greedy policy."""
        figures = [(str(lane.number), lane.value) for lane in data.lanes]
        figures = figures or [("mean", data.mean_now), ("greedy", data.greedy_now)]
        glyphs = self.look.glyphs
        return "  ".join(f"{name} {numbers.value(x, 4, glyphs)}" for name, x in figures if x is not None)

    def legend(self, snapshot: Snapshot) -> Legend:
        """Return where the world changed, what the band of many seeds is, and what the axis counts.

        The lines have their names where they end.
        """
        seeds, worlds = seed_bands(snapshot), tuple(world_signs(snapshot.world_changes, self.look))
        more = (seed_sign(seeds, self.look),) if seeds else ()
        if isinstance(snapshot.world.drawing, Arms):
            return (*worlds, *more)
        sums = LegendSign("return", "= undiscounted sum", self.look.palette.text)
        return (*worlds, *more, sums)

    def _kept_for_legend(self, snapshot: Snapshot) -> int:
        """Return the cells of the border for the first sign of its legend, with the ``·`` behind.

        That is where the world changed; else none is kept.
        """
        signs = self.legend(snapshot)[:1]
        if not self.is_explained or not snapshot.world_changes or not signs:
            return 0
        return cell_len(separated(f"{legend_text(signs, self.size.width, self.look)} · ", self.look.glyphs))

    def _words(
        self, snapshot: Snapshot, data: CurveData, plot: Plot, width: int, in_border: bool
    ) -> tuple[Words, Words, Words]:
        """Return the titles, the remarks and what is below the axis, the longest form of each first."""
        look, decimals = self.look, decimals_for(*plot.scale.outer_labels)
        # Figures in the border would redraw the whole panel at every frame
        fast = passes_too_fast(snapshot)
        heads = titles(data, look.glyphs, decimals, width, with_figures=not fast)
        with_figures = not (fast and in_border)
        words = remark(snapshot, data, look.glyphs, decimals, with_figures=with_figures)
        if data.lanes:
            words = lane_remark(
                data,
                look,
                plot_columns(plot.scale, look, width),
                counts_seeds=snapshot.program is None,
            )
        # beside somebody's program a figure in the note would be taken for one of its figures now
        tells_how_far = with_figures and snapshot.program is None
        below = below_note(data, plot, look.glyphs, decimals, with_figures=tells_how_far)
        heads = lane_titles(data, heads, look.glyphs) if data.lanes else heads
        return heads, words, below
