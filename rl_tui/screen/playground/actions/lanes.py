"""Runs side by side."""

from __future__ import annotations

from functools import partial
from typing import Any, Final

from rl_tui.common.errors import UserError
from rl_tui.live.commands import AddBranch, AddLane, ChooseLane, DropLane, MarkLane
from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.recipe import SwitchAlgorithm
from rl_tui.runs.timeline.lane_view import LaneView
from rl_tui.screen.board.subject import Subject
from rl_tui.screen.board.wanted import in_force
from rl_tui.screen.dialogs.choice import algorithm_choice, ask_value, choice_beside_program, policy_choice
from rl_tui.screen.dialogs.compare_lanes import MOST_LANES, Answer, Compare
from rl_tui.screen.dialogs.dialog import Dialog
from rl_tui.screen.dialogs.lane_changes import ALGORITHM, branches_beside, lane_changes
from rl_tui.screen.kit.snapshot_facts import current_study, hides_greedy, keeps_back

ONE_RUN: Final = "there is only one run; c a adds another"


class LaneActions(Subject):
    """Opening, showing and ending lanes."""

    def compare(self) -> None:
        """Choose what is different in another lane, or which lane to show or to end."""
        snapshot = self.snapshot
        if snapshot is None:
            return
        if snapshot.program is not None and not snapshot.run_group.lanes:
            self._ask_for_ours(snapshot)
            return
        hidden = hides_greedy(snapshot)
        lanes = snapshot.run_group.lanes or (_only_lane(snapshot),)
        dialog = Compare(
            self.screen.look,
            lanes,
            snapshot.run_group.shown,
            in_force(snapshot),
            hidden=hidden,
            beside=snapshot.run_group.beside,
            study=current_study(snapshot),
            branches=branches_beside(snapshot),
            is_program=snapshot.program is not None,
            is_kept=keeps_back(snapshot, "answer"),
        )
        self.ask(dialog, self._compared)

    def why_not(self, deed: str) -> str:
        """Return why a run cannot be added, shown or ended now; empty where it can."""
        snapshot = self.snapshot
        lanes = () if snapshot is None else snapshot.run_group.lanes
        if not deed.startswith("another"):
            return "" if lanes else ONE_RUN
        if len(lanes) == MOST_LANES:
            return "four runs are open already; c e ends one"
        if deed == "another_seed":
            return "all runs have the seed of this one; t m runs many seeds"
        if deed == "another_branch" and (snapshot is None or not branches_beside(snapshot)):
            return "this run has one branch; go back, change something, and it has two"
        return ""

    def value(self, deed: str) -> str:
        """Return how many runs there are."""
        lanes = () if self.snapshot is None else self.snapshot.run_group.lanes
        return f"{len(lanes)} open" if deed == "compare" and lanes else ""

    def another_algorithm(self) -> None:
        """Choose the algorithm of another run beside this one."""
        self._ask_difference(ALGORITHM)

    def another_setting(self) -> None:
        """Choose which setting is different in another run beside this one."""
        self.compare()

    def another_seed(self) -> None:
        """Say that runs side by side share their seed: `why_not` always refuses this."""

    def another_branch(self) -> None:
        """Choose which branch of this run is to stand beside this one."""
        self.compare()

    def end(self) -> None:
        """End the run that is controlled."""
        if self.snapshot is not None:
            self._drop_lane(self.snapshot.run_group.shown)

    def next_lane(self) -> None:
        """Control the next run."""
        if self.snapshot is not None:
            group = self.snapshot.run_group
            self._show_lane((group.shown + 1) % len(group.lanes))

    def one_lane(self) -> None:
        """Show the run that is controlled alone, or two side by side."""
        self.board.is_one_lane = self.board.is_paired
        if self.board.is_one_lane:
            self.screen.tell("One run alone. c l: the next run, c o: two side by side.")
        elif not self.board.is_paired:
            self.screen.tell("No room for two runs side by side here.")

    def _compared(self, answer: Answer) -> None:
        if isinstance(answer, ChooseLane):
            self._show_lane(answer.lane)
        elif isinstance(answer, DropLane):
            self._drop_lane(answer.lane)
        elif isinstance(answer, AddBranch | MarkLane):
            self.link.send(answer)
        else:
            self._ask_difference(answer)

    def _show_lane(self, lane: int) -> None:
        snapshot = self.snapshot
        if snapshot is not None and snapshot.run_group.shown != lane:
            self.link.wanted.take_over(snapshot.run_group.lanes[lane])
            self.link.send(ChooseLane(lane))

    def _drop_lane(self, lane: int) -> None:
        snapshot = self.snapshot
        if snapshot is not None:
            lanes = snapshot.run_group.lanes
            if lane == snapshot.run_group.shown:
                # then the next one is shown, or the one before where it was the last
                self.link.wanted.take_over(lanes[lane + 1 if lane + 1 < len(lanes) else lane - 1])
            self.link.send(DropLane(lane))

    def _ask_difference(self, name: str) -> None:
        """Ask what ``name`` is to be in another lane, and open it."""
        if self.snapshot is None:
            return
        space, recipe, glyphs = self.snapshot.world.space, in_force(self.snapshot), self.glyphs
        if name == ALGORITHM and self.snapshot.program is not None:
            self._ask_for_ours(self.snapshot)
            return
        if name == ALGORITHM:
            dialog: Dialog[Any] = algorithm_choice(space, recipe, glyphs)
        elif name == "policy":
            dialog = policy_choice(space, recipe, glyphs)
        else:
            dialog = ask_value(name, recipe.hyperparameters.value(name), glyphs, another_run=True)
        self.ask(dialog, partial(self._open_lane, name))

    def _ask_for_ours(self, snapshot: Snapshot) -> None:
        """Ask which of our algorithms is to stand beside a program, and open it."""

        def answered(algorithm: str) -> None:
            self.link.send(AddLane((SwitchAlgorithm(algorithm),)))

        self.ask(choice_beside_program(snapshot.world.space, in_force(snapshot), self.glyphs), answered)

    def _open_lane(self, name: str, value: float | str) -> None:
        if self.snapshot is None:
            return
        try:
            changes = lane_changes(self.snapshot.world.space, in_force(self.snapshot), name, value)
        except UserError as fault:
            self.screen.tell(str(fault), severity="warning")
        else:
            self.link.send(AddLane(changes))


def _only_lane(snapshot: Snapshot) -> LaneView:
    """Return a run that stands alone as the lane it would be."""
    return LaneView(
        name=snapshot.agent.row.name,
        algorithm=snapshot.agent.algorithm,
        hyperparameters=snapshot.agent.hyperparameters,
        step=snapshot.counters.step,
        episodes=snapshot.counters.episodes,
        q=snapshot.agent.q,
        results=snapshot.results,
    )
