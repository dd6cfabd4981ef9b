"""The real server and its apps."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Final

DEADLINE: Final = 120.0


class Served:
    def __init__(self, process: subprocess.Popen[str]) -> None:
        self.process = process
        self.said = process.stdout.readline()
        found = re.search(r"http://\S+", self.said)
        assert found, f"not started: {self.said}"
        self.url = found.group()

    @property
    def web_socket(self) -> str:
        return self.url.replace("http:", "ws:") + "ws"

    @property
    def apps(self) -> list[int]:
        return [process for process, parent in _parents() if parent == self.process.pid]

    def wait(self) -> int:
        return self.process.wait(DEADLINE)


def is_running(process: int) -> bool:
    return _parent(process) is not None


@contextmanager
def serving(*arguments: str, **environment: str) -> Iterator[Served]:
    process = subprocess.Popen(
        [sys.executable, "-m", "rl_tui", "serve", "--port", "0", *arguments],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        text=True,
        env={**os.environ, **environment},
        start_new_session=True,
    )
    assert process.stdout is not None
    try:
        yield Served(process)
    finally:
        process.terminate()
        try:
            process.wait(DEADLINE)
        finally:
            process.kill()
            process.stdout.close()


def _parents() -> Iterator[tuple[int, int]]:
    for folder in Path("/proc").glob("[0-9]*"):
        process = int(folder.name)
        if (parent := _parent(process)) is not None:
            yield process, parent


def _parent(process: int) -> int | None:
    try:
        state, parent = (
            Path(f"/proc/{process}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()[:2]
        )
    except (OSError, ValueError):
        return None
    return None if state == "Z" else int(parent)
