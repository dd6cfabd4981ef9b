"""A Dask cluster on this machine."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Mapping
from itertools import count
from pathlib import Path
from types import TracebackType
from typing import Any, Final

LONGEST_START: Final = 60.0  # seconds, for a busy machine
_HERE: Final = Path(__file__).parent
_ALLOWED_FAILURES: Final = "DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES"
_QUIET: Final = {"DASK_DISTRIBUTED__LOGGING__DISTRIBUTED": "warning"}


class Cluster:
    def __init__(self, folder: Path, allowed_failures: int | None = None) -> None:
        self._folder = folder
        self._numbers = count()
        self._workers: dict[str, subprocess.Popen[bytes]] = {}
        file = folder / "scheduler.json"
        self._scheduler = self._start(
            "dask_scheduler", "--port", "0", "--dashboard-address", "127.0.0.1:0", "--scheduler-file",
            str(file), "--idle-timeout", "120s",
            environment=None if allowed_failures is None else {_ALLOWED_FAILURES: str(allowed_failures)},
        )  # fmt: skip
        from distributed import Client

        self.client = Client(scheduler_file=str(file), timeout=LONGEST_START, set_as_default=False)
        self.address = str(self.client.scheduler.address)

    def __enter__(self) -> Cluster:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self.client.close(timeout=2)
        for process in (*self._workers.values(), self._scheduler):
            process.kill()
        for process in (*self._workers.values(), self._scheduler):
            process.wait()

    def start(
        self, number: int, environment: Mapping[str, str] | None = None, preload: str = ""
    ) -> list[str]:
        """Start workers of one thread, each of which runs ``preload`` first, and return their addresses."""
        names = [f"worker{next(self._numbers)}" for _ in range(number)]
        options = ["--nthreads", "1", "--no-nanny", "--no-dashboard", "--death-timeout", "20"]
        if preload:
            script = self._folder / f"{names[0]}.py"
            script.write_text(preload)
            options += ["--preload", str(script)]
        for name in names:
            own = ["--name", name, "--local-directory", str(self._folder / name), *options]
            self._workers[name] = self._start("dask_worker", self.address, *own, environment=environment)
        self.client.wait_for_workers(len(self._addresses()) + number, timeout=LONGEST_START)
        found = self._addresses()
        return [found[name] for name in names]

    @property
    def workers(self) -> list[str]:
        return list(self._addresses().values())

    def kill(self, address: str) -> None:
        self._signal(address, signal.SIGKILL).wait()

    def hold(self, address: str) -> None:
        self._signal(address, signal.SIGSTOP)

    def is_busy(self, address: str) -> bool:
        return bool(self.client.processing().get(address))

    def clear(self) -> None:
        for process in self._workers.values():
            process.kill()
        for process in self._workers.values():
            process.wait()
        self._workers.clear()
        while self._addresses():
            pass

    def kill_scheduler(self) -> None:
        self._scheduler.send_signal(signal.SIGKILL)
        self._scheduler.wait()

    def dead(self) -> int:
        return sum(process.poll() is not None for process in self._workers.values())

    def events(self, worker: str) -> list[Mapping[str, Any]]:
        return [event for _, event in self.client.get_events(worker)]

    def _signal(self, address: str, number: signal.Signals) -> subprocess.Popen[bytes]:
        name = next(each for each, where in self._addresses().items() if where == address)
        self._workers[name].send_signal(number)
        return self._workers[name]

    def _addresses(self) -> dict[str, str]:
        workers = self.client.scheduler_info(n_workers=-1)["workers"]
        return {str(each["name"]): address for address, each in workers.items()}

    def _start(
        self, command: str, *options: str, environment: Mapping[str, str] | None = None
    ) -> subprocess.Popen[bytes]:
        paths = os.pathsep.join([str(_HERE), *filter(None, [os.environ.get("PYTHONPATH")])])
        with (self._folder / f"{command}{next(self._numbers)}.log").open("wb") as log:
            return subprocess.Popen(
                [sys.executable, "-m", f"distributed.cli.{command}", "--host", "127.0.0.1", *options],
                env={**os.environ, **_QUIET, "PYTHONPATH": paths, **(environment or {})},
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=log,
                cwd=self._folder,
            )
