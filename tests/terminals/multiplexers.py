"""Programs inside tmux and GNU screen."""

from __future__ import annotations

import re
import shutil
import subprocess
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

import pytest
from emulator import Emulator
from pseudo_terminal import DEADLINE, PseudoTerminal, environment_with

_TMUX_SETTINGS: Final = """
set -g default-terminal tmux-256color
set -g remain-on-exit on
set -g remain-on-exit-format ""
set -g status off
set -sg escape-time 0
set -g default-shell /bin/sh
"""
_SCREEN_SETTINGS: Final = """
startup_message off
deflogin off
defutf8 on
term screen-256color
maptimeout 0
altscreen on
autodetach off
"""
_SHORT: Final = "/tmp"  # a folder for tests may be longer than a socket's path, at most 107 bytes
_LOOK_AGAIN: Final = 0.05  # seconds


class Tmux:
    def __init__(
        self,
        folder: Path,
        command: Sequence[str],
        environment: Mapping[str, str | None],
        size: tuple[int, int],
    ) -> None:
        settings = folder / "tmux.conf"
        settings.write_text(_TMUX_SETTINGS, encoding="utf-8")
        self._tmux = ("tmux", "-S", str(folder / "tmux"), "-f", str(settings))
        self._environment = environment_with(environment)
        columns, rows = map(str, size)
        self._do("new-session", "-d", "-x", columns, "-y", rows, *command)

    @property
    def screen(self) -> str:
        return self.coloured.text

    @property
    def coloured(self) -> Emulator:
        columns, rows = map(int, self._do("display", "-p", "#{window_width} #{window_height}").split())
        emulator = Emulator(columns, rows)
        lines = self._do("capture-pane", "-p", "-e").splitlines()[:rows]
        for number, line in enumerate(lines, 1):
            emulator.feed(f"\x1b[{number};1H{line}\x1b[0m".encode())
        return emulator

    @property
    def modes(self) -> str:
        return self._do(
            "display", "-p", "alternate #{alternate_on}, cursor #{cursor_flag}, mouse #{mouse_any_flag}"
        ).strip()

    def press(self, keys: str) -> None:
        self._do("send-keys", "-l", keys)

    def resize(self, columns: int, rows: int) -> None:
        self._do("resize-window", "-x", str(columns), "-y", str(rows))

    def wait_for(self, pattern: str, seconds: float = DEADLINE) -> None:
        deadline = time.perf_counter() + seconds
        while not re.search(pattern, text := self.screen):
            if time.perf_counter() > deadline:
                raise AssertionError(f"{pattern!r} did not appear; what stands there:\n{text}")
            time.sleep(_LOOK_AGAIN)

    def close(self) -> None:
        self._do("kill-server")

    def _do(self, *what: str) -> str:
        done = subprocess.run(
            [*self._tmux, *what], check=False, capture_output=True, text=True, env=self._environment
        )
        assert done.returncode == 0, done.stderr
        return done.stdout


@contextmanager
def in_tmux(
    command: Sequence[str], size: tuple[int, int], environment: Mapping[str, str | None] | None = None
) -> Iterator[Tmux]:
    if shutil.which("tmux") is None:
        pytest.skip("needs tmux: apt-get install tmux")
    with TemporaryDirectory(prefix="rl-tui-", dir=_SHORT) as folder:
        tmux = Tmux(Path(folder), command, environment or {}, size)
        try:
            yield tmux
        finally:
            tmux.close()


@contextmanager
def in_screen(
    command: Sequence[str], size: tuple[int, int], environment: Mapping[str, str | None] | None = None
) -> Iterator[PseudoTerminal]:
    if shutil.which("screen") is None:
        pytest.skip("needs GNU screen: apt-get install screen")
    with TemporaryDirectory(prefix="rl-tui-", dir=_SHORT) as folder:
        settings, sockets = Path(folder, "screenrc"), Path(folder, "screens")
        settings.write_text(_SCREEN_SETTINGS, encoding="utf-8")
        sockets.mkdir(mode=0o700)
        inside = {**(environment or {}), "SCREENDIR": str(sockets)}
        started = ["setsid", "--ctty", "--wait", "screen", "-c", str(settings), *command]
        with PseudoTerminal(started, inside, size) as terminal:
            try:
                yield terminal
            finally:
                quit_it = ["screen", "-X", "quit"]
                subprocess.run(quit_it, check=False, capture_output=True, env=environment_with(inside))
