"""The runs of a cell: what each seed comes to, as a row. All training of a sweep is done here."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Final

from rl_tui.common.errors import UserError
from rl_tui.common.findings import one_line
from rl_tui.lab.experiments.batched_runs import runs_at_once
from rl_tui.lab.experiments.training import TIME_BUDGET
from rl_tui.lab.run.figures import greedy_figures
from rl_tui.lab.run.recipe import begin
from rl_tui.lab.run.run import Run
from rl_tui.lab.sweeps.cell import Cell
from rl_tui.lab.sweeps.cells.exact_facts import ExactFacts
from rl_tui.lab.sweeps.machine_code import DEMAND
from rl_tui.lab.sweeps.measures import ARRIVED, MEASURES, NEAR
from rl_tui.lab.sweeps.training.batched_figures import batched_figures, loop_in_batches, runs_in_batches

GROWTH: Final = 2.0**0.25
LONGEST_REASON: Final = 200
# So often at least it is asked whether to go on: some 0.1 s
_CHUNK: Final = 2_000_000
_CHUNK_INTERPRETED: Final = 10_000

Figures = Mapping[str, float | int | None]
GoOn = Callable[[], None]


@dataclass(frozen=True, slots=True)
class RunRow:
    """What one seed of a cell came to.

    ``figures`` has every measure by its id, and ``arrived``; they are all None where the run broke down, and
    ``failed`` then says why. ``seconds`` are those of its training and its figures.
    """

    seed: int
    figures: Figures
    failed: str | None = None
    seconds: float = 0.0
    machine: str | None = field(default=None, compare=False)
    """Where it was made; None: here."""


NO_FIGURES: Final[Figures] = dict.fromkeys((*MEASURES, ARRIVED))


def go_on() -> None:
    """Let training go on."""


def run_rows(cell: Cell, seeds: Sequence[int], check: GoOn = go_on) -> Iterator[RunRow]:
    """Yield the row of each of ``seeds`` in ``cell``, in their order.

    A run that breaks down is a row too. ``check`` is called now and then, and may raise to end it.
    """
    waiting, marks = list(seeds), tuple(marks_up_to(cell.goal.episodes or 0))
    while waiting:
        seeded = runs_in_batches(cell) if len(waiting) > 1 else None
        at_once = waiting[: 1 if seeded is None else max(1, runs_at_once(seeded, len(marks)))]
        waiting = waiting[len(at_once) :]
        if seeded is None or len(at_once) == 1:
            yield _row(cell, at_once[0], check)
            continue
        start = time.perf_counter()
        found = batched_figures(cell, seeded, at_once, marks, _arrival_line(cell.content.facts), check)
        seconds = (time.perf_counter() - start) / len(at_once)
        for seed, figures in zip(at_once, found, strict=True):
            # One that broke down has to say by itself why
            yield _row(cell, seed, check) if figures is None else RunRow(seed, figures, None, seconds)


def _row(cell: Cell, seed: int, check: GoOn) -> RunRow:
    start = time.perf_counter()
    try:
        figures, failed = _figures(cell, seed, check), None
    except UserError as reason:
        figures, failed = NO_FIGURES, one_line(str(reason), LONGEST_REASON)
    seconds = time.perf_counter() - start
    loop = loop_in_batches(cell)
    if loop is not None:
        DEMAND.ran(loop, seconds)
    return RunRow(seed, figures, failed, seconds)


def marks_up_to(episodes: int) -> Iterator[int]:
    """Yield after which episodes a run is looked at: 1, 2, 3 …, growing by 2^(1/4), and the last."""
    mark = 1
    while mark < episodes:
        yield mark
        mark = max(mark + 1, int(mark * GROWTH))
    yield episodes


def _figures(cell: Cell, seed: int, check: GoOn) -> Figures:
    recipe = replace(cell.recipe, seed=seed)
    run = Run(recipe, begin(recipe, cell.content.shared), evaluate=False)
    run.learner.set_time_budget(TIME_BUDGET)
    facts = cell.content.facts if cell.content.shared is not None else ExactFacts(run.world.mdp)
    wanted = cell.goal.episodes or 0
    line = None if run.learner.drifted is not None else _arrival_line(facts)
    arrival = _train(run, wanted, line, check)
    if run.learner.drifted is not None:  # each run came to means of its own
        facts = ExactFacts(run.learner.mdp)
    check()
    exact = greedy_figures(run, facts.optimum(recipe.hyperparameters.gamma)) if facts.mdp else None
    return {
        "expected_return": exact.expected_return if exact else None,
        "value_at_start": exact.value_at_start if exact else None,
        "max_error": exact.max_error if exact else None,
        "area": run.mean_return,
        "arrival": arrival,
        "regret": _regret(run, facts),
        "steps": run.step,
        "episodes": run.learner.episodes,
        "return_last_100": run.history.last_100[0],
        ARRIVED: None if line is None else int(arrival is not None),
    }


def _arrival_line(facts: ExactFacts) -> float | None:
    """Return what the greedy policy has to earn to have arrived; None where nobody can say."""
    if facts.mdp is None or facts.best is None or facts.random is None:
        return None
    return facts.best - NEAR * (facts.best - facts.random)


def _train(run: Run, episodes: int, line: float | None, check: GoOn) -> int | None:
    """Train ``run`` for so many ``episodes``; return after which mark its greedy policy reached ``line``.

    None where it did at none, or there is no such line. Raises UserError where the run breaks down.
    """
    arrival = None if line is None else _arrival(run, episodes, line, check)
    _advance(run, episodes, check)
    return arrival


def _arrival(run: Run, episodes: int, line: float, check: GoOn) -> int | None:
    for mark in marks_up_to(episodes):
        _advance(run, mark, check)
        earned = run.greedy_return(run.learner.q, run.recipe.hyperparameters.ties)
        if earned is not None and earned >= line:
            return run.learner.episodes
    return None


def _advance(run: Run, episodes: int, check: GoOn) -> None:
    """Advance ``run`` until it has finished so many ``episodes``. Raises UserError where it breaks down."""
    learner = run.learner
    while learner.episodes < episodes and not run.over:
        check()
        start, was_interpreted = time.perf_counter(), not learner.is_compiled
        run.advance(_CHUNK_INTERPRETED if was_interpreted else _CHUNK, episodes - learner.episodes)
        if was_interpreted:
            DEMAND.ran(learner.loop, time.perf_counter() - start)
    if run.stop_reason:
        raise UserError(run.stop_reason)


def _regret(run: Run, facts: ExactFacts) -> float | None:
    """Return what the episodes of ``run`` lost against the best policy; of a bandit by true means."""
    if run.bandit is not None:
        return None if run.learner.plans else run.bandit.regret
    if facts.best is None or run.mean_return is None:
        return None
    regret = run.learner.episodes * facts.best - run.history.total_return
    return regret if math.isfinite(regret) else None
