"""A run that can go anywhere it has been, and on from there another way."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Final

from rl_tui.agents.kernels.watching import Watching
from rl_tui.common.errors import UserError
from rl_tui.lab.live.snapshot import CellHistory, Timeline
from rl_tui.lab.run.recipe import Beginning, Change, Recipe, begin
from rl_tui.lab.run.run import UNLIMITED, Run, RunState
from rl_tui.lab.timeline.branches import FIRST, Branch
from rl_tui.lab.timeline.checkpoints import Checkpoints
from rl_tui.lab.timeline.memory_limits import limits
from rl_tui.lab.timeline.run_record import RunRecord
from rl_tui.lab.timeline.seek import Goal, Journey
from rl_tui.lab.timeline.table_samples import TableSamples
from rl_tui.worlds.world import World

# Between two states that are kept on a journey it goes on for so many times as long as to keep one takes
_COPY_SHARE: Final = 4


class _Way:
    """A branch with all that was kept on it."""

    def __init__(self, branch: Branch, checkpoints: Checkpoints, samples: TableSamples) -> None:
        self.branch = branch
        self.checkpoints = checkpoints
        self.samples = samples


class BranchingRun:
    """One recipe's run, every branch of it, and the way back.

    It goes on along the journal of the branch in force; a change where the run has been further begins a new
    branch. A journey to another moment is begun by :meth:`go_to` and made by :meth:`travel`, piece by piece;
    until it ends, ``run`` stands where it stood, unless it only has to go on from there. An environment that
    is stepped for real cannot be put back: the journey then begins at the seed. ``clock`` gives seconds.
    """

    def __init__(
        self,
        recipe: Recipe,
        beginning: Beginning,
        *,
        branches: Sequence[Branch] = (),
        branch: int = 0,
        clock: Callable[[], float] = time.perf_counter,
    ) -> None:
        self.recipe = recipe
        self.world: World = beginning.world
        self.run = self._new_run(beginning)
        known = branches or (FIRST,)
        self._ways = [_Way(each, Checkpoints(), TableSamples(self.world.space.pairs)) for each in known]
        self._at = branch
        self._clock = clock
        self._spent = 0.0
        self._travelled = 0.0  # seconds since something was kept on a journey
        self._copying = 0.0  # seconds that keeping it took
        self._spare: Run | None = None
        self._journey: Journey | None = None
        self._watching: Watching | None = None

    @property
    def step(self) -> int:
        """Where it stands."""
        return self.run.step

    @property
    def end(self) -> int:
        """How far the branch in force has come."""
        return self._way.branch.end

    @property
    def timeline(self) -> Timeline:
        """Where it stands, or is to stand once it has arrived, among all that it has been through."""
        return Timeline(self._branches(), self._wanted_branch)

    @property
    def record(self) -> RunRecord:
        """What is needed to come back to here."""
        return RunRecord(self.recipe, self._branches(), self._wanted_branch)

    @property
    def travels(self) -> bool:
        """Whether it is on the way to another moment."""
        return self._journey is not None

    @property
    def progress(self) -> tuple[int, int]:
        """How many steps of the journey are done, and of how many; it may end before the last."""
        return (0, 0) if self._journey is None else self._journey.progress

    @property
    def goal(self) -> Goal | None:
        """Where the journey goes."""
        return None if self._journey is None else self._journey.goal

    def watch(self, watching: Watching | None) -> None:
        """Let :meth:`advance` stop right after what is watched for."""
        self._watching = watching
        self.run.learner.watch(watching)

    def advance(self, steps: int = UNLIMITED, episodes: int = UNLIMITED) -> None:
        """Go on by ``steps`` or ``episodes``, whichever is first, along what is known of the branch."""
        self._go_on(self.run, self._way, self.run.step + steps, self.run.learner.episodes + episodes)

    def apply(self, change: Change) -> None:
        """Change something before the next step; where the run has been further, on a branch of its own.

        Raises UserError where it does not fit, and in a kiosk where there are very many already.
        """
        self._check_room()
        way, applied = self._way, len(self.run.journal)
        _sample(self.run, way)
        step, in_past = self.run.step, self.run.step < way.branch.end
        left = replace(way.branch, here=step)
        self.run.apply(change)
        journal = self.run.journal
        if in_past or applied < len(way.branch.journal):
            name = f"branch {len(self._ways) + 1}"
            branch = Branch(name, journal, self._at, step, step)
            way.branch = left
            self._ways.append(_Way(branch, way.checkpoints.up_to(step, applied), way.samples.up_to(step)))
            self._at = len(self._ways) - 1
            self._thin_out()
        self._way.branch = replace(self._way.branch, journal=journal)
        self._arrived_at(self.run, self._way)

    def _check_room(self) -> None:
        most = limits()
        changes = sum(len(way.branch.journal) for way in self._ways)
        for count, limit, name in (
            (changes, most.changes, "changes"),
            (len(self._ways), most.branches, "branches"),
        ):
            if limit is not None and count >= limit:
                raise UserError(f"{limit:,} {name} are the most in a kiosk; r starts again")

    def go_to(
        self, *, step: int | None = None, episode: int | None = None, branch: int | None = None
    ) -> None:
        """Set out for ``step``, or for where ``episode`` (from 1) begins, at most as far as it has come.

        With ``branch`` alone it is where that one was left. Raises UserError where there is no such branch.
        """
        at = self._at if branch is None else branch
        if not 0 <= at < len(self._ways):
            raise UserError(f"there is no branch {at + 1} here: they are 1 to {len(self._ways)}")
        self._leave()
        way = self._ways[at]
        if step is None and episode is None:
            step = way.branch.here
        goal = Goal(at, None if step is None else max(0, min(step, way.branch.end)), episode)
        self._journey = self._set_out(goal, way)
        self._travelled = 0.0
        if self._journey.done:
            self._arrive(self._journey)

    def travel(self, steps: int) -> int:
        """Go on with the journey by at most ``steps``; return how many were taken."""
        journey = self._journey
        if journey is None:
            return 0
        way = self._ways[journey.goal.branch]
        before, start = journey.run.step, self._clock()
        if before > journey.origin and journey.run is not self.run:
            self._keep_near(journey.run, way)
        self._go_on(journey.run, way, min(before + steps, journey.last_step), journey.last_episode)
        self._travelled += self._clock() - start
        taken = journey.run.step - before
        if taken == 0 and not journey.done:  # it is over before it is there
            way.branch = replace(way.branch, end=journey.run.step)
        if taken == 0 or journey.done:
            self._arrive(journey)
        return taken

    def _keep_near(self, run: Run, way: _Way) -> None:
        """Keep where ``run`` is on its journey, so that the next one is short, unless that slows this one."""
        if not run.learner.rewindable or self._travelled < _COPY_SHARE * self._copying:
            return
        start = self._clock()
        way.checkpoints.add_near(run.checkpoint())
        self._copying = self._clock() - start
        self._travelled = -self._copying  # it is counted with what comes next

    def stay(self) -> None:
        """Give up the journey."""
        self._journey = None
        self.run.learner.watch(self._watching)

    def cell_history(self, pair: int) -> CellHistory:
        """Return how the estimate of ``pair`` came to be what it is."""
        return self._way.samples.history(pair, self.run.step, self.run.learner.q)

    @property
    def _way(self) -> _Way:
        return self._ways[self._at]

    def _branches(self) -> tuple[Branch, ...]:
        branches = [way.branch for way in self._ways]
        at = self._wanted_branch
        step = self.run.step if self.goal is None or self.goal.step is None else self.goal.step
        branches[at] = replace(branches[at], here=step)
        return tuple(branches)

    @property
    def _wanted_branch(self) -> int:
        return self._at if self.goal is None else self.goal.branch

    def _leave(self) -> None:
        self._way.branch = replace(self._way.branch, here=self.run.step)

    def _new_run(self, beginning: Beginning) -> Run:
        run = Run(self.recipe, beginning, episode_limit=self.world.budget)
        run.advance(steps=0)  # the mark of the beginning is taken before anything is shown
        return run

    def _set_out(self, goal: Goal, way: _Way) -> Journey:
        """Begin where the least is to be computed: where it stands, at a checkpoint, or at the seed."""
        start = goal.start_in(way.checkpoints)
        if (
            goal.branch == self._at
            and goal.is_ahead_of(self.run)
            and (start is None or start.step <= self.run.step)
        ):
            run = self.run
        else:
            run = self._run_at(start)
        run.learner.watch(None)
        return Journey(run, goal, way.branch.end)

    def _run_at(self, state: RunState | None) -> Run:
        if state is None:
            # whatever the seed shapes is drawn again, but the same world need not be known twice
            return self._new_run(Beginning(self.world, begin(self.recipe, self.world).streams))
        run = self._spare or self._run_at(None)
        self._spare = None
        run.restore(state)
        return run

    def _arrive(self, journey: Journey) -> None:
        if journey.run is not self.run:
            self._spare = self.run if self.run.learner.rewindable else None
            self.run = journey.run
        # a checkpoint may be older than what was set there last, and at the seed nothing is set yet
        self.run.follow(self._ways[journey.goal.branch].branch.journal, self.run.step)
        if journey.goal.branch != self._at:
            self._at = journey.goal.branch
            self._thin_out()
        self.stay()

    def _thin_out(self) -> None:
        """Let all branches that nobody is on share the memory that is kept for them."""
        left = [way for way in self._ways if way is not self._way]
        for way in left:
            way.checkpoints.thin_out(len(left))
            way.samples.thin_out(len(left))

    def _go_on(self, run: Run, way: _Way, last_step: int, last_episode: int) -> None:
        """Take ``run`` on along ``way``, keeping what is needed to come back."""
        while True:
            _sample(run, way)
            due = way.samples.next_step
            until = last_step if due is None or due < run.step else min(last_step, due)
            before, start = run.step, self._clock()
            run.advance_along(way.branch.journal, until - run.step, last_episode - run.learner.episodes)
            self._spent += self._clock() - start
            if way.checkpoints.any_between(before, run.step):
                self._spent = 0.0  # it has been here before: as many as are needed are kept already
            self._arrived_at(run, way)
            ended = run.step >= last_step or run.learner.episodes >= last_episode
            if ended or run.noticed or run.timed_out or run.over or run.step == before:
                return

    def _arrived_at(self, run: Run, way: _Way) -> None:
        if run.step > way.branch.end:
            way.branch = replace(way.branch, end=run.step)
        if self._spent >= way.checkpoints.spacing and run.learner.rewindable:
            self._spent = 0.0
            way.checkpoints.add(run.checkpoint())


def _sample(run: Run, way: _Way) -> None:
    if way.samples.next_step == run.step:
        way.samples.add(run.learner.q)
