"""Conditions that stop the run."""

from __future__ import annotations

from typing import Final

from rl_tui.live.commands import ClearBreakpoints, RunUntil, ToggleBreakpoint
from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.screen.board.subject import Subject
from rl_tui.screen.dialogs.until_options import Kind, UntilChoice, UntilOption, ask_number, kind_of
from rl_tui.screen.draw.names import pair_in_words, state_name
from rl_tui.screen.kit.snapshot_facts import why_over
from rl_tui.screen.panels.arms import ArmsView
from rl_tui.screen.panels.q_table.q_table import QTable
from rl_tui.screen.panels.world.view import WorldView

ON_ARMS: Final = "a bandit has breakpoints on arms. tab, arrows: choose one"
NO_BREAKPOINTS: Final = "there are no breakpoints. t b: set one at the cursor"


class UntilActions(Subject):
    """Conditions to run until, and breakpoints."""

    _chosen_last = ""

    def why_not(self, deed: str) -> str:
        """Explain why the run cannot go on, or has no breakpoint."""
        if deed == "choose":
            return "" if self.link.settled is None else why_over(self.link.settled)
        snapshot = self.snapshot
        if deed == "toggle_breakpoint" and snapshot is not None and self._breakpoint_here(snapshot) is None:
            is_bandit = snapshot.world.is_bandit
            return ON_ARMS if is_bandit else "there is no state here to stop at"
        return NO_BREAKPOINTS if deed == "clear_breakpoints" and not self._count else ""

    def value(self, deed: str) -> str:
        """Return the number of breakpoints."""
        return f"{self._count} set" if deed == "clear_breakpoints" and self._count else ""

    @property
    def _count(self) -> int:
        found = None if self.snapshot is None else self.snapshot.playback.breakpoints
        return 0 if found is None else len(found.states) + len(found.pairs)

    def choose(self) -> None:
        """Ask for a condition to run until."""
        snapshot = self.snapshot
        if snapshot is None or snapshot.playback.phase is Phase.PREPARING:
            return
        choice = UntilChoice(
            snapshot,
            self._pair_under_cursor(),
            self._breakpoint_here(snapshot),
            self._chosen_last,
            self.link.send,
            self.glyphs,
        )
        self.ask(choice, self._run_until)

    def toggle_breakpoint(self) -> None:
        """Set or clear a breakpoint."""
        snapshot = self.snapshot
        if snapshot is None:
            return
        here, stops, kind = self._breakpoint_here(snapshot), snapshot.playback.breakpoints, kind_of(snapshot)
        if here is not None and here.pair is not None:
            name, is_set = pair_in_words(snapshot.world, here.pair, self.glyphs), here.pair in stops.pairs
            happens = {Kind.AGENT: "taken", Kind.BANDIT: "pulled", Kind.PLANNER: "backed up"}[kind]
        elif here is not None and here.state is not None:
            is_set = here.state in stops.states
            name = f"state {state_name(snapshot.world, here.state, self.glyphs)}"
            happens = "backed up" if kind is Kind.PLANNER else "reached"
        else:
            return
        self.link.send(here)
        stop = f"breakpoint on {name}: pauses each time it is {happens}"
        self.screen.tell(f"breakpoint on {name} removed" if is_set else stop)

    def _breakpoint_here(self, snapshot: Snapshot) -> ToggleBreakpoint | None:
        focused = self.screen.focused
        if isinstance(focused, QTable | ArmsView):
            pair = focused.shown_cursor if isinstance(focused, QTable) else focused.cursor_place
            return None if pair is None else ToggleBreakpoint(pair=pair)
        if snapshot.world.is_bandit:
            return None
        state: int | None = snapshot.counters.state
        if isinstance(focused, WorldView) and focused.cursor_place is not None:
            state = focused.state_at(focused.cursor_place)
        return None if state is None else ToggleBreakpoint(state=state)

    def clear_breakpoints(self) -> None:
        """Clear all breakpoints."""
        self.link.send(ClearBreakpoints())
        self.screen.tell("All breakpoints are cleared.")

    def _run_until(self, option: UntilOption) -> None:
        def run(number: float | str) -> None:
            self.link.send(RunUntil(option.until(float(number))))

        self._chosen_last = option.id
        if not option.asks:
            self.link.send(RunUntil(option.until()))
        elif self.snapshot is not None:
            self.ask(ask_number(option, self.snapshot, self.glyphs), run)

    def _pair_under_cursor(self) -> int | None:
        table, world = self.board.table, self.board.world
        if self.screen.focused is table:
            return table.shown_cursor
        if isinstance(world, ArmsView) and self.screen.focused is world:
            return world.cursor_place
        return table.cursor_pair
