"""What a person asks beside the runs: what to show of them, and questions with exact answers."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING

from rl_tui.lab.answers.drawn_policy import DrawnPolicy
from rl_tui.lab.answers.policy_values import PolicyAnswers
from rl_tui.lab.answers.view import AnswersView
from rl_tui.lab.many_seeds.seed_studies import SeedStudies
from rl_tui.lab.run.exact_answers import RunAnswers

if TYPE_CHECKING:
    from rl_tui.lab.answers.policy_kind import PolicyKind
    from rl_tui.lab.live.record import Record
    from rl_tui.lab.live.viewport import Viewport
    from rl_tui.lab.run.run import Run


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
        self.is_hidden = record.answer_is_hidden
        """Whether a person has the answer hidden; None: nobody has said."""
        self.drawn = record.drawn
        """The policy that a person drew."""
        self.studied: PolicyKind | None = None
        """The policy whose values are asked for."""
        self._policies = PolicyAnswers(automatic=automatic)

    def draw(self, state: int, action: int | None) -> None:
        """Choose ``action`` in ``state`` for the drawn policy; None: no action."""
        self.drawn = self.drawn.with_action(state, action)

    def clear(self) -> None:
        """Forget the drawn policy."""
        self.drawn = DrawnPolicy()

    def answers(self, run: Run, *, is_still: bool) -> AnswersView:
        """Return what is known by now for ``run``, which takes steps unless it ``is_still``."""
        policies = (
            {}
            if self.studied is None
            else self._policies.of(run, self.exact.of(run), self.drawn, is_still=is_still)
        )
        return AnswersView(bool(self.is_hidden), self.studied, self.drawn, policies)

    def work(self, runs: Iterable[Run]) -> bool:
        """Work out one answer that is lacking of ``runs``, which stand still; return whether there was one."""
        if self.studied is None:
            return False
        return self._policies.work(((run, self.exact.of(run)) for run in runs), self.drawn)
