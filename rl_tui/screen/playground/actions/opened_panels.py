"""Requests of opened panels to the player."""

from __future__ import annotations

from typing import Final

import numpy as np

from rl_tui.live.commands import EndStudy, FollowCell, StudyPolicy, StudySeeds
from rl_tui.live.snapshot import Phase
from rl_tui.runs.answers.policy_kind import PolicyKind
from rl_tui.screen.board.subject import Subject
from rl_tui.screen.kit.pointing import NOWHERE
from rl_tui.screen.kit.row import MANY_SEEDS, MICROSCOPE, POLICIES
from rl_tui.screen.panels.policies.studied import POLICY_NAMES, policy_name
from rl_tui.screen.panels.seed_figures import may_count_again

_TO_END: Final = 999  # rows


class MicroscopeActions(Subject):
    """The cell whose history the microscope shows."""

    _is_of_world = False

    def follow_update(self) -> None:
        """Show the last update's history, unless a run already shows one."""
        runs = self.snapshot is not None and self.snapshot.playback.phase is Phase.RUNNING
        if self.board.opened != MICROSCOPE:
            self._show_history(None)
        elif self.board.microscope.pair is None or not runs:
            self._follow_cell()

    def follow_cursor(self, *, of_world: bool) -> None:
        """Show the history under a cursor."""
        world = self.board.world
        self._is_of_world = of_world and world is not None and world.cursor is not None
        if self.board.opened == MICROSCOPE:
            self._follow_cell()
            self.board.microscope.redraw()
            if self._pairs_under_cursor():
                self.board.microscope.action_scroll_rows(_TO_END)  # to the history at the end

    def _follow_cell(self) -> None:
        if self.snapshot is None:
            return
        last, q = self.snapshot.counters.last_step, self.snapshot.agent.q
        updated = last.updated_pair if last is not None and last.learned else None
        chosen = self._pairs_under_cursor()
        if chosen and chosen.stop <= len(q) and updated not in chosen:
            pair: int | None = chosen.start + int(np.argmax(q[chosen.start : chosen.stop]))
        elif updated is None and last is not None:
            pair = self.board.microscope.pair
        else:
            pair = updated
        if pair is not None and pair >= len(q):
            pair = None  # of the world before this one
        self._show_history(pair)

    def _pairs_under_cursor(self) -> range:
        table, world = self.board.table.cursor_pair, self.board.world
        of_table = NOWHERE if table is None else range(table, table + 1)
        of_world = NOWHERE if world is None or world.cursor is None else world.pairs_at(world.cursor)
        return (of_world or of_table) if self._is_of_world else (of_table or of_world)

    def _show_history(self, pair: int | None) -> None:
        if pair != self.board.microscope.pair:
            self.board.microscope.pair = pair
            self.link.send(FollowCell(pair))


class SeedActions(Subject):
    """Studies of many seeds while their panel is open."""

    _counts: bool = False

    def follow_panel(self) -> None:
        """Run the study while the panel is open."""
        is_open = self.board.opened == MANY_SEEDS
        if is_open != self._counts:
            self._counts = is_open
            self.link.send(StudySeeds() if is_open else EndStudy())

    def count_again(self) -> None:
        """Start the study again, unless it is under way."""
        if self.snapshot is not None and may_count_again(self.snapshot.study):
            self.link.send(StudySeeds())


class PolicyActions(Subject):
    """The policy on display."""

    _is_open = _is_kept = False
    _chosen = PolicyKind.GREEDY

    def follow_panel(self) -> None:
        """Show a policy while the panel is open, or kept."""
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
        """Show the policy ``offset`` rows further down."""
        kinds = list(POLICY_NAMES)
        self.study(kinds[max(0, min(kinds.index(self._current) + offset, len(kinds) - 1))])

    def study(self, kind: str) -> None:
        """Show the policy ``kind``."""
        if kind != self._current:
            self._study(PolicyKind(kind))

    @property
    def _current(self) -> PolicyKind:
        return self.link.wanted.studied or self._chosen

    def _study(self, kind: PolicyKind) -> None:
        self._chosen = kind
        self.link.send(StudyPolicy(kind))

    def keep(self) -> None:
        """Close the panel, but keep its policy."""
        self._is_kept = True
        self.board.close()
        name = policy_name(self._current)
        self.screen.tell(f"Shown: {name}. v: its Qπ. t p, then esc: stop.")
