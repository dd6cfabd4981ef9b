"""Going through time: steps and episodes back, any moment, other branches."""

from __future__ import annotations

from dataclasses import replace

from rl_tui.lab.live.commands import ChooseBranch, EpisodeBack, GoTo, StepBack
from rl_tui.lab.live.snapshot import Phase, Snapshot
from rl_tui.tui.panels.timeline.timeline import TimelineBar
from rl_tui.tui.screens.dialogs.goto import goto_prompt, parse_goto
from rl_tui.tui.screens.dialogs.journal import JournalScreen, Moment
from rl_tui.tui.screens.playground.agent_actions import AgentActions


class TimeActions(AgentActions):
    """What a person may ask of time. ``sent`` counts the commands that the player was sent."""

    sent = 0

    def action_step_back(self) -> None:
        """Go one step back."""
        self._go_back(StepBack())

    def action_episode_back(self) -> None:
        """Go back to where the episode began."""
        self._go_back(EpisodeBack())

    def action_go_to(self) -> None:
        """Ask for a step or an episode, and go there."""

        def go(text: float | str | None) -> None:
            if text is not None and self.snapshot is not None:
                self.send(parse_goto(str(text), self.snapshot))

        if self.snapshot is not None:
            self.app.push_screen(goto_prompt(self.snapshot), go)

    def action_branches(self) -> None:
        """Show the branches of the run."""
        if self.snapshot is not None:
            self.app.push_screen(JournalScreen(self.look, self.snapshot), self._go_to_branch)

    def on_timeline_bar_sought(self, event: TimelineBar.Sought) -> None:
        """Go where the timeline was pointed at."""
        self.send(GoTo(event.step))

    def follow_time(self, before: Snapshot | None, now: Snapshot) -> None:
        """Take over what is in force once the player has taken in all that was sent, and announce forks."""
        if now.playback.handled == self.sent:
            self.recipe = replace(
                now.recipe, algorithm=now.agent.algorithm, hyperparameters=now.agent.hyperparameters
            )
            self.board.controls.forget()
            if now.playback.phase is not Phase.SEEKING:
                self.board.timeline.forget()
        if before is not None and _has_forked(before, now):
            branch = now.timeline.current
            parent = now.timeline.branches[branch.parent or 0]
            self.tell(f"{branch.name} begins here; j goes back to {parent.name}")

    def _go_back(self, command: StepBack | EpisodeBack) -> None:
        now = self.snapshot
        if now is not None and now.playback.handled == self.sent and now.counters.step == 0:
            self.tell("this is step 0, where the run begins")
        else:
            self.send(command)

    def _go_to_branch(self, moment: Moment | None) -> None:
        if moment is None or self.snapshot is None:
            return
        if moment.branch != self.snapshot.timeline.branch:
            self.send(ChooseBranch(moment.branch))
        if moment.step is not None:
            self.send(GoTo(moment.step))


def _has_forked(before: Snapshot, now: Snapshot) -> bool:
    """Return whether ``now`` is on a branch that ``before``, a moment of the same run, did not have."""
    is_same_run = before.recipe == now.recipe and before.run_group.shown == now.run_group.shown
    old, new = before.timeline, now.timeline
    return (
        is_same_run
        and before.playback.phase is not Phase.PREPARING
        and len(new.branches) > len(old.branches)
        and new.current.parent is not None
        and new.branch >= len(old.branches)
    )
