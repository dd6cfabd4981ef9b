"""Travel in time, and between branches."""

from __future__ import annotations

from rl_tui.live.commands import AddBranch, ChooseBranch, EpisodeBack, GoTo, StepBack
from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.screen.board.subject import Subject
from rl_tui.screen.dialogs.journal import BRANCHES, JournalScreen, Moment, goto_form, parse_goto, unit_of
from rl_tui.screen.kit.snapshot_facts import episode_shown


class TimeActions(Subject):
    """Moves in time and between branches."""

    _sought_episode: int | None = None  # the episode that the run seeks
    _sought_branch: int | None = None
    """The branch that the run goes to."""

    def why_not(self, deed: str) -> str:
        """Explain why the run cannot go to another moment."""
        snapshot = self.snapshot
        if deed in ("step_back", "episode_back"):
            is_at_start = self.link.settled is not None and not self.link.settled.counters.step
            return "this is step 0, the start of the run" if is_at_start else ""
        is_prepared = snapshot is None or snapshot.playback.phase is not Phase.PREPARING
        is_to_choose = deed in ("go_to", "show_branches")
        if snapshot is None or is_prepared or not is_to_choose or snapshot.counters.step:
            return ""
        return "the run is being prepared"

    def value(self, deed: str) -> str:
        """Return the number of branches."""
        count = 0 if self.snapshot is None else len(self.snapshot.timeline.branches)
        return str(count) if deed == "show_branches" and count > 1 else ""

    def step_back(self) -> None:
        """Go one step back."""
        self.link.send(StepBack())

    def episode_back(self) -> None:
        """Go to the start of the episode."""
        self.link.send(EpisodeBack())

    def go_to(self) -> None:
        """Ask for a moment, and go there."""

        def go(text: float | str) -> None:
            if text == BRANCHES:
                self.show_branches()
            elif self.snapshot is not None:
                command = parse_goto(str(text), self.snapshot)
                self._sought_episode = command.episode
                self.link.send(command)

        if self.snapshot is not None:
            self.ask(goto_form(self.snapshot, self.glyphs), go)

    def show_branches(self) -> None:
        """Open the list of branches."""
        if self.snapshot is not None:
            self.ask(JournalScreen(self.screen.look, self.snapshot), self._go_to_branch)

    def to_end(self) -> None:
        """Go to the run's end so far."""
        if self.snapshot is not None:
            self.seek(self.snapshot.timeline.current.end)

    def seek(self, step: int) -> None:
        """Go to the timeline's step."""
        self.link.wanted.step = step
        self.link.send(GoTo(step))

    def announce(self, before: Snapshot | None, now: Snapshot) -> None:
        """Announce a new branch, and the arrival."""
        if before is not None and _has_forked(before, now):
            branch = now.timeline.current
            parent = now.timeline.branches[branch.parent or 0]
            self.screen.tell(f"{branch.name} begins here. m b: back to {parent.name}.")
        episode, sought = self._sought_episode, self._sought_branch
        if episode is None and sought is None:
            return
        if now.playback.phase is Phase.SEEKING or not self.link.wanted.is_taken_in(now):
            return
        self._sought_episode = self._sought_branch = None
        # stopped in the past: the end of the run is not known there
        if episode is not None and now.counters.episodes < episode - 1 and not now.timeline.in_past:
            here = f"{unit_of(now)} {episode_shown(now):,}, step {now.counters.step:,}"
            self.screen.tell(f"End of the run so far ({here}). space: continue.")
        if sought is not None and sought == now.timeline.branch:
            unit = "pull" if now.world.is_bandit else "step"
            stays = "as before" if now.timeline.in_past else "its latest step"
            self.screen.tell(f"{now.timeline.current.name}, {unit} {now.counters.step:,}: {stays}")

    def _go_to_branch(self, moment: Moment | AddBranch) -> None:
        if isinstance(moment, AddBranch):
            self.link.send(moment)
            return
        if self.snapshot is not None and moment.branch != self.snapshot.timeline.branch:
            self._sought_branch = moment.branch if moment.step is None else None
            self.link.send(ChooseBranch(moment.branch))
        if moment.step is not None:
            self.link.send(GoTo(moment.step))


def _has_forked(before: Snapshot, now: Snapshot) -> bool:
    is_same_run = before.recipe == now.recipe and before.run_group.shown == now.run_group.shown
    old, new = before.timeline, now.timeline
    return (
        is_same_run
        and before.playback.phase is not Phase.PREPARING
        and len(new.branches) > len(old.branches)
        and new.current.parent is not None
        and new.branch >= len(old.branches)
    )
