"""Control of the run and scenarios."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar, Final

from rl_tui.agents.catalogue import SweepPhase, algorithm_row
from rl_tui.common.errors import ScenarioError, UserError
from rl_tui.common.findings import one_line
from rl_tui.live.commands import Pause, Play, Restart, RunEpisode, RunSweep, SetSpeed, Step, WatchLearning
from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.runs.export.scenario_file import is_on_screen
from rl_tui.runs.library import recipe_with, reread
from rl_tui.runs.recipe import Recipe
from rl_tui.screen.board.subject import Subject
from rl_tui.screen.dialogs.form import Candidate, Choice
from rl_tui.screen.kit.snapshot_facts import why_over
from rl_tui.worlds.files.scenario import Scenario

# The scenario and its file


_NEW: Final = "new"
_OLD: Final = "old"
_LONGEST_NAME: Final = 60
_UNTIL_READ: Final = 15.0


@dataclass(eq=False)
class ScenarioActions(Subject):
    """The way to other scenarios in the list, and a changed file."""

    is_known: bool
    take: Callable[[Recipe], None]
    go_by: Callable[[int], None]
    _declined = ""

    def why_not(self, deed: str) -> str:
        """Explain why there is no settings map."""
        if deed != "map_settings" or self.snapshot is None:
            return ""
        from rl_tui.studies.atlas.request import why_unmapped

        snapshot = self.snapshot
        return why_unmapped(self.link.wanted.recipe, snapshot.world, is_edited=bool(snapshot.world_changes))

    def map_settings(self) -> None:
        """Open the settings map."""
        # late imports, not needed for the first paint
        from rl_tui.screen.atlas.atlas import AtlasDialog
        from rl_tui.studies.atlas.request import surroundings

        if self.snapshot is not None:
            is_awaited = not self.link.player.is_automatic
            request = surroundings(self.link.wanted.recipe, self.snapshot.world, is_awaited=is_awaited)
            self.ask(AtlasDialog(self.screen.look, request), self.take)

    def begin_with_old_or_new(self, start_again: Callable[[], None]) -> None:
        """Restart, after a question if the file has changed."""
        scenario, fault = None, ""
        try:
            if self.is_known and self.link.wanted.lesson is None and not self.screen.in_kiosk:
                scenario = reread(self.link.wanted.recipe.scenario)
        except ScenarioError as error:
            more = f"; and {len(error.faults) - 1} more" if len(error.faults) > 1 else ""
            fault = f"the file has an error, so the old world stays: {error.faults[0]}{more}"
        now = self.snapshot
        if (
            scenario is None
            or scenario.text == self._declined
            # it was saved from here
            or (now is not None and is_on_screen(scenario, now.recipe, now.world.mdp))
        ):
            start_again()
            if fault:
                self._warn(fault)
        else:
            self._ask(scenario, start_again)

    def _ask(self, scenario: Scenario, start_again: Callable[[], None]) -> None:
        def answer(chosen: str) -> None:
            if chosen == _OLD:
                self._declined = scenario.text
                start_again()
                return
            try:
                self.take(recipe_with(scenario, self.link.wanted.recipe))
            except UserError as fault:
                self._warn(str(fault))

        name = one_line(scenario.source.name, _LONGEST_NAME)
        new = Candidate(
            _NEW, "as the file is now", ("Start a new run in the new world. The old run is kept.",)
        )
        old = Candidate(_OLD, "as it was", ("Keep the old world. You are not asked again.",))
        self.ask(Choice(f"Start again: {name} has changed", (new, old), "", self.glyphs), answer)

    def _warn(self, text: str) -> None:
        self.screen.tell(text, severity="warning", timeout=_UNTIL_READ)


# The run


_UNTIL_SEEN = 3600.0
_STEPPING: Final = ("run_or_pause", "watch", "step", "episode")
LADDER: Final[tuple[float | None, ...]] = (
    *(float(digit * 10**power) for power in range(5) for digit in (1, 3)),
    100_000.0,
    None,
)
"""The speeds of + and −, in steps per second (None: as fast as possible)."""


@dataclass(eq=False)
class RunActions(Subject):
    """Starts, pauses, steps and restarts the run."""

    scenario: ScenarioActions
    _told: ClassVar = set[str]()  # messages about machine code that were shown

    def announce(self, now: Snapshot) -> None:
        """Explain once why runs stay interpreted."""
        why = now.playback.stays_interpreted
        if why and why not in self._told:
            self._told.add(why)
            self.screen.tell(why, severity="warning")

    def run_or_pause(self) -> None:
        """Run, or pause."""
        self.link.send(Pause() if self.is_under_way else Play())

    def watch(self) -> None:
        """Run at a speed that follows what is learned."""
        self.link.send(WatchLearning())

    @property
    def is_under_way(self) -> bool:
        """True if there is something to pause."""
        phase = None if self.snapshot is None else self.snapshot.playback.phase
        return phase in (Phase.RUNNING, Phase.SEEKING)

    def rest(self) -> None:
        """Pause a run without a user."""
        if self.is_under_way:
            self.link.send(Pause())
            self.screen.tell("Paused: no key was pressed for several minutes.", timeout=_UNTIL_SEEN)

    def step(self) -> None:
        """Take one step."""
        self.link.send(Step())

    def episode(self) -> None:
        """Run to the episode's end."""
        self.link.send(RunEpisode())

    def sweep(self, phase: SweepPhase) -> None:
        """Run one sweep of policy iteration."""
        self.link.send(RunSweep(phase))

    def why_not(self, deed: str) -> str:
        """Explain why the run cannot step."""
        if deed in _STEPPING:
            return "" if self.link.settled is None else why_over(self.link.settled)
        takes_orders = algorithm_row(self.link.wanted.recipe.algorithm).takes_orders
        if not deed.startswith("sweep") or takes_orders:
            return ""
        if self.snapshot is not None and self.snapshot.world.mdp is None:
            return "only policy iteration has such sweeps, and it needs a transition table"
        return "only policy iteration has such sweeps. a a: choose it"

    def faster(self) -> None:
        """Go to the next higher speed."""
        self.link.send(SetSpeed(faster(self.link.wanted.speed)))

    def slower(self) -> None:
        """Go to the next lower speed."""
        self.link.send(SetSpeed(slower(self.link.wanted.speed)))

    def reset(self) -> None:
        """Restart with the current settings and seed."""
        if self.snapshot is not None and self.snapshot.program is not None:
            self.screen.tell("Your program starts again, from its seed.")
            self.link.send(Restart(self.link.wanted.recipe))
            return
        self.scenario.begin_with_old_or_new(self._start_again)

    def _start_again(self) -> None:
        if self.snapshot is not None and self.snapshot.lesson is not None:
            self.screen.tell("Restarted with your settings. r p: settings of the page.")
        elif self.snapshot is not None and self.snapshot.timeline.current.end:
            kept = "gone (this is a kiosk)" if self.screen.in_kiosk else "kept on the start screen"
            self.screen.tell(f"Started again. The earlier run is {kept}.")
        self.link.send(Restart(self.link.wanted.recipe))


def faster(speed: float | None) -> float | None:
    """Return the next higher speed."""
    if speed is None:
        return None
    return next(each for each in LADDER if each is None or each > speed)


def slower(speed: float | None) -> float | None:
    """Return the next lower speed, or the lowest."""
    below = [each for each in LADDER if each is not None and (speed is None or each < speed)]
    return below[-1] if below else LADDER[0]
