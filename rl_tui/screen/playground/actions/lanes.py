"""Runs side by side."""

from __future__ import annotations

from functools import partial
from typing import Final

from rl_tui.agents.catalogue import algorithm_row
from rl_tui.common.errors import UserError
from rl_tui.live.commands import AddBranch, AddLane, ChooseLane, DropLane
from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.recipe import SEED_DRAWS_WORLD, SwitchAlgorithm
from rl_tui.runs.timeline.run_group import ONLY_YOUR_PROGRAM
from rl_tui.screen.board.subject import Subject
from rl_tui.screen.board.wanted import in_force
from rl_tui.screen.dialogs import compare_lanes
from rl_tui.screen.dialogs.choice import algorithm_choice, ask_value, policy_choice
from rl_tui.screen.dialogs.dialog import Confirm
from rl_tui.screen.dialogs.form import Form

ONE_RUN: Final = "only one run is open. c a: add another"


class LaneActions(Subject):
    """Opens, shows and ends runs."""

    def show_runs(self) -> None:
        """Open the table of runs."""
        if self.snapshot is not None:
            self.ask(compare_lanes.RunTable(self.screen.look, self.snapshot), self._compared)

    def why_not(self, deed: str) -> str:
        """Explain why a run cannot be added, shown or ended."""
        snapshot = self.snapshot
        lanes = () if snapshot is None else snapshot.run_group.lanes
        if not lanes and not deed.startswith("another"):
            return ONE_RUN
        if deed == "end" and snapshot is not None and snapshot.program is not None:
            return "your program is in control. c c, then del: end the other run"
        if deed == "one_lane" and not self.board.is_paired and not self.board.is_one_lane:
            return "there is no room for two runs side by side here"
        if not deed.startswith("another"):
            return ""
        if len(lanes) == compare_lanes.MOST_LANES:
            return "four runs are open already. c e: end one"
        world = None if snapshot is None else snapshot.world
        if deed != "another_branch" and world is not None and not world.is_remade:
            return ONLY_YOUR_PROGRAM
        if deed == "another_seed":
            drawn = self.link.wanted.recipe.scenario.section.drawn_from_seed
            return SEED_DRAWS_WORLD if drawn else ""
        if deed == "another_branch" and (snapshot is None or not compare_lanes.branches_beside(snapshot)):
            return "this run has one branch. b, then a change: begin another"
        return ""

    def value(self, deed: str) -> str:
        """Return the value for a menu."""
        group = None if self.snapshot is None else self.snapshot.run_group
        lanes = () if group is None else group.lanes
        if deed == "another_seed" and not self.why_not(deed):
            seeds = (lane.past.begun.seed for lane in lanes if lane.past is not None)
            return str(1 + max(seeds, default=self.link.wanted.recipe.seed))
        if deed == "end" and group is not None and lanes:
            return f"{group.shown + 1}: {lanes[group.shown].name}"
        return f"{len(lanes)} open" if deed == "show_runs" and lanes else ""

    def another_algorithm(self) -> None:
        """Ask for another run's algorithm."""
        self._ask_difference(compare_lanes.ALGORITHM)

    def another_setting(self) -> None:
        """Ask for the setting that differs."""
        if self.snapshot is not None:
            self.ask(compare_lanes.setting_choice(in_force(self.snapshot), self.glyphs), self._ask_difference)

    def another_seed(self) -> None:
        """Add a run with the next seed."""
        self.link.send(AddLane(next_seed=True))

    def another_branch(self) -> None:
        """Ask for the branch to open."""
        if self.snapshot is not None:
            choice = compare_lanes.branch_choice(compare_lanes.branches_beside(self.snapshot), self.glyphs)
            self.ask(choice, lambda branch: self.link.send(AddBranch(int(branch))))

    def end(self) -> None:
        """End the controlled run, after a confirmation."""
        if self.snapshot is not None:
            self._ask_to_end(self.snapshot.run_group.shown)

    def next_lane(self) -> None:
        """Control the next run."""
        if self.snapshot is not None:
            group = self.snapshot.run_group
            self._show_lane((group.shown + 1) % len(group.lanes))

    def one_lane(self) -> None:
        """Switch between one and two visible runs."""
        self.board.turn_lanes()
        if self.board.is_one_lane:
            self.screen.tell("One run is shown. c l: next run, c o: two runs.")
        elif refused := self.why_not("one_lane"):
            self.screen.refuse(refused)

    def _compared(self, answer: compare_lanes.Answer) -> None:
        if isinstance(answer, ChooseLane):
            self._show_lane(answer.lane)
        elif isinstance(answer, DropLane):
            self._ask_to_end(answer.lane)
        else:
            self.link.send(answer)

    def _show_lane(self, lane: int) -> None:
        snapshot = self.snapshot
        if snapshot is not None and snapshot.run_group.shown != lane:
            self.link.wanted.take_over(snapshot.run_group.lanes[lane])
            self.link.send(ChooseLane(lane))

    def _ask_to_end(self, lane: int) -> None:
        if self.snapshot is not None:
            run = self.snapshot.run_group.lanes[lane]
            question = f"{run.name} is at step {run.step:,}. This deletes it from the session."
            title = f"End run {lane + 1}?"
            self.ask(Confirm(title, question, "end it", self.glyphs), lambda _: self._drop_lane(lane))

    def _drop_lane(self, lane: int) -> None:
        snapshot = self.snapshot
        if snapshot is not None:
            lanes = snapshot.run_group.lanes
            if lane == snapshot.run_group.shown:
                # the next run is shown then, or the one before the last
                self.link.wanted.take_over(lanes[lane + 1 if lane + 1 < len(lanes) else lane - 1])
            self.link.send(DropLane(lane))

    def _ask_difference(self, name: str) -> None:
        if self.snapshot is None:
            return
        space, recipe, glyphs = self.snapshot.world.space, in_force(self.snapshot), self.glyphs
        if name == compare_lanes.ALGORITHM and self.snapshot.program is not None:
            self._ask_for_ours(self.snapshot)
            return
        if name == compare_lanes.ALGORITHM:
            title = f"Another algorithm beside {algorithm_row(recipe.algorithm).name}"
            dialog: Form = algorithm_choice(space, recipe, glyphs, title, taken=recipe.algorithm)
        elif name == "policy":
            dialog = policy_choice(space, recipe, glyphs)
        else:
            dialog = ask_value(name, recipe.hyperparameters.value(name), glyphs, another_run=True)
        self.ask(dialog, partial(self._open_lane, name))

    def _ask_for_ours(self, snapshot: Snapshot) -> None:
        def answered(algorithm: str) -> None:
            self.link.send(AddLane((SwitchAlgorithm(algorithm),)))

        space, title = snapshot.world.space, "A built-in agent beside your program"
        choice = algorithm_choice(space, in_force(snapshot), self.glyphs, title)
        self.ask(choice, answered)

    def _open_lane(self, name: str, value: float | str) -> None:
        if self.snapshot is None:
            return
        try:
            changes = compare_lanes.lane_changes(
                self.snapshot.world.space, in_force(self.snapshot), name, value
            )
        except UserError as fault:
            self.screen.tell(str(fault), severity="warning")
        else:
            self.link.send(AddLane(changes))
