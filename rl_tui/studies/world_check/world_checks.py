"""The check of the visible world, on request."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

from rl_tui.common.kiosk import in_kiosk
from rl_tui.runs.background.background import AnsweringProcess, Background
from rl_tui.runs.exact_answers import LIVE_STATES, NO_TABLE
from rl_tui.runs.library import episodes_of
from rl_tui.studies.world_check.report import CheckStage, WorldReport

if TYPE_CHECKING:
    from rl_tui.runs.run import Run
    from rl_tui.studies.world_check.deep_check import Question
    from rl_tui.worlds.mdp.tabular_mdp import TabularMDP
    from rl_tui.worlds.world import World

    _Process = AnsweringProcess[Question, WorldReport | None]

WORK: Final = "rl_tui.studies.world_check.deep_check:work"
"""Runs in a process of its own, which trains every algorithm."""
KEPT: Final = 4
"""Complete reports that are cached, for worlds and settings visited again."""
IN_KIOSK: Final = "the world check is not available in a kiosk"
TOO_LARGE: Final = f"more than {LIVE_STATES:,} states: run rl-tui check --deep"
NO_PROCESS: Final = "cannot start a process"
BROKEN_OFF: Final = "the rest took too long, or its process was killed"


@dataclass(frozen=True, slots=True, eq=False)
class WorldCheckView:
    """The state of a world check."""

    report: WorldReport | None = None
    """The report, or None while it is pending or if it is refused."""
    world: World | None = None
    """The checked world, or None without a report."""
    gamma: float = 0.0
    refused: str = ""
    """Reason for a missing or incomplete report, else empty."""
    how_long: str = ""
    """Time left, or a note that the machine is busy, empty if unknown."""
    is_outdated: bool = False
    """True if world or settings have changed since."""


def why_unchecked(world: World) -> str:
    """Return why `world` is not checked, or ""."""
    if in_kiosk():
        return IN_KIOSK
    if world.mdp is None:
        return NO_TABLE
    return TOO_LARGE if world.mdp.states > LIVE_STATES else ""


class WorldChecks:
    """Checks one world at a time in a background process.

    An outdated check continues until its exact results are known, so that not every stroke of many starts a
    new one. `on_news` is called from any thread. Without `automatic` each check is awaited.
    """

    def __init__(self, on_news: Callable[[], None], *, automatic: bool) -> None:
        self._automatic = automatic
        self._background = Background["Question", "WorldReport | None"](WORK, on_news)
        self._world: World | None = None
        self._known: list[tuple[Question, WorldCheckView]] = []
        self._last = WorldCheckView()

    def of(self, run: Run) -> WorldCheckView:
        """Return the check of `run` so far, and continue it."""
        mdp, refused = run.world.mdp, why_unchecked(run.world)
        if mdp is None or refused:
            self.end()
            return WorldCheckView(refused=refused)
        self._last = self._of(_question(run, mdp), run.world)
        return self._last

    def _of(self, asked: Question, world: World) -> WorldCheckView:
        process = self._background.process
        if process is None or (_has_figures(process) and not _is_same(process.request, asked)):
            self.end()
            known = next((view for each, view in self._known if _is_same(each, asked)), None)
            if known is not None:
                return known
            process = self._begin(asked, world)
        if process is None:
            return WorldCheckView(refused=NO_PROCESS)
        if _is_same(process.request, asked) and _has_figures(process):
            return self._view(process)
        last = self._last
        if last.report is None:
            return WorldCheckView(how_long=process.how_long)
        return replace(last, refused="", is_outdated=True)

    def _begin(self, asked: Question, world: World) -> _Process | None:
        self._world = world
        try:
            process = self._background.begin(asked, None)
        except OSError:
            return None
        if process is not None and not self._automatic:
            process.wait()
        return process

    def end(self) -> None:
        """End the process, and cache its report if complete."""
        process = self._background.process
        if process is not None and (process.failed or _is_whole(process.known)):
            self._known = [*self._known, (process.request, self._view(process))][-KEPT:]
        self._background.end()

    def close(self) -> None:
        """Stop the current check and refuse new ones. Safe from any thread."""
        self._background.close()

    def _view(self, process: _Process) -> WorldCheckView:
        gamma = process.request.hyperparameters.gamma
        view = WorldCheckView(process.known, self._world, gamma)
        if _is_whole(view.report):
            return view
        if process.failed:
            return replace(view, refused=process.why_failed(BROKEN_OFF))
        return replace(view, how_long=process.how_long)


def _has_figures(process: _Process) -> bool:
    return process.known is not None or bool(process.failed)


def _is_whole(report: WorldReport | None) -> bool:
    return report is not None and report.stage is CheckStage.DONE


def _question(run: Run, mdp: TabularMDP) -> Question:
    from rl_tui.studies.world_check.deep_check import Question

    learner, recipe = run.learner, run.recipe
    # Q₀ applies at the start only, so its current value does not matter
    values = replace(learner.hyperparameters, initial_q=recipe.hyperparameters.initial_q)
    return Question(mdp, learner.algorithm, values, episodes_of(recipe.scenario))


def _is_same(one: Question, other: Question) -> bool:
    return one.mdp is other.mdp and one[1:] == other[1:]
