"""What policies are worth."""

from __future__ import annotations

from rl_tui.live.commands import StudyPolicy
from rl_tui.runs.answers.policy_kind import PolicyKind
from rl_tui.screen.board.subject import Subject
from rl_tui.screen.kit.row import POLICIES
from rl_tui.screen.panels.policies.names import POLICY_NAMES


class PolicyActions(Subject):
    """Which policy is studied: the one under the cursor of the panel, and after that the one kept."""

    _is_open = _is_kept = False
    _chosen = PolicyKind.UNIFORM

    def follow_panel(self) -> None:
        """Study a policy when the panel has been opened, and none when it has been closed, unless kept."""
        is_open = self.board.opened == POLICIES
        if is_open == self._is_open:
            return
        self._is_open = is_open
        if is_open:
            self._is_kept = False
            self._study(self._current)
        elif not self._is_kept:
            self.link.send(StudyPolicy(None))

    def choose(self, offset: int) -> None:
        """Study the policy so many rows further down, or the last one there is."""
        kinds = list(POLICY_NAMES)
        self.study(kinds[max(0, min(kinds.index(self._current) + offset, len(kinds) - 1))])

    def study(self, kind: PolicyKind) -> None:
        """Study ``kind``."""
        if kind is not self._current:
            self._study(kind)

    @property
    def _current(self) -> PolicyKind:
        """The one that is studied, be it kept or drawn; else the one last chosen."""
        return self.link.wanted.studied or self._chosen

    def _study(self, kind: PolicyKind) -> None:
        self._chosen = kind
        self.link.send(StudyPolicy(kind))

    def keep(self) -> None:
        """Close the panel, and go on to show the policy under its cursor."""
        self._is_kept = True
        self.board.close()
        name = POLICY_NAMES[self._current].of
        self.screen.tell(f"kept: {name}; v: Qπ in the table; P and P again end it")
