"""A far replay waits for machine code."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from recipes import recipe
from session_samples import after, fresh

from rl_tui.agents.compiling.background import BACKGROUND
from rl_tui.agents.compiling.loops import compile_here
from rl_tui.agents.kernels.machine_code import COMPILED_LOOPS, Loop
from rl_tui.live.commands import Apply, FollowCell, GoTo, Pause, Play, SetSpeed, Step
from rl_tui.live.pace.compilation import MOST_INTERPRETED
from rl_tui.live.playback import Playback
from rl_tui.live.player import Player
from rl_tui.live.record import LearnedTable, Record
from rl_tui.live.sessions.session import StoredSession, digest_of, encoded, read_session
from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.live.state import State
from rl_tui.runs.recipe import Change, Recipe, SetParameter, SwitchAlgorithm
from rl_tui.runs.run import Run
from rl_tui.runs.timeline.branches import RunRecord

pytestmark = pytest.mark.interpreted

FAR = 3 * MOST_INTERPRETED
NEAR = MOST_INTERPRETED // 10
Q_LEARNING = Loop("q-learning", "epsilon-greedy", stepped=False)
SARSA = Loop("sarsa", "epsilon-greedy", stepped=False)


@pytest.fixture(autouse=True)
def wanted(monkeypatch: pytest.MonkeyPatch) -> Iterator[list[list[Loop]]]:
    asked: list[list[Loop]] = []
    monkeypatch.setattr(BACKGROUND, "want", lambda loops: asked.append(list(loops)))
    before = set(COMPILED_LOOPS)
    yield asked
    COMPILED_LOOPS.update(before)


def run_to(made_from: Recipe, step: int, *changes: tuple[int, Change]) -> Run:
    record = after(fresh(made_from), step, *changes)
    run = Run(made_from)
    if step > MOST_INTERPRETED:
        for loop in (Q_LEARNING, SARSA):
            compile_here(loop)
    run.follow(record.lanes[0].branches[0].journal, step)
    COMPILED_LOOPS.clear()
    return run


def left(folder: Path, run: Run, *, table: bool = True) -> StoredSession:
    learner = run.learner
    learned = LearnedTable(learner.q, learner.visits, learner.episodes, learner.state) if table else None
    changes = [(entry.step, entry.change) for entry in run.journal]
    record = replace(after(fresh(run.recipe), run.step, *changes), table=learned)
    path = folder / "mine.json"
    path.write_bytes(encoded(record, digest=digest_of(learner.q)))
    return read_session(path)


def playing(record: Record) -> Playback:
    made_from = record.lanes[record.shown].recipe
    ticks = iter(range(10**9))
    return Playback(
        made_from,
        speed=10.0,
        automatic=True,
        clock=lambda: next(ticks) * 0.001,
        on_exact=lambda: None,
        record=record,
    )


def opened(record: Record) -> Playback:
    playback = playing(record)
    while playback.state is State.BUILDING:
        playback.work()
    return playback


def work_until_it_waits(playback: Playback) -> None:
    while playback.work() == 0.0:
        pass
    assert playback.state is State.SEEKING


def arrived(playback: Playback) -> Snapshot:
    while playback.state is not State.PAUSED:
        playback.work()
    return playback.snapshot()


def shows(snapshot: Snapshot, run: Run) -> bool:
    learner, agent = run.learner, snapshot.agent
    assert agent.q.tobytes() == learner.q.tobytes()
    assert agent.visits.tolist() == learner.visits.tolist()
    assert (agent.algorithm, agent.hyperparameters) == (learner.algorithm, learner.hyperparameters)
    here = (snapshot.counters.step, snapshot.counters.episodes, snapshot.counters.state)
    return here == (run.step, learner.episodes, learner.state)


def test_a_far_replay_waits_and_shows_what_was_learned(tmp_path: Path, wanted: list[list[Loop]]) -> None:
    run = run_to(recipe("student"), FAR, (500, SetParameter("gamma", 0.5)))
    session = left(tmp_path, run)
    playback = playing(session.record())
    playback.work()
    first = playback.snapshot()
    assert first.playback.phase is Phase.PREPARING
    assert shows(first, run)
    work_until_it_waits(playback)
    meanwhile = playback.snapshot()
    assert shows(meanwhile, run)
    assert meanwhile.playback.phase is Phase.SEEKING
    assert meanwhile.playback.message.startswith(f"{FAR:,} steps to replay: waiting for the compiler")
    assert meanwhile.playback.interpreted
    assert meanwhile.timeline.current.here == FAR
    assert (meanwhile.results.greedy_return, meanwhile.counters.last_step) == (None, None)
    assert meanwhile.exact_answer.solution is None  # computed for the γ of step 0
    assert all(loops == [Q_LEARNING] for loops in wanted)
    assert playback.table is None
    compile_here(Q_LEARNING)
    there = arrived(playback)
    assert digest_of(there.agent.q) == session.document.digest
    assert shows(there, run)
    assert there.results.return_last_100 == run.results.return_last_100
    assert not there.playback.interpreted


def test_a_near_replay_does_not_wait_and_shows_what_was_learned_too(tmp_path: Path) -> None:
    run = run_to(recipe("student"), NEAR)
    playback = opened(left(tmp_path, run).record())
    meanwhile = playback.snapshot()
    assert meanwhile.playback.phase is Phase.SEEKING
    assert "waiting" not in meanwhile.playback.message
    assert shows(meanwhile, run)
    assert shows(arrived(playback), run)


def test_of_lanes_the_one_shown_is_shown_as_it_was_left(tmp_path: Path) -> None:
    run = run_to(recipe("student"), FAR)
    record = left(tmp_path, run).record()
    other = after(fresh(replace(record.lanes[0].recipe, algorithm="sarsa")), FAR).lanes[0]
    meanwhile = opened(replace(record, lanes=(other, *record.lanes), shown=1)).snapshot()
    assert shows(meanwhile, run)
    first, second = meanwhile.run_group.lanes
    assert (first.step, second.step, second.episodes) == (0, FAR, run.learner.episodes)
    assert second.q.tobytes() == run.learner.q.tobytes()


def test_without_a_table_step_0_is_shown(tmp_path: Path) -> None:
    run = run_to(recipe("student"), FAR)
    meanwhile = opened(left(tmp_path, run, table=False).record()).snapshot()
    assert (meanwhile.counters.step, set(meanwhile.agent.visits)) == (0, {0})
    assert meanwhile.playback.message.startswith(f"{FAR:,} steps to replay: waiting for the compiler")


@pytest.mark.parametrize(
    "table",
    [
        LearnedTable(np.ones(6), np.ones(6, np.int64), episodes=1, state=0),
        LearnedTable(np.ones(5), np.ones(5, np.int64), episodes=1, state=4),
    ],
)
def test_a_table_of_another_world_is_not_shown(table: LearnedTable) -> None:
    record = replace(after(fresh(recipe("student")), FAR), table=table)
    COMPILED_LOOPS.clear()
    playback = playing(record)
    playback.work()
    assert playback.snapshot().counters.step == 0
    playback.work()
    assert playback.snapshot().counters.step == 0


def test_of_a_bandit_the_replay_alone_is_shown(tmp_path: Path) -> None:
    run = run_to(recipe("bandit"), 500)
    playback = opened(left(tmp_path, run).record())
    on_the_way = playback.snapshot()
    assert on_the_way.counters.step == on_the_way.agent.visits.sum() < 500
    assert arrived(playback).counters.step == 500


def test_a_wrong_table_is_never_learned_from() -> None:
    run = run_to(recipe("student"), NEAR)
    table = LearnedTable(np.full(5, 7.0), np.ones(5, np.int64), episodes=3, state=1)
    playback = opened(replace(after(fresh(recipe("student")), NEAR), table=table))
    assert playback.snapshot().agent.q.tolist() == [7.0] * 5
    assert shows(arrived(playback), run)


def test_while_it_waits_nothing_is_changed_but_where_it_goes(tmp_path: Path) -> None:
    run = run_to(recipe("student"), FAR)
    playback = opened(left(tmp_path, run).record())
    for command in (Step(), Play(), Apply(SetParameter("alpha", 0.5))):
        assert not playback.takes(command)
    for command in (SetSpeed(3.0), FollowCell(0)):
        playback.handle(command)
    assert shows(playback.snapshot(), run)
    assert playback.takes(GoTo(NEAR))
    playback.handle(GoTo(NEAR))
    assert playback.snapshot().counters.step != FAR
    there = arrived(playback)
    assert (there.counters.step, there.timeline.current.end) == (NEAR, FAR)


def test_to_pause_while_it_waits_does_not_lose_the_way(tmp_path: Path) -> None:
    run = run_to(recipe("student"), FAR)
    session = left(tmp_path, run)
    playback = opened(session.record())
    work_until_it_waits(playback)
    playback.handle(Pause())
    compile_here(Q_LEARNING)
    assert digest_of(arrived(playback).agent.q) == session.document.digest


def test_what_takes_over_on_the_way_is_waited_for_too(tmp_path: Path, wanted: list[list[Loop]]) -> None:
    run = run_to(recipe("student"), FAR, (500, SwitchAlgorithm("sarsa")))
    session = left(tmp_path, run)
    playback = opened(session.record())
    compile_here(Q_LEARNING)
    work_until_it_waits(playback)
    assert wanted[-1] == [SARSA]
    message = playback.snapshot().playback.message
    assert re.match("299,[45].. steps to replay: waiting for the compiler", message)
    assert shows(playback.snapshot(), run)
    compile_here(SARSA)
    assert digest_of(arrived(playback).agent.q) == session.document.digest


@pytest.mark.exhaustive("takes a million steps interpreted")
def test_where_nothing_can_be_compiled_it_replays_interpreted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    run = run_to(recipe("student"), FAR)
    playback = opened(left(tmp_path, run).record())
    monkeypatch.setitem(BACKGROUND.failed, run.learner.loop, OSError("no compiler"))
    there = arrived(playback)
    assert shows(there, run)
    assert there.playback.interpreted
    assert "no compiler" in there.playback.stays_interpreted


def test_a_missing_numba_is_news_though_nothing_else_has_changed(monkeypatch: pytest.MonkeyPatch) -> None:
    COMPILED_LOOPS.clear()
    playback = opened(Record((RunRecord(recipe("student")),)))
    playback.work()
    assert (playback.snapshot().playback.stays_interpreted, playback.changed) == ("", False)
    loop = playback.group.current.run.learner.loop
    monkeypatch.setitem(BACKGROUND.failed, loop, ModuleNotFoundError(name="numba"))
    playback.work()
    assert playback.changed
    assert "pip install numba" in playback.snapshot().playback.stays_interpreted


def test_what_was_closed_asks_for_nothing_more(wanted: list[list[Loop]]) -> None:
    COMPILED_LOOPS.clear()
    playback = playing(Record((RunRecord(recipe("student")),)))
    playback.work()
    playback.compilation.close()
    playback.work()
    assert playback.compilation.interpreted
    assert wanted == []


def test_playing_on_in_the_past_looks_again_where_another_loop_takes_over() -> None:
    playback = opened(Record((RunRecord(recipe("student")),)))
    lane = playback.group.current
    lane.advance(50)
    lane.apply(SwitchAlgorithm("sarsa"))
    lane.advance(50)
    lane.seek_to(step=10)
    while lane.seek is not None:
        lane.continue_seek(100)
    lane.advance(80)
    assert (lane.run.step, lane.run.learner.algorithm) == (50, "sarsa")
    lane.advance(80)
    assert lane.run.step == 130


def test_another_algorithm_goes_on_at_once(wanted: list[list[Loop]]) -> None:
    COMPILED_LOOPS.clear()
    playback = opened(Record((RunRecord(recipe("frozenlake")),)))
    playback.handle(Play())
    playback.handle(Apply(SwitchAlgorithm("value-iteration")))
    before = playback.snapshot()
    assert (before.playback.phase, before.agent.algorithm) == (Phase.RUNNING, "value-iteration")
    for _ in range(10):
        playback.work()
    after_it = playback.snapshot()
    assert after_it.counters.step > before.counters.step
    assert (after_it.playback.phase, after_it.playback.interpreted) == (Phase.RUNNING, True)
    planner = Loop("value-iteration", "", stepped=False)
    assert wanted[-1] == [planner]
    compile_here(planner)
    playback.work()
    assert not playback.snapshot().playback.interpreted


async def test_when_the_last_player_is_closed_nothing_is_wanted_any_more(wanted: list[list[Loop]]) -> None:
    COMPILED_LOOPS.clear()
    first, second = (Player(recipe("student")) for _ in range(2))
    for player in (first, second):
        player.send(Step())
        await player.carried_out()
    assert wanted[-1] == [Q_LEARNING]
    first.close()
    assert wanted[-1] == [Q_LEARNING]
    second.close()
    assert wanted[-1] == []


async def test_a_player_that_takes_no_steps_by_itself_wants_nothing(wanted: list[list[Loop]]) -> None:
    COMPILED_LOOPS.clear()
    player = Player(recipe("student"), automatic=False)
    player.send(Step())
    await player.carried_out()
    player.close()
    assert wanted == []
