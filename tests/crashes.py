"""Kill the real program at random moments and check its saved session: ``python tests/crashes.py 50``."""

from __future__ import annotations

import random
import re
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any, Final, NamedTuple

from pseudo_terminal import RL_TUI, PseudoTerminal

from rl_tui.live.record import Record
from rl_tui.live.sessions.replay import replay_target, replayed
from rl_tui.live.sessions.session import StoredSession, digest_of, encoded, files_in, read_session
from rl_tui.runs.edited_world import EditedWorld
from rl_tui.runs.library import find, recipe_for
from rl_tui.runs.recipe import SetParameter, begin
from rl_tui.runs.timeline.branches import FIRST, RunRecord
from rl_tui.runs.timeline.branching_run import BranchingRun

SCENARIO: Final = "student"
FASTER: Final = "+" * 9
ALLOWED_LOSS: Final = 1.0  # seconds
STEP: Final = re.compile(r"step\s+([\d,]+)\b")


class Crash(NamedTuple):
    """``lost`` is the age, in seconds, of the oldest action that was not saved."""

    actions: int
    lost: float
    resumed: bool


class Seen(NamedTuple):
    moment: float
    stand: Any


def crash(folder: Path, session: Path | None, chance: random.Random) -> Crash:
    """Start the program, act, and kill it. Each action counts as done once the screen shows it."""
    lane = lane_of(session)
    before = stand_of(lane.record)
    name = str(session) if session else SCENARIO
    with PseudoTerminal([*RL_TUI, "play", name], {"RL_TUI_SESSIONS_DIR": str(folder)}) as terminal:
        terminal.wait_for(rf"step\s+{lane.run.step:,}\b" if lane.run.step else "paused")
        runs = chance.random() < 0.3
        seen = list(run(terminal, chance) if runs else act(terminal, lane, chance))
        for _ in terminal.reading(chance.choice([0.0, chance.uniform(0.0, 0.7)])):
            pass
        terminal.process.kill()
        killed = time.perf_counter()
        terminal.process.wait()
    kept = newest(folder) if session is None else read_session(session)
    if runs:
        lost = [each for each in seen if kept is None or kept.step < each.stand]
    else:
        stand = before if kept is None else stand_of(kept.record().lanes[0])
        stands = [each.stand for each in seen]
        assert stand == before or stand in stands, f"kept {stand}, which never was: {stands}"
        last = max((at for at, each in enumerate(stands) if each == stand), default=-1)
        lost = seen[last + 1 :]
    if kept is not None:
        check_bits(kept)
    return Crash(len(seen), max((killed - each.moment for each in lost), default=0.0), session is not None)


def act(terminal: PseudoTerminal, lane: BranchingRun, chance: random.Random) -> Iterator[Seen]:
    for _ in range(chance.randint(1, 25)):
        keys = chance.choice(["s", "s", "ats", "b" if lane.run.step > 1 else "s"])
        stands = []
        if keys == "ats":
            lane.apply(SetParameter("ties", "first"))
            stands.append(stand_of(lane.record))  # the save may come before the step is done
        if keys == "b":
            lane.seek_to(step=lane.run.step - 1)
            arrive(lane)
        else:
            lane.advance(1)
        terminal.press(keys)
        terminal.wait_for(rf"step\s+{lane.run.step:,}\b")
        for stand in (*stands, stand_of(lane.record)):
            yield Seen(time.perf_counter(), stand)


def run(terminal: PseudoTerminal, chance: random.Random) -> Iterator[Seen]:
    terminal.press(" " + FASTER[: chance.randint(0, 9)])
    for moment, text in terminal.reading(chance.uniform(0.2, 2.5)):
        for match in STEP.finditer(text):
            yield Seen(moment, int(match[1].replace(",", "")))


def stand_of(record: RunRecord) -> Any:
    branches = [
        (each.parent, each.fork, each.end, each.here, [entry.step for entry in each.journal])
        for each in record.branches
    ]
    return record.branch, branches


def lane_of(session: Path | None) -> BranchingRun:
    if session is None:
        recipe = recipe_for(find(SCENARIO))
        return BranchingRun(RunRecord(recipe), EditedWorld(begin(recipe).world))
    record = read_session(session).record().lanes[0]
    lane = BranchingRun(record, EditedWorld(begin(record.recipe).world))
    lane.seek_to(step=record.step)
    arrive(lane)
    return lane


def arrive(lane: BranchingRun) -> None:
    while lane.seek:
        lane.continue_seek(1_000_000)


def in_the_past(folder: Path, chance: random.Random) -> Path:
    branch = replace(FIRST, end=30, here=chance.randint(5, 25))
    folder.mkdir(parents=True)
    path = folder / "past.json"
    path.write_bytes(encoded(Record((RunRecord(recipe_for(find(SCENARIO)), (branch,)),))))
    return path


def newest(folder: Path) -> StoredSession | None:
    files = files_in(folder)
    assert len(files) <= 1
    return read_session(files[0]) if files else None


def check_bits(session: StoredSession) -> None:
    target = replay_target(session.record())
    run, _ = replayed(target)
    assert run.step == session.step
    assert session.document.digest in ("", digest_of(run.learner.q))


def crashes(count: int, seed: int) -> Iterator[Crash]:
    """Continue the session after some kills. Others begin in their past, where a change makes a branch."""
    chance = random.Random(seed)
    with tempfile.TemporaryDirectory() as name:
        session = None
        for number in range(count):
            folder = session.parent if session else Path(name) / str(number)
            if session is None and chance.random() < 0.3:
                session = in_the_past(folder, chance)
            yield crash(folder, session, chance)
            files = files_in(folder)
            session = files[0] if files and chance.random() < 0.6 else None


def main() -> None:
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 50
    seed = int(sys.argv[2]) if len(sys.argv) > 2 else random.randrange(2**32)
    print(f"{count} kills, seed {seed}", flush=True)
    done = []
    for each in crashes(count, seed):
        done.append(each)
        print(".", end="", flush=True)
    lost = sorted(each.lost for each in done)
    print(f"\nresumed before they were killed again: {sum(each.resumed for each in done)}")
    print(f"actions: {sum(each.actions for each in done):,}")
    print(f"oldest action lost: median {lost[len(lost) // 2]:.2f} s, most {lost[-1]:.2f} s")
    print("every file that was kept is sound, and comes out to the same bits")


if __name__ == "__main__":
    main()
