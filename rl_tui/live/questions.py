"""What a person asks beside the runs: what to show of them, and questions with exact answers."""

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
    from rl_tui.runs.recipe import Recipe
    from rl_tui.runs.run import Run
    from rl_tui.runs.timeline.run_group import RunGroup
    from rl_tui.worlds.files.scenario import Scenario
    from rl_tui.worlds.mdp.space import FiniteSpace


class Questions:
    """What was asked, the same of all lanes; ``on_exact`` is called when an exact answer has come.

    With ``automatic`` off no answer depends on the time.
    """

    def __init__(self, record: Record, on_exact: Callable[[], None], *, automatic: bool) -> None:
        self.viewport: Viewport | None = None
        """What the screen shows of a large world; None: it has not said, so everything may be shown."""
        self.cell: int | None = None
        """The pair of which snapshots tell how Q went."""
        self.seed_studies = SeedStudies(on_exact, automatic=automatic)
        """What many seeds say of the runs."""
        self.exact = RunAnswers(on_exact)
        """The exact answers for the γ in force."""
        self.flips = FlipAnswers(on_exact, automatic=automatic)
        """Every γ at which optimal actions change, by world."""
        self.asks_check = False
        """Whether a person wants to know of the world what its author should."""
        self._checks = WorldChecks(on_exact, automatic=automatic)
        self.is_hidden = record.answer_is_hidden
        """Whether a person wants the answer hidden; None: nobody has said."""
        self.drawn = record.drawn
        """The policy that a person drew."""
        self.lesson = record.lesson
        """The lesson that is taken beside the runs, None where there is none."""
        self._judge = TaskJudge(on_exact, automatic=automatic)
        self.studied: PolicyKind | None = None
        """The policy whose values are asked for."""
        self._policies = PolicyAnswers(automatic=automatic)
        self._left_to_chance = LeftToChance()
        self.asks_why = False
        """Whether a person has asked why nothing is learned."""
        self._first_updates = FirstUpdates()

    def draw(self, state: int, action: int | None) -> None:
        """Choose ``action`` in ``state`` for the drawn policy; None: no action."""
        self.drawn = self.drawn.with_action(state, action)

    def fit(self, space: FiniteSpace) -> None:
        """Keep what there may be in ``space`` of the drawn policy and the cell."""
        self.drawn = self.drawn.fitting(space)
        self.cell = self.cell if self.cell is not None and self.cell < space.pairs else None

    def change_world(self, before: Recipe, now: Recipe) -> None:
        """Hide the answer again; forget the drawn policy, unless the same world came of the same seed."""
        self.hide_again()
        if (before.scenario, before.seed) != (now.scenario, now.seed):
            self.clear()

    def clear(self) -> None:
        """Forget the drawn policy."""
        self.drawn = DrawnPolicy()

    @property
    def kept_back(self) -> frozenset[str]:
        """What the lesson keeps back until its page is done: names of what a page may hide."""
        return frozenset() if self.lesson is None else self.lesson.hidden

    def hides_answer(self, scenario: Scenario) -> bool:
        """Return whether the answer is hidden: by a lesson, else as a person or ``scenario`` says."""
        if "answer" in self.kept_back:
            return True
        return scenario.hides_answer if self.is_hidden is None else self.is_hidden

    def hide_again(self) -> None:
        """Let the scenario say again whether the answer is hidden, unless a person has hidden it.

        What a person has seen is not the answer of another world.
        """
        self.is_hidden = self.is_hidden or None

    def ask_check(self, *, is_asked: bool) -> None:
        """Let the world be checked, or no more."""
        self.asks_check = is_asked
        if not is_asked:
            self._checks.end()

    def close(self) -> None:
        """End what is worked out in processes of their own, from any thread, and begin nothing any more."""
        self.seed_studies.close()
        self.flips.close()
        self._checks.close()
        self._judge.close()

    def answers(self, run: Run, drawn: DrawnPolicy, *, is_still: bool) -> AnswersView:
        """Return what is known by now for ``run``, which takes steps unless it ``is_still``.

        ``drawn`` is the policy that a person drew, by the numbers of the world of ``run``.
        """
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
        """Return what an author wants to know of the world of ``run``; None while nobody asks."""
        return self._checks.of(run) if self.asks_check else None

    def judge(self, run: Run) -> LessonView | None:
        """Judge the task of the lesson, if there is one, where ``run`` stands; return how the lesson stands.

        Of commands that come quickly, not each has a snapshot after it: judge before ``run`` goes on, too.
        """
        return None if self.lesson is None else self._judge.view(self.lesson, run)

    def watch_program(self, path: Path) -> None:
        """Watch the program in the file ``path`` for the task of the lesson's open page."""
        if self.lesson is not None:
            self._judge.watch(self.lesson, path)

    def work(self, group: RunGroup, drawn_beside: DrawnPolicy) -> bool:
        """Work out one answer that runs in view lack, all standing still; return whether there was one.

        ``drawn_beside`` is the policy that a person drew, by the numbers of the world of the run beside.
        """
        if self.studied is None:
            return False
        runs = [(group.current.run, self.drawn)]
        if group.beside is not None:
            runs.append((group.beside.run, drawn_beside))
        return any(self._policies.work(run, self.exact.of(run), drawn) for run, drawn in runs)
