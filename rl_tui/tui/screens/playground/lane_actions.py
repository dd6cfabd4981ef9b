"""Runs side by side."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from rl_tui.agents.catalogue import BY_ID
from rl_tui.agents.hyperparameters import PARAMETERS
from rl_tui.common.errors import UserError
from rl_tui.lab.live.commands import AddLane, ChooseLane, DropLane
from rl_tui.lab.live.snapshot import Snapshot
from rl_tui.lab.run.recipe import Recipe
from rl_tui.lab.timeline.lane_view import LaneView
from rl_tui.tui.screens.dialogs.choice import algorithm_choice, policy_choice, word_choice
from rl_tui.tui.screens.dialogs.compare import Answer, Compare
from rl_tui.tui.screens.dialogs.lane_changes import ALGORITHM, lane_changes
from rl_tui.tui.screens.dialogs.questions import ask_number
from rl_tui.tui.screens.playground.agent_actions import AgentActions
from rl_tui.worlds.drawing import Arms


class LaneActions(AgentActions):
    """Opening, showing and ending lanes."""

    def action_compare(self) -> None:
        """Choose what is different in another lane, or which lane to show or to end."""
        snapshot = self.snapshot
        if snapshot is None:
            return
        hidden = isinstance(snapshot.world.drawing, Arms) and not self.board.curve.tells_all
        lanes = snapshot.run_group.lanes or (_only_lane(snapshot),)
        dialog = Compare(self.look, lanes, snapshot.run_group.shown, in_force(snapshot), hidden=hidden)
        self.app.push_screen(dialog, self._compared)

    def action_lane(self) -> None:
        """Show the next lane."""
        snapshot = self.snapshot
        if snapshot is None or not snapshot.run_group.lanes:
            self.tell("there is one run only; c opens a second one beside it")
            return
        self._show_lane((snapshot.run_group.shown + 1) % len(snapshot.run_group.lanes))

    def _compared(self, answer: Answer | None) -> None:
        if isinstance(answer, ChooseLane):
            self._show_lane(answer.lane)
        elif isinstance(answer, DropLane):
            self._drop_lane(answer.lane)
        elif answer is not None:
            self._ask_difference(answer)

    def _show_lane(self, lane: int) -> None:
        snapshot = self.snapshot
        if snapshot is not None and snapshot.run_group.shown != lane:
            self._take_over(snapshot.run_group.lanes[lane])
            self.send(ChooseLane(lane))

    def _drop_lane(self, lane: int) -> None:
        snapshot = self.snapshot
        if snapshot is not None:
            lanes = snapshot.run_group.lanes
            if lane == snapshot.run_group.shown:
                # then the next one is shown, or the one before where it was the last
                self._take_over(lanes[lane + 1 if lane + 1 < len(lanes) else lane - 1])
            self.send(DropLane(lane))

    def _take_over(self, lane: LaneView) -> None:
        """Let whatever is changed from here on start from what is in force in ``lane``."""
        self.recipe = replace(self.recipe, algorithm=lane.algorithm, hyperparameters=lane.hyperparameters)
        self.board.controls.forget()

    def _ask_difference(self, name: str) -> None:
        """Ask what ``name`` is to be in another lane, and open it."""
        if self.snapshot is None:
            return
        space, recipe, glyphs = self.snapshot.world.space, in_force(self.snapshot), self.look.glyphs
        answered = self._opener(name)
        if name == ALGORITHM:
            self.app.push_screen(algorithm_choice(space, recipe, glyphs), answered)
        elif name == "policy":
            self.app.push_screen(policy_choice(space, recipe, glyphs), answered)
        elif PARAMETERS[name].range is None:
            self.app.push_screen(word_choice(name, recipe.hyperparameters.value(name), glyphs), answered)
        else:
            value = recipe.hyperparameters.value(name)
            self.app.push_screen(ask_number(name, value, glyphs, another_run=True), answered)

    def _opener(self, name: str) -> Callable[[float | str | None], None]:
        def open_lane(value: float | str | None) -> None:
            if value is None or self.snapshot is None:
                return
            try:
                changes = lane_changes(self.snapshot.world.space, in_force(self.snapshot), name, value)
            except UserError as fault:
                self.notify(str(fault), severity="warning", markup=False)
            else:
                self.send(AddLane(changes))

        return open_lane


def in_force(snapshot: Snapshot) -> Recipe:
    """Return the recipe of the run shown with the settings in force at this moment."""
    return replace(
        snapshot.recipe, algorithm=snapshot.agent.algorithm, hyperparameters=snapshot.agent.hyperparameters
    )


def _only_lane(snapshot: Snapshot) -> LaneView:
    """Return a run that stands alone as the lane it would be."""
    return LaneView(
        name=BY_ID[snapshot.agent.algorithm].name,
        algorithm=snapshot.agent.algorithm,
        hyperparameters=snapshot.agent.hyperparameters,
        step=snapshot.counters.step,
        episodes=snapshot.counters.episodes,
        q=snapshot.agent.q,
        results=snapshot.results,
    )
