"""A watched program, without dependence on time."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from rl_tui.live.commands import Command
from rl_tui.live.program_playback import ProgramPlayback
from rl_tui.live.snapshot import Snapshot
from rl_tui.programs.watched.program_process import ProgramRequest
from rl_tui.programs.watched.watched_program import WatchedProgram

LEARNS = """
import gymnasium as gym
import numpy as np

env = gym.make("FrozenLake-v1", is_slippery=False)
q = np.zeros((16, 4))
alpha, gamma, epsilon = 0.1, 0.99, 0.3
rng = np.random.default_rng(1)
for episode in range(EPISODES):
    s, _ = env.reset()
    done = False
    while not done:
        best = np.flatnonzero(q[s] == q[s].max())
        a = int(rng.integers(4)) if rng.random() < epsilon else int(rng.choice(best))
        s2, r, terminated, truncated, _ = env.step(a)
        q[s, a] += alpha * (r + gamma * (0 if terminated else q[s2].max()) - q[s, a])
        s, done = s2, terminated or truncated
"""
"""A correct program that learns all it can in some 100 episodes."""


def written(folder: Path, text: str = LEARNS, episodes: int = 300) -> Path:
    path = folder / "student.py"
    path.write_text(text.replace("EPISODES", str(episodes)))
    return path


class Watcher:
    def __init__(self, playback: ProgramPlayback) -> None:
        self.playback = playback

    def do(self, *commands: Command) -> Snapshot:
        self._rest()
        for command in commands:
            self.playback.handle(command)
            self._rest()
        return self.playback.snapshot()

    def _rest(self) -> None:
        for _ in range(100_000):
            if self.playback.work() is None and not self.playback.on_the_way:
                return
        raise AssertionError("it never comes to rest")


@contextmanager
def watched(path: Path, seed: int = 0) -> Iterator[Watcher]:
    program = WatchedProgram(ProgramRequest(path, seed=seed))
    program.wait_for_environment()
    playback = ProgramPlayback(program, lambda: None, automatic=False)
    try:
        yield Watcher(playback)
    finally:
        playback.close()
