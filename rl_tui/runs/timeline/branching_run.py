"""A run that can return to any earlier step and branch from there."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Final

from rl_tui.agents.kernels.watch import Watching
from rl_tui.common.errors import UserError
from rl_tui.runs.edited_world import EditedWorld
from rl_tui.runs.recipe import (
    UNLIMITED,
    Beginning,
    Change,
    JournalEntry,
    SetParameter,
    SwitchAlgorithm,
    begin,
)
from rl_tui.runs.run import Run, RunState
from rl_tui.runs.timeline.branches import Branch, Furthest, RunRecord, Timeline
from rl_tui.runs.timeline.checkpoints import Checkpoints, Seek, Target, limits
from rl_tui.runs.timeline.table_samples import CellHistory, ErrorHistory, TableSamples
from rl_tui.runs.timeline.trail import (
    FEW_STEPS,
    MOST_PAIRS,
    MOST_STEPS,
    Trail,
    TrailRecorder,
    TrailReplay,
)

# While seeking, the time between two stored states is at least this many times the time to store one
from rl_tui.worlds.mdp.space import FloatArray

_COPY_SHARE: Final = 4
_PATIENCE: Final = 0.015  # seconds after which a simulated environment takes no further step


@dataclass(slots=True, eq=False)
class KeptBranch:
    """A branch with its stored states."""

    branch: Branch
    """Journal and furthest step."""
    checkpoints: Checkpoints
    """States to return to."""
    samples: TableSamples
    """Copies of Q along the branch."""
    furthest: Furthest | None = None
    """Results at its end, once the run has gone back."""


class BranchingRun:
    """The run of one recipe with all its branches.

    A change in the past begins a new branch. `seek_to` starts the way to another position, and
    `continue_seek` continues it. A simulated environment cannot be reset to a state, so each seek starts at
    the seed.
    """

    def __init__(
        self, record: RunRecord, first: EditedWorld, clock: Callable[[], float] = time.perf_counter
    ) -> None:
        self.recipe = record.recipe
        self._first = first
        self._limits = limits()
        self.run = self._run_from_seed()
        self.seek: Seek | None = None
        pairs = first.world.space.pairs
        self._branches = [KeptBranch(each, Checkpoints(), TableSamples(pairs)) for each in record.branches]
        self._number = record.branch
        self.kept = self._branches[self._number]
        self._clock = clock
        self._spent = 0.0
        self._sought = 0.0  # seconds since a state was stored while seeking
        self._copying = 0.0  # seconds that storing it took
        self._spare: Run | None = None
        self.begun_at: int | None = None
        """Step at which an episode was sought by its beginning. The end of the previous episode is not
        shown there.
        """
        self._recorder = TrailRecorder()
        self._replay: TrailReplay | None = None
        self._watching: Watching | None = None
        self._watched_in = first

    @property
    def timeline(self) -> Timeline:
        """Position among all branches, that of the target during a seek."""
        seek, step, number = self.seek, self.run.step, self._number
        if seek is not None:
            target = seek.target
            step, number = step if target.step is None else target.step, target.branch
        branches = [each.branch for each in self._branches]
        branches[number] = replace(branches[number], here=step)
        furthest = self._branches[number].furthest
        if furthest is not None and furthest.counters.step < branches[number].end:
            furthest = None  # it has advanced further since
        return Timeline(tuple(branches), number, furthest)

    @property
    def record(self) -> RunRecord:
        """Record of the current position."""
        timeline = self.timeline
        return RunRecord(self.recipe, timeline.branches, timeline.branch)

    def record_with(self, changes: Sequence[Change], taken: Callable[[], Sequence[str]]) -> RunRecord:
        """Return the record as if `apply` had made `changes` here."""
        record, step = self.record, self.run.step
        if not changes:
            return record
        journal = (*self.run.journal, *(JournalEntry(step, change) for change in changes))
        branches, number = record.branches, record.branch
        if self._forks:
            forked = Branch(self._new_name(taken), journal, number, step, step, step)
            return RunRecord(self.recipe, (*branches, forked), len(branches))
        going_on = replace(branches[number], journal=journal)
        return RunRecord(self.recipe, (*branches[:number], going_on, *branches[number + 1 :]), number)

    @property
    def _forks(self) -> bool:
        run, branch = self.run, self.kept.branch
        return run.step < branch.end or run.changes < len(branch.journal)

    def watch(self, watching: Watching | None) -> None:
        """Stop `advance` right after an event, until a seek reaches another world."""
        self._watching, self._watched_in = watching, self.run.edited
        self.run.learner.watch(watching)

    def advance(self, steps: int = UNLIMITED, episodes: int = UNLIMITED) -> None:
        """Advance by at most `steps` and `episodes`, or until another loop takes over."""
        run, kept = self.run, self.kept
        until = min(run.step + steps, _end_of_loop(run, kept.branch.journal))
        last_episode = run.learner.episodes + episodes
        if not 0 < steps <= FEW_STEPS:
            self._follow(run, kept, until, last_episode)
            return
        before, start = -1, self._clock()
        while before < run.step < until and run.learner.episodes < last_episode:
            before = run.step
            self._follow(run, kept, before + 1, last_episode)
            self._recorder.note(run.learner.last_step, run.world)
            takes_long = not run.learner.rewindable and self._clock() - start > _PATIENCE
            if run.noticed or run.over or takes_long:
                return

    def apply(self, change: Change, taken: Callable[[], Sequence[str]] = tuple) -> None:
        """Make a change, on a new branch if the run has been further.

        `taken` returns names that a new branch must not have. Raises UserError.
        """
        self._check_room()
        kept, run, applied = self.kept, self.run, self.run.changes
        if kept.samples.next_step == run.step:
            kept.samples.add(run.learner.q)
        step, forks = run.step, self._forks
        left = replace(kept.branch, here=step)
        run.apply(change)
        journal = run.journal
        if forks:
            branch = Branch(self._new_name(taken), journal, self._number, step, step)
            kept.branch = left
            kept = KeptBranch(branch, kept.checkpoints.up_to(step, applied), kept.samples.up_to(step))
            self._branches.append(kept)
            self._put_in_force(len(self._branches) - 1)
        kept.branch = replace(kept.branch, journal=journal)
        self._recorder.note(run.learner.last_step, run.world)  # the user may have taken a step
        self._keep(run, kept)

    def _new_name(self, taken: Callable[[], Sequence[str]]) -> str:
        names, number = {*taken(), *(each.branch.name for each in self._branches)}, len(self._branches) + 1
        while f"branch {number}" in names:
            number += 1
        return f"branch {number}"

    def _check_room(self) -> None:
        most = self._limits
        changes = sum(len(each.branch.journal) for each in self._branches)
        for count, limit, name in (
            (changes, most.changes, "changes"),
            (len(self._branches), most.branches, "branches"),
        ):
            if limit is not None and count >= limit:
                raise UserError(f"a kiosk allows at most {limit:,} {name}; r r starts again")

    def seek_to(
        self, *, step: int | None = None, episode: int | None = None, branch: int | None = None
    ) -> None:
        """Start to seek a step, or an episode from 1, as far as reached.

        A `branch` alone seeks the current step there. After a UserError the run keeps its position.
        """
        timeline = self.timeline
        number = timeline.branch if branch is None else branch
        if not 0 <= number < len(self._branches):
            raise UserError(f"there is no branch {number + 1}: choose 1 to {len(self._branches)}")
        run, kept = self.run, self._branches[number]
        self.kept.branch = replace(self.kept.branch, here=run.step)
        if run.step == self.kept.branch.end:
            self.kept.furthest = Furthest(run.learner.counters, run.results)
        if step is None and episode is None:
            step = timeline.current.here
        target = Target(number, kept.branch.end, step=step, episode=episode)
        start = kept.checkpoints.last_before(target)
        stays = number == self._number and (start is None or start.step <= run.step)
        if not (stays and target.is_ahead_of(run.step, run.learner.episodes, run.learner.begins_episode)):
            run = self._run_at(start)
        run.learner.watch(None)
        self._sought = 0.0
        self.seek = Seek(run, target, run.step)
        if self.seek.done:
            self._arrive(self.seek)

    def continue_seek(self, steps: int) -> int:
        """Seek by at most `steps` of one loop and return the steps taken."""
        seek = self.seek
        if seek is None:
            return 0
        run, target, kept = seek.run, seek.target, self._branches[seek.target.branch]
        before, start = run.step, self._clock()
        if before > seek.origin and run is not self.run:
            self._keep_near(run, kept)
        until = min(before + steps, target.last_step, _end_of_loop(run, kept.branch.journal))
        if not run.learner.rewindable and target.step is not None:
            # a simulated run cannot be replayed later, so its last steps are recorded one by one
            until = min(until, max(before + 1, target.step - MOST_STEPS))
        self._follow(run, kept, until, target.last_episode)
        if not run.learner.rewindable:
            self._recorder.note(run.learner.last_step, run.world)
        self._sought += self._clock() - start
        taken, done = run.step - before, seek.done
        if taken == 0 and not done:  # the run ended before the target
            kept.branch = replace(kept.branch, end=run.step, journal=run.journal)
        if taken == 0 or done:
            self._arrive(seek)
        return taken

    def stop_seek(self) -> None:
        """Stop seeking, at the current position."""
        self.seek = None
        if self._watched_in is not self.run.edited:
            self._watching = None  # the numbers mean other states and pairs in this world
        self.run.learner.watch(self._watching)

    @property
    def trail(self) -> Trail:
        """Known steps of the current episode, none while seeking."""
        return self._recorder.up_to(self.run.learner.last_step)

    @property
    def trail_to_find(self) -> int:
        """Length of the trail after `find_trail`, or 0."""
        learner, recorder = self.run.learner, self._recorder
        last = learner.last_step
        if last is None or last.planned or recorder.given_up == last.step or self.seek is not None:
            return 0
        # steps in an earlier world are not part of it
        steps = min(MOST_STEPS, last.episode_step, last.step - learner.world_since)
        if len(recorder.up_to(last)) == steps:
            return 0
        return steps if learner.rewindable and learner.space.pairs <= MOST_PAIRS else 0

    def find_trail(self, seconds: float) -> None:
        """Replay missing steps of the trail in another run for about `seconds`."""
        steps, last = self.trail_to_find, self.run.step
        if not steps:
            return
        if self._replay is None or self._replay.last != last:
            first = last - steps
            start = self.kept.checkpoints.last_before(Target(self._number, last, step=first))
            journal = self.kept.branch.journal
            self._replay = TrailReplay(self._run_at(start), journal, first, last, self._recorder)
        if self._replay.go_on(seconds, self._clock):
            self._spare, self._replay = self._replay.run, None

    def cell_history(self, pair: int) -> CellHistory | None:
        """Return the history of the estimate of `pair`, or None."""
        run, changes = self.run, self.run.world_changes
        if pair >= run.world.space.pairs:
            return None
        since = changes[-1].step if changes else None
        return self.kept.samples.history(pair, run.step, run.learner.q, since)

    def value_errors(self, exact: FloatArray) -> ErrorHistory:
        """Return the history of the distance from the `exact` values, `[P]`."""
        run, changes = self.run, self.run.world_changes
        since = changes[-1].step if changes else None
        return self.kept.samples.errors(exact, run.step, run.learner.q, since)

    def _run_from_seed(self) -> Run:
        # draw again what depends on the seed, but share an equal world
        world = self._first.world
        beginning = Beginning(world, begin(self.recipe, world).streams)
        run = Run(self.recipe, beginning, edited=self._first, episode_limit=world.budget)
        run.advance(steps=0)  # take the first mark before anything is shown
        return run

    def _run_at(self, state: RunState | None) -> Run:
        if state is None:
            return self._run_from_seed()
        run = self._spare or self._run_from_seed()
        self._spare = None
        run.restore(state)
        return run

    def _arrive(self, seek: Seek) -> None:
        run, number = seek.run, seek.target.branch
        if run is not self.run:
            self._spare = self.run if self.run.learner.rewindable else None
            self.run = run
        # the checkpoint may precede settings of this step
        run.follow(self._branches[number].branch.journal, run.step)
        self._recorder.go_back(run.step)
        self._replay = None
        self.begun_at = run.step if seek.target.step is None else None
        if number != self._number:
            if run.learner.rewindable:
                self._recorder.forget()
            self._put_in_force(number)
        self.stop_seek()

    def _put_in_force(self, number: int) -> None:
        self._number, self.kept = number, self._branches[number]
        self._recorder.given_up = -1  # it belonged to another branch
        left = [each for each in self._branches if each is not self.kept]
        for each in left:
            each.checkpoints.thin_out(len(left))
            each.samples.thin_out(len(left))

    def _follow(self, run: Run, kept: KeptBranch, last_step: int, last_episode: int) -> None:
        while True:
            if kept.samples.next_step == run.step:
                kept.samples.add(run.learner.q)
            due, before, start = kept.samples.next_step, run.step, self._clock()
            until = last_step if due is None or due < before else min(last_step, due)
            run.follow(kept.branch.journal, until, last_episode)
            self._spent += self._clock() - start
            if before < kept.branch.end and kept.checkpoints.any_between(before, run.step):
                self._spent = 0.0  # enough states were stored on the first visit
            self._keep(run, kept)
            ended = run.step >= last_step or run.learner.episodes >= last_episode
            if ended or run.noticed or run.timed_out or run.over or run.step == before:
                return

    def _keep(self, run: Run, kept: KeptBranch) -> None:
        if run.step > kept.branch.end:
            kept.branch = replace(kept.branch, end=run.step)
        if self._spent >= kept.checkpoints.spacing and run.learner.rewindable:
            self._spent = 0.0
            kept.checkpoints.add(run.checkpoint())

    def _keep_near(self, run: Run, kept: KeptBranch) -> None:
        """Store the position for a short next seek, unless that slows this one down."""
        if not run.learner.rewindable or self._sought < _COPY_SHARE * self._copying:
            return
        start = self._clock()
        kept.checkpoints.add_near(run.checkpoint())
        self._copying = self._clock() - start
        self._sought = -self._copying  # so that its duration is included in the next interval


def _end_of_loop(run: Run, journal: Sequence[JournalEntry]) -> int:
    """Return the step at which another loop takes over, perhaps not compiled yet."""
    for entry in journal[run.changes :]:
        change = entry.change
        is_other = isinstance(change, SwitchAlgorithm) or (
            isinstance(change, SetParameter) and change.name == "policy"
        )
        if is_other and entry.step > run.step:
            return entry.step
    return UNLIMITED
