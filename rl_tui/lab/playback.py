"""A run with a play button, one short piece of work at a time: what a player does, without its thread."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Final

from rl_tui.lab.commands import (
    Apply,
    Command,
    LookAt,
    Pause,
    Play,
    Restart,
    RunEpisode,
    SetSpeed,
    Step,
    Train,
)
from rl_tui.lab.exact import AT_ONCE_STATES, ExactAnswers, exact_now
from rl_tui.lab.pacing import ChunkSize, Pace, SpeedMeter
from rl_tui.lab.preparing import preparing
from rl_tui.lab.recipe import Beginning, Recipe, begin
from rl_tui.lab.snapshot import Phase, Snapshot
from rl_tui.lab.windows import Sight

if TYPE_CHECKING:
    from rl_tui.lab.run import Run

PREPARING: Final = "loading the learner; the very first time it is compiled, which takes a few seconds"


class Playback:
    """Takes commands and works them off in chunks of about 15 ms.

    Call :meth:`work` again and again, as soon as it says; between two calls, :meth:`handle` commands while
    not ``busy`` and take a :meth:`snapshot` where ``changed``. ``clock`` gives seconds. With ``automatic``
    off no step passes but those that Step, RunEpisode and Train ask for. ``on_exact`` is called, from any
    thread, when an exact answer has come that the last snapshot lacked.
    """

    def __init__(
        self,
        recipe: Recipe,
        *,
        speed: float | None,
        automatic: bool,
        clock: Callable[[], float],
        on_exact: Callable[[], None],
    ) -> None:
        self.phase = Phase.PREPARING
        self.changed = False
        self._recipe = recipe
        self._speed = speed
        self._automatic = automatic
        self._clock = clock
        self._on_exact = on_exact
        self._beginning: Beginning | None = None
        self._run: Run | None = None
        self._exact: ExactAnswers | None = None
        self._sight: Sight | None = None  # None: nobody has said what is shown, so everything may be
        self._steps_to_train = 0
        self._episode_to_end: int | None = None
        self._after_loading: Phase | None = None
        self._announced = False
        self._pace = Pace()
        self._chunk = ChunkSize()
        self._meter = SpeedMeter()

    @property
    def busy(self) -> bool:
        """Whether commands have to wait."""
        loading = self._run is None or self._after_loading is not None
        return loading or self._steps_to_train > 0 or (not self._automatic and self.on_the_way)

    @property
    def on_the_way(self) -> bool:
        """Whether something that was asked for and has an end is not done yet."""
        loading = self._run is None or self._after_loading is not None
        return loading or self._steps_to_train > 0 or self._episode_to_end is not None

    def handle(self, command: Command) -> None:
        """Carry out ``command``, or begin to. Raises UserError where a change does not fit."""
        self.changed = True
        if isinstance(command, Restart):
            self._restart(command.recipe)
        elif isinstance(command, SetSpeed):
            self._set_speed(command.speed)
        elif isinstance(command, LookAt):
            self._sight = command.sight
        elif isinstance(command, Apply):
            self._ready_run.apply(command.change)
            self._chunk = ChunkSize()  # a step may now take a thousand times as long
            if self.phase is Phase.DONE and not self._ready_run.over:
                self.phase = Phase.PAUSED  # what was changed gives the planner something to do again
            if not self._ready_run.learner.is_warm:
                self._after_loading, self.phase = self.phase, Phase.PREPARING
                self._announced = False
        elif self.phase not in (Phase.SPENT, Phase.DONE, Phase.STOPPED):
            self._move(command)

    def work(self) -> float | None:
        """Do what is due, for some milliseconds; return in how many seconds to call again, None for never."""
        if self._run is None:
            self._prepare()
            return 0.0
        if self._after_loading is not None:
            self._load(self._run, self._after_loading)
            return 0.0
        if self._steps_to_train:
            self._train()
            return 0.0
        if self._episode_to_end is not None:
            self._finish_episode(self._episode_to_end)
            return 0.0
        if self.phase is not Phase.RUNNING or not self._automatic:
            return None
        if self._speed is None:
            self._advance(self._chunk.steps)
            return 0.0
        return self._keep_pace()

    def snapshot(self) -> Snapshot:
        """Return the newest picture of the run; raises what made an exact answer fail."""
        self.changed = False
        if self._run is None:
            if self._beginning is None:
                raise RuntimeError("there is no world yet")
            return preparing(self._recipe, self._beginning.world, self._speed, PREPARING)
        learner = self._run.learner
        gamma = learner.hyperparameters.gamma
        return self._run.snapshot(
            self.phase,
            message=PREPARING if self._after_loading else self._run.message,
            speed=self._speed,
            steps_per_second=self._meter.steps_per_second,
            answer=exact_now(learner.mdp, gamma) if learner.drifted else self._answers.answer(gamma),
            sight=self._sight,
        )

    @property
    def _ready_run(self) -> Run:
        if self._run is None:
            raise RuntimeError("commands have to wait while playback is busy")
        return self._run

    @property
    def _answers(self) -> ExactAnswers:
        world = self._ready_run.world
        if self._exact is None or self._exact.mdp is not world.mdp:
            self._exact = ExactAnswers(world.mdp, self._on_exact, at_once_states=AT_ONCE_STATES)
        return self._exact

    def _prepare(self) -> None:
        """Build the world; at the next call, load what learns in it."""
        if self._beginning is None:
            self._beginning = begin(self._recipe)
        else:
            self._start_run(self._beginning)
        self.changed = True

    def _start_run(self, beginning: Beginning) -> None:
        from rl_tui.lab.run import Run

        run = Run(self._recipe, beginning, episode_limit=beginning.world.budget)
        run.warm_up()
        self._run = run
        self._chunk = ChunkSize()
        self._answers.answer(run.learner.hyperparameters.gamma)
        self._rest()

    def _load(self, run: Run, phase_after: Phase) -> None:
        """Say that another algorithm is being loaded, which may take seconds; at the next call, load it."""
        if not self._announced:
            self._announced = True
            return
        run.warm_up()
        self.phase, self._after_loading = phase_after, None
        self._meter.clear()
        self.changed = True

    def _restart(self, recipe: Recipe) -> None:
        old = self._ready_run
        known = old.world if recipe.scenario == old.recipe.scenario else None
        self._recipe = recipe
        self._start_run(begin(recipe, known))

    def _set_speed(self, speed: float | None) -> None:
        self._speed = speed
        self._meter.clear()
        if speed is not None:
            self._pace.start(speed, self._clock(), at_once=False)

    def _move(self, command: Play | Pause | Step | RunEpisode | Train) -> None:
        if isinstance(command, Play):
            self._play()
        elif isinstance(command, Train):
            self._steps_to_train = max(0, command.steps)
        elif isinstance(command, RunEpisode):
            self._episode_to_end = self._ready_run.learner.episodes + 1
            self.phase = Phase.RUNNING
        else:
            self._rest()
            if isinstance(command, Step):
                self._ready_run.advance(steps=1)
                self._check_end()

    def _play(self) -> None:
        if self.phase is Phase.RUNNING:
            return
        self.phase = Phase.RUNNING
        self._meter.clear()
        if self._speed is not None:
            self._pace.start(self._speed, self._clock(), at_once=True)

    def _rest(self) -> None:
        self.phase = Phase.PAUSED
        self._steps_to_train = 0
        self._episode_to_end = None
        self._meter.clear()

    def _train(self) -> None:
        self._steps_to_train -= self._advance(min(self._steps_to_train, self._chunk.steps))
        if self._ready_run.over:
            self._steps_to_train = 0
        self.changed = self._steps_to_train == 0

    def _finish_episode(self, last: int) -> None:
        run = self._ready_run
        self._advance(self._chunk.steps, last - run.learner.episodes)
        if run.learner.episodes >= last and not run.over:
            self._rest()

    def _keep_pace(self) -> float:
        now = self._clock()
        due = self._pace.due(now)
        if due > 0:
            self._pace.took(self._advance(min(due, self._chunk.steps)))
        return self._pace.wait(self._clock())

    def _advance(self, steps: int, episodes: int | None = None) -> int:
        """Take at most so many steps, learn how long they take, and return how many they were."""
        run, before, start = self._ready_run, self._ready_run.step, self._clock()
        if episodes is None:
            run.advance(steps)
        else:
            run.advance(steps, episodes)
        now = self._clock()
        taken = run.step - before
        if taken == self._chunk.steps:
            self._chunk.measured(taken, now - start)
        if self._automatic:
            self._meter.note(now, run.step, self._speed)
        self.changed = True
        self._check_end()
        return taken

    def _check_end(self) -> None:
        run = self._ready_run
        if run.over:
            self._rest()
            self.phase = Phase.DONE if run.converged else Phase.SPENT if run.spent else Phase.STOPPED
