"""Questions about the runs that are answered in snapshots."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from rl_tui.lessons.file.view import LessonView
from rl_tui.lessons.judging.judge import TaskJudge
from rl_tui.runs.answers.flip_answers import FlipAnswers
from rl_tui.runs.answers.policy_kind import PolicyKind
from rl_tui.runs.answers.policy_values import DrawnPolicy, LeftToChance, PolicyAnswer, PolicyAnswers
from rl_tui.runs.answers.view import AnswersView, FirstUpdates
from rl_tui.runs.exact_answers import RunAnswers
from rl_tui.studies.many_seeds.request import SeedStudies
from rl_tui.studies.world_check.world_checks import WorldChecks, WorldCheckView

if TYPE_CHECKING:
    from rl_tui.live.record import Record
    from rl_tui.live.viewport import Viewport
    from rl_tui.runs.played_run import PlayedRun
    from rl_tui.runs.recipe import Recipe
    from rl_tui.runs.run import Run
    from rl_tui.runs.timeline.run_group import RunGroup
    from rl_tui.worlds.files.scenario import Scenario
    from rl_tui.worlds.mdp.space import FiniteSpace


class Questions:
    """The questions of a playground, equal for all runs.

    `on_exact` is called for an answer. Without `automatic`, no answer depends on timing.
    """

    def __init__(self, record: Record, on_exact: Callable[[], None], *, automatic: bool) -> None:
        self.viewport: Viewport | None = None
        """Visible part of a large world, or None to copy everything."""
        self.cell: int | None = None
        """Pair whose history is reported."""
        self.seed_studies = SeedStudies(on_exact, automatic=automatic)
        """The study of many seeds."""
        self.exact = RunAnswers(on_exact)
        """Exact solutions for the current γ."""
        self.flips = FlipAnswers(on_exact, automatic=automatic)
        """Every γ at which optimal actions change, by world."""
        self.asks_check = False
        """True if the world check is requested."""
        self._checks = WorldChecks(on_exact, automatic=automatic)
        self.is_hidden = record.answer_is_hidden
        """True or False if the user has hidden or shown the answer, else None."""
        self.drawn = record.drawn
        """The policy drawn by the user."""
        self.lesson = record.lesson
        """The lesson, or None."""
        self._judge = TaskJudge(on_exact, automatic=automatic)
        self.studied: PolicyKind | None = None
        """Policy whose values are shown."""
        self._policies = PolicyAnswers(automatic=automatic)
        self._left_to_chance = LeftToChance()
        self.asks_why = False
        """True if the user asks why nothing is learned."""
        self._first_updates = FirstUpdates()

    def draw(self, state: int, action: int | None) -> None:
        """Set or remove a state's action in the drawn policy."""
        self.drawn = self.drawn.with_action(state, action)

    def fit(self, space: FiniteSpace) -> None:
        """Drop what `space` does not have."""
        self.drawn = self.drawn.fitting(space)
        self.cell = self.cell if self.cell is not None and self.cell < space.pairs else None

    def change_world(self, before: Recipe, now: Recipe) -> None:
        """Hide the answer, and clear the policy unless scenario and seed are the same."""
        self.hide_again()
        if (before.scenario, before.seed) != (now.scenario, now.seed):
            self.clear()

    def clear(self) -> None:
        """Clear the drawn policy."""
        self.drawn = DrawnPolicy()

    @property
    def kept_back(self) -> frozenset[str]:
        """Names that the lesson hides now."""
        return frozenset() if self.lesson is None else self.lesson.hidden

    def hides_answer(self, scenario: Scenario) -> bool:
        """Return True if lesson, user or `scenario`, in this order, hide the answer."""
        if "answer" in self.kept_back:
            return True
        return scenario.hides_answer if self.is_hidden is None else self.is_hidden

    def hide_again(self) -> None:
        """Let the scenario decide again, unless the user has hidden the answer.

        A user who has seen one answer has not seen that of another world.
        """
        self.is_hidden = self.is_hidden or None

    def ask_check(self, *, is_asked: bool) -> None:
        """Start or stop the world check."""
        self.asks_check = is_asked
        if not is_asked:
            self._checks.end()

    def close(self) -> None:
        """Stop background processes for good, from any thread."""
        self.seed_studies.close()
        self.flips.close()
        self._checks.close()
        self._judge.close()

    def answers(self, run: PlayedRun, drawn: DrawnPolicy, *, is_still: bool) -> AnswersView:
        """Return the known answers, for a policy `drawn` in this world."""
        studied, mdp, left = self.studied, run.world.mdp, None
        policies: Mapping[PolicyKind, PolicyAnswer] = {}
        if mdp is not None and studied is PolicyKind.DRAWN:
            left = self._left_to_chance.of(mdp, drawn)
        if studied is not None:
            policies = self._policies.of(run, self.exact.of(run), drawn, is_still=is_still)
        return AnswersView(
            is_hidden=mdp is not None and self.hides_answer(run.recipe.scenario),
            kept_back=self.kept_back,
            studied=studied,
            drawn=drawn,
            left_to_chance=left,
            policies=policies,
            first_update=self._first_updates.of(run, is_asked=self.asks_why),
            flips=self.flips.of(run.world.mdp),
        )

    def world_check(self, run: Run) -> WorldCheckView | None:
        """Return the world check, if requested."""
        return self._checks.of(run) if self.asks_check else None

    def judge(self, run: Run) -> LessonView | None:
        """Judge the task of the lesson, if any, and return its state.

        Call it also before `run` advances: quick commands do not each have a snapshot.
        """
        return None if self.lesson is None else self._judge.view(self.lesson, run)

    def watch_program(self, path: Path) -> None:
        """Watch the program in `path` for the open task."""
        if self.lesson is not None:
            self._judge.watch(self.lesson, path)

    def work(self, group: RunGroup, drawn_beside: DrawnPolicy) -> bool:
        """Compute one missing answer for the visible, paused runs. Return True if there was one."""
        runs = [(group.current.run, self.drawn)]
        if group.beside is not None:
            runs.append((group.beside.run, drawn_beside))
        return any(self._policies.work(run, self.exact.of(run), drawn) for run, drawn in runs)
