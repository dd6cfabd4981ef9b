"""Snapshots of small worlds made by hand."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any, TypeVar, cast

import numpy as np
from sample_worlds import (
    BIG_LAKE,
    TRUE_MEANS,
    bandit_world,
    best_values,
    exact_solution,
    lake_world,
    learned_q,
    student_world,
)
from snapshots import changed

from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.agents.last_step import NOTHING, LastStep
from rl_tui.live.snapshot import Phase, PlaybackView, Snapshot
from rl_tui.live.snapshot_builder import SnapshotBuilder
from rl_tui.runs.bandit import BanditFigures
from rl_tui.runs.recipe import Recipe
from rl_tui.runs.results import Curve, Marks
from rl_tui.screen.theme.glyphs import ASCII, UNICODE
from rl_tui.screen.theme.look import Look, palette_for
from rl_tui.worlds.files.scenario import Scenario
from rl_tui.worlds.gym.section import GymnasiumSection
from rl_tui.worlds.mdp.space import FiniteSpace
from rl_tui.worlds.world import World


def look(ascii: bool = False, depth: str = "truecolor", dark: bool = True) -> Look:  # noqa: A002
    return Look(ASCII if ascii else UNICODE, palette_for(cast("Any", depth), dark))


def learned_from(last: LastStep, **terms: Any) -> LastStep:
    other = replace(last, **terms)
    bootstraps = other.learned and not other.planned and not other.terminated
    other = replace(other, bootstrap_state=other.next_state if bootstraps else NOTHING)
    return replace(other, after=other.before + other.step_size * other.td_error)


def scenario(id: str, title: str, kind: str) -> Scenario:  # noqa: A002
    """A scenario that is never built: the samples already have their worlds."""
    section: Any = SimpleNamespace(drawn_from_seed=kind == "bandit")
    return Scenario(
        id=id,
        title=title,
        summary=f"{title}, a sample",
        notes="Sample notes.",
        order=0,
        kind=kind,
        defaults={},
        source=Path(f"{id}.toml"),
        section=GymnasiumSection(id="FrozenLake-v1") if kind == "gymnasium" else section,
        hides_answer=kind == "bandit",
    )


def snapshot(world: World, name: Scenario, hyperparameters: Hyperparameters, **changes: Any) -> Snapshot:
    space = world.space
    recipe = Recipe(name, "q-learning", hyperparameters, seed=0)
    start = SnapshotBuilder().before(
        recipe, world, PlaybackView(Phase.PAUSED, speed=10.0), is_hidden=name.hides_answer
    )
    usual = {"q": np.zeros(space.pairs), "state": int(space.start_state[0]), "bandit": None}
    return changed(start, **(usual | changes))


Shown = TypeVar("Shown", Snapshot, None)


def answered(picture: Shown, revealed: bool = True) -> Shown:
    return picture if picture is None or not revealed else changed(picture, is_hidden=False)


def curve(bins: int, low: float, high: float, width: int = 50) -> Curve:
    rise = 1.0 - np.exp(-np.arange(bins) / max(1.0, bins / 4))
    mean = low + (high - low) * rise
    band = (high - low) * 0.15
    episode = np.arange(1, bins + 1, dtype=np.int64) * width
    return Curve(episode, mean, mean - band, mean + band, np.full(bins, 12.0))


def marks(count: int, low: float, high: float, episodes: int) -> Marks:
    episode = np.linspace(0, episodes, count).astype(np.int64)
    expected = low + (high - low) * (1.0 - np.exp(-np.arange(count) / max(1.0, count / 6)))
    expected[:1] = np.nan
    return Marks(episode * 12, episode, expected)


def _lake(world: World, id: str, title: str, step: int, changes: dict[str, Any]) -> Snapshot:  # noqa: A002
    mdp = world.space
    hyperparameters = Hyperparameters(alpha=0.1, gamma=0.99, epsilon=0.1)
    start = snapshot(world, scenario(id, title, "gymnasium"), hyperparameters)
    if step == 0:
        return changed(start, **changes)
    exact = exact_solution(mdp, 0.99)
    q = learned_q(exact)
    visits = (np.arange(mdp.pairs) * 37 % 101 * step // (50 * mdp.pairs)).astype(np.int64)
    visits[0] = 0
    q[visits == 0] = 0.0
    state = 6 if len(mdp.state_names) == 16 else 28
    pair = int(mdp.first_pair[state])
    visits[pair] = max(1, visits[pair])
    outcome = mdp.outcomes_of(pair)[0]
    next_state = int(mdp.next_state[outcome])
    bootstrap = float(best_values(mdp, q)[next_state])
    after = 0.9 * q[pair] + 0.1 * 0.99 * bootstrap
    last = LastStep(
        step=step,
        episode=max(1, step // 12),
        state=state,
        pair=pair,
        explored=False,
        epsilon=0.1,
        outcome=outcome,
        reward=float(mdp.reward[outcome]),
        next_state=next_state,
        terminated=bool(mdp.terminated[outcome]),
        truncated=False,
        updated_pair=pair,
        before=float(q[pair]),
        step_size=0.1,
        gamma=0.99,
        others=0,
        table=0,
        gathered=float(mdp.reward[outcome]),
        discount=0.99,
        bootstrap=bootstrap,
        bootstrap_state=NOTHING if mdp.terminated[outcome] else next_state,
        after=float(after),
    )
    q[pair] = after
    shown: dict[str, Any] = {
        "step": step,
        "episodes": step // 12,
        "state": state,
        "episode_step": 5,
        "q": q,
        "visits": visits,
        "last_step": last,
        "curve": curve(400, 0.0, 0.4, max(1, step // 4_800)),
        "marks": marks(30, 0.0, 0.73, step // 12),
        "return_last_100": 0.41,
        "length_last_100": 37.5,
        "greedy_return": 0.73,
        "solution": exact,
        "expected_return": exact.value_at_start,
    }
    return changed(start, **(shown | changes))


def lake(step: int = 150_000, *, slippery: bool = True, **changes: Any) -> Snapshot:
    """The 4×4 lake, slippery or not: 11 live states × 4."""
    suffix = " slippery" if slippery else ""
    return _lake(
        lake_world(slippery=slippery),
        "frozenlake-slippery" if slippery else "frozenlake",
        f"FrozenLake 4×4{suffix}",
        step,
        changes,
    )


def big_lake(step: int = 180_000, **changes: Any) -> Snapshot:
    """The slippery 8×8 lake: 53 live states × 4."""
    world = lake_world(rows=BIG_LAKE, time_limit=200)
    return _lake(world, "frozenlake-8x8-slippery", "FrozenLake 8×8 slippery", step, changes)


def student(step: int = 2_433, **changes: Any) -> Snapshot:
    """The student evening: three live states that own five pairs."""
    world = student_world()
    start = snapshot(
        world,
        scenario("student", "A student's evening", "mdp"),
        Hyperparameters(alpha=0.1, gamma=0.9, epsilon=0.1),
    )
    if step == 0:
        return changed(start, **changes)
    exact = exact_solution(world.space, 0.9)
    q = exact.q.copy()
    q[0] = 6.37
    last = LastStep(
        step=step,
        episode=964,
        state=0,
        pair=0,
        explored=False,
        epsilon=0.1,
        outcome=0,
        reward=-2.0,
        next_state=2,
        terminated=False,
        truncated=False,
        updated_pair=0,
        before=6.30,
        step_size=0.1,
        gamma=0.9,
        others=0,
        table=0,
        gathered=-2.0,
        discount=0.9,
        bootstrap=10.0,
        bootstrap_state=2,
        after=6.37,
    )
    shown: dict[str, Any] = {
        "step": step,
        "episodes": 963,
        "state": 2,
        "episode_step": 1,
        "episode_return": -2.0,
        "q": q,
        "visits": np.array([1204, 133, 12, 121, 963], dtype=np.int64),
        "last_step": last,
        "curve": curve(30, -4.0, 5.9, 33),
        "marks": marks(20, -4.0, 7.5, 963),
        "return_last_100": 5.9,
        "length_last_100": 2.6,
        "greedy_return": 7.5,
        "solution": exact,
        "expected_return": exact.value_at_start,
    }
    return changed(start, **(shown | changes))


PULLS = (12, 18, 9, 31, 14, 842, 15, 16, 8, 35)


ESTIMATES = (-0.3, 0.3, -0.6, 0.7, 0.0, 1.4, -0.1, 0.2, -1.2, 0.8)


def bandit(pulls: int = 1_000, **changes: Any) -> Snapshot:
    """The ten-armed bandit with its budget spent, unless ``pulls`` are given."""
    world = bandit_world()
    start = snapshot(
        world,
        scenario("bandit", "Ten-armed bandit", "bandit"),
        Hyperparameters(alpha="sample-average", gamma=0.0, epsilon=0.1),
        bandit=BanditFigures(0, 1_000, 0.0, 0.0, None, 0.0),
    )
    if pulls == 0:
        return changed(start, **changes)
    visits = np.array(PULLS, dtype=np.int64) * pulls // 1_000
    visits[5] += pulls - visits.sum()
    last = LastStep(
        step=pulls,
        episode=pulls,
        state=0,
        pair=5,
        explored=False,
        epsilon=0.1,
        outcome=5,
        reward=2.11,
        next_state=0,
        terminated=True,
        truncated=False,
        updated_pair=5,
        before=1.39,
        step_size=1.0 / int(visits[5]),
        gamma=0.0,
        others=0,
        table=0,
        gathered=2.11,
        discount=0.0,
        bootstrap=0.0,
        after=1.4,
    )
    gaps = max(TRUE_MEANS) - np.array(TRUE_MEANS)
    figures = BanditFigures(
        pulls=pulls,
        budget=1_000,
        winnings=1.213 * pulls,
        regret=float(visits @ gaps),
        best_arm_rate=float(visits[5] / pulls),
        best_possible=pulls * max(TRUE_MEANS),
    )
    shown: dict[str, Any] = {
        "phase": Phase.SPENT if pulls >= 1_000 else Phase.PAUSED,
        "step": pulls,
        "episodes": pulls,
        "q": np.array(ESTIMATES),
        "visits": visits,
        "last_step": last,
        "curve": curve(40, 0.0, 1.21, max(1, pulls // 40)),
        "marks": marks(20, 0.0, 1.4, pulls),
        "return_last_100": 1.31,
        "length_last_100": 1.0,
        "greedy_return": 1.5,
        "solution": exact_solution(world.space, 0.0),
        "expected_return": max(TRUE_MEANS),
        "bandit": figures,
    }
    return changed(start, **(shown | changes))


def spent() -> Snapshot:
    return bandit(1_000)


def stepped_lake() -> Snapshot:
    known = lake()
    mdp = known.world.space
    space = FiniteSpace(mdp.state_names, mdp.action_names, mdp.first_pair, mdp.pair_action, mdp.time_limit)
    last = known.counters.last_step
    return changed(
        known,
        world=World(space, known.world.drawing),
        last_step=None if last is None else replace(last, outcome=-1),
        marks=Marks(),
        greedy_return=None,
        solution=None,
        expected_return=None,
        refused="this environment has no transition table",
    )


def planning(sweeps: int = 12, **changes: Any) -> Snapshot:
    known = lake()
    shown: dict[str, Any] = {
        "algorithm": "value-iteration",
        "step": sweeps * 11,
        "episodes": sweeps,
        "curve": Curve(),
        "marks": marks(5, 0.0, 0.73, sweeps),
        "return_last_100": None,
        "length_last_100": None,
    }
    return changed(known, **(shown | changes))
