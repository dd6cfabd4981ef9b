"""A run that can go anywhere it has been, and on from there another way."""

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
from rl_tui.runs.timeline.table_samples import CellHistory, TableSamples
from rl_tui.runs.timeline.trail import (
    FEW_STEPS,
    MOST_PAIRS,
    MOST_STEPS,
    Trail,
    TrailRecorder,
    TrailReplay,
)

# Between two states that are kept in a seek it goes on for so many times as long as to keep one takes
_COPY_SHARE: Final = 4
_PATIENCE: Final = 0.015  # seconds after which an environment that is stepped is asked for no further step


@dataclass(slots=True, eq=False)
class KeptBranch:
    """A branch with all that is kept of it."""

    branch: Branch
    """Its journal, and how far it has come."""
    checkpoints: Checkpoints
    """States to come back to."""
    samples: TableSamples
    """Copies of Q along the branch."""
    furthest: Furthest | None = None
    """What it had reached at its end, once the run has gone back from there."""


class BranchingRun:
    """One recipe's run, every branch of it, and the way back.

    It begins at the seed, in the world ``first``, on the branch that ``record`` has in force.

    It advances along the journal of the branch in force; a change where the run has been further begins a new
    branch. :meth:`seek_to` begins to seek another step or episode, and :meth:`continue_seek` goes on with
    that, piece by piece; until it is done, ``run`` stands where it stood, unless it only has to advance from
    there. An environment that is stepped for real cannot be put back: then a seek begins at the seed.
    ``clock`` gives seconds.
    """

    def __init__(
        self, record: RunRecord, first: EditedWorld, clock: Callable[[], float] = time.perf_counter
    ) -> None:
        self.recipe = record.recipe
        """What the run was made from."""
        self._first = first
        self._limits = limits()
        self.run = self._run_from_seed()
        """The run as it stands."""
        self.seek: Seek | None = None
        """The way to another step or episode, None where the run is where it has to be."""
        pairs = first.world.space.pairs
        self._branches = [KeptBranch(each, Checkpoints(), TableSamples(pairs)) for each in record.branches]
        self._number = record.branch
        self.kept = self._branches[self._number]
        """The branch in force."""
        self._clock = clock
        self._spent = 0.0
        self._sought = 0.0  # seconds since something was kept in a seek
        self._copying = 0.0  # seconds that keeping it took
        self._spare: Run | None = None
        self.begun_at: int | None = None
        """Where an episode's beginning was asked for: there the end of the one before is not shown."""
        self._recorder = TrailRecorder()
        self._replay: TrailReplay | None = None
        self._watching: Watching | None = None
        self._watched_in = first

    @property
    def timeline(self) -> Timeline:
        """Where the run stands, or is to stand once a seek is done, among all that it has been through."""
        seek, step, number = self.seek, self.run.step, self._number
        if seek is not None:
            target = seek.target
            step, number = step if target.step is None else target.step, target.branch
        branches = [each.branch for each in self._branches]
        branches[number] = replace(branches[number], here=step)
        furthest = self._branches[number].furthest
        if furthest is not None and furthest.counters.step < branches[number].end:
            furthest = None  # it has come further since
        return Timeline(tuple(branches), number, furthest)

    @property
    def record(self) -> RunRecord:
        """What is needed to come back to here."""
        timeline = self.timeline
        return RunRecord(self.recipe, timeline.branches, timeline.branch)

    def record_with(self, changes: Sequence[Change], taken: Callable[[], Sequence[str]]) -> RunRecord:
        """Return the record as it is to be once ``changes`` are made here, as :meth:`apply` makes them."""
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
        """Whether a change made here begins another branch: the run has been further."""
        run, branch = self.run, self.kept.branch
        return run.step < branch.end or run.changes < len(branch.journal)

    def watch(self, watching: Watching | None) -> None:
        """Let :meth:`advance` stop right after what is watched for, until a seek comes to another world."""
        self._watching, self._watched_in = watching, self.run.edited
        self.run.learner.watch(watching)

    def advance(self, steps: int = UNLIMITED, episodes: int = UNLIMITED) -> None:
        """Advance by ``steps`` or ``episodes``, whichever is first, along what is known of the branch.

        It comes back earlier where another loop takes over: there a step may take a thousand times as long.
        """
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
        """Change something before the next step; where the run has been further, on a branch of its own.

        ``taken`` gives names that such a branch must not have. Raises UserError where the change does not
        fit, and in a kiosk where there are very many already.
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
        self._recorder.note(run.learner.last_step, run.world)  # a person may have taken a step
        self._keep(run, kept)

    def _new_name(self, taken: Callable[[], Sequence[str]]) -> str:
        """Return the name of the next branch: a run that began as a branch of another has that one's name."""
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
                raise UserError(f"{limit:,} {name} are the most in a kiosk; r r starts again")

    def seek_to(
        self, *, step: int | None = None, episode: int | None = None, branch: int | None = None
    ) -> None:
        """Begin to seek ``step``, or where ``episode`` (from 1) begins, as far as the branch has come.

        With ``branch`` alone it is the step at which the run stands, or is to stand. Raises UserError where
        there is no such branch, or the environment of a run from the seed cannot be made; the run then stays
        where it stands.
        """
        timeline = self.timeline
        number = timeline.branch if branch is None else branch
        if not 0 <= number < len(self._branches):
            raise UserError(f"there is no branch {number + 1} here: they are 1 to {len(self._branches)}")
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
        """Go on seeking by at most ``steps``, all of one loop; return how many were taken."""
        seek = self.seek
        if seek is None:
            return 0
        run, target, kept = seek.run, seek.target, self._branches[seek.target.branch]
        before, start = run.step, self._clock()
        if before > seek.origin and run is not self.run:
            self._keep_near(run, kept)
        until = min(before + steps, target.last_step, _end_of_loop(run, kept.branch.journal))
        if not run.learner.rewindable and target.step is not None:
            # afterwards nothing can be replayed: the last steps are recorded on the way, one by one
            until = min(until, max(before + 1, target.step - MOST_STEPS))
        self._follow(run, kept, until, target.last_episode)
        if not run.learner.rewindable:
            self._recorder.note(run.learner.last_step, run.world)
        self._sought += self._clock() - start
        taken, done = run.step - before, seek.done
        if taken == 0 and not done:  # the run is over before it is there
            kept.branch = replace(kept.branch, end=run.step, journal=run.journal)
        if taken == 0 or done:
            self._arrive(seek)
        return taken

    def stop_seek(self) -> None:
        """Seek no further; the run stays where it stands."""
        self.seek = None
        if self._watched_in is not self.run.edited:
            self._watching = None  # other states and pairs have its numbers here
        self.run.learner.watch(self._watching)

    @property
    def trail(self) -> Trail:
        """The steps of the episode up to the last one, as far as they are known; none while it seeks."""
        return self._recorder.up_to(self.run.learner.last_step)

    @property
    def trail_to_find(self) -> int:
        """How many steps the trail has once :meth:`find_trail` is done; 0 where it finds no more of them."""
        learner, recorder = self.run.learner, self._recorder
        last = learner.last_step
        if last is None or last.planned or recorder.given_up == last.step or self.seek is not None:
            return 0
        # No step in another world is part of it
        steps = min(MOST_STEPS, last.episode_step, last.step - learner.world_since)
        if len(recorder.up_to(last)) == steps:
            return 0
        return steps if learner.rewindable and learner.space.pairs <= MOST_PAIRS else 0

    def find_trail(self, seconds: float) -> None:
        """Replay what is missing of the trail, for about ``seconds``; call it again for more.

        Another run replays it, which leaves this one as it is.
        """
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
        """Return how the estimate of ``pair`` came to be what it is; None if the world has no such pair."""
        run, changes = self.run, self.run.world_changes
        if pair >= run.world.space.pairs:
            return None
        since = changes[-1].step if changes else None
        return self.kept.samples.history(pair, run.step, run.learner.q, since)

    def _run_from_seed(self) -> Run:
        # whatever the seed shapes is drawn again, but the same world need not be known twice
        world = self._first.world
        beginning = Beginning(world, begin(self.recipe, world).streams)
        run = Run(self.recipe, beginning, edited=self._first, episode_limit=world.budget)
        run.advance(steps=0)  # the mark of the beginning is taken before anything is shown
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
        # a checkpoint may be older than what was set there last, and at the seed nothing is set yet
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
        """Let the branch with this ``number`` be in force; all others share the memory kept for them."""
        self._number, self.kept = number, self._branches[number]
        self._recorder.given_up = -1  # it was for a step of another branch
        left = [each for each in self._branches if each is not self.kept]
        for each in left:
            each.checkpoints.thin_out(len(left))
            each.samples.thin_out(len(left))

    def _follow(self, run: Run, kept: KeptBranch, last_step: int, last_episode: int) -> None:
        """Advance ``run`` along the branch ``kept``, keeping what is needed to come back."""
        while True:
            if kept.samples.next_step == run.step:
                kept.samples.add(run.learner.q)
            due, before, start = kept.samples.next_step, run.step, self._clock()
            until = last_step if due is None or due < before else min(last_step, due)
            run.follow(kept.branch.journal, until, last_episode)
            self._spent += self._clock() - start
            if before < kept.branch.end and kept.checkpoints.any_between(before, run.step):
                self._spent = 0.0  # it has been here before: as many as are needed are kept already
            self._keep(run, kept)
            ended = run.step >= last_step or run.learner.episodes >= last_episode
            if ended or run.noticed or run.timed_out or run.over or run.step == before:
                return

    def _keep(self, run: Run, kept: KeptBranch) -> None:
        """Note how far the branch ``kept`` has come, and keep a checkpoint if one is due."""
        if run.step > kept.branch.end:
            kept.branch = replace(kept.branch, end=run.step)
        if self._spent >= kept.checkpoints.spacing and run.learner.rewindable:
            self._spent = 0.0
            kept.checkpoints.add(run.checkpoint())

    def _keep_near(self, run: Run, kept: KeptBranch) -> None:
        """Keep where ``run`` is, so that the next seek is short, unless that slows this one."""
        if not run.learner.rewindable or self._sought < _COPY_SHARE * self._copying:
            return
        start = self._clock()
        kept.checkpoints.add_near(run.checkpoint())
        self._copying = self._clock() - start
        self._sought = -self._copying  # it is counted with what comes next


def _end_of_loop(run: Run, journal: Sequence[JournalEntry]) -> int:
    """Return the step at which ``run`` goes on in another loop, which may not be there as machine code."""
    for entry in journal[run.changes :]:
        change = entry.change
        is_other = isinstance(change, SwitchAlgorithm) or (
            isinstance(change, SetParameter) and change.name == "policy"
        )
        if is_other and entry.step > run.step:
            return entry.step
    return UNLIMITED
