"""The process of a study, as seen by the program that asked for it."""

from __future__ import annotations

import json
import os
import pickle
import threading
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from typing import IO, Final

from rl_tui.agents.compiling.cache_folder import base_folder
from rl_tui.common.child_process import python_process
from rl_tui.lab.many_seeds.figures import SeedStudy, StudyState
from rl_tui.lab.many_seeds.request import StudyRequest
from rl_tui.lab.many_seeds.study_json import of_json

WORKER: Final = "rl_tui.lab.many_seeds.worker"
"""What runs in it: it needs much that this process need not load."""
_LONGEST_LINE: Final = 4_000_000
"""Bytes of one message. Curves of four lanes are a tenth of it."""


class StudyProcess:
    """A process that works out ``request``, and ends with this one, however that ends.

    ``on_news`` is called, in a thread of its own, when ``study`` has become another. Raises OSError where no
    process can be started.
    """

    def __init__(self, request: StudyRequest, on_news: Callable[[], None]) -> None:
        self.study: SeedStudy = request.nothing_yet
        """What is known by now."""
        self._on_news = on_news
        self._process = python_process(
            WORKER, {}, os.environ | {"RL_TUI_CACHE_DIR": str(base_folder().absolute())}
        )
        self._reader = threading.Thread(target=self._talk, args=(request,), name="many seeds", daemon=True)
        try:
            self._reader.start()
        except RuntimeError as error:  # there may be only so many threads
            self._process.kill()
            self._process.wait()
            raise OSError(str(error)) from error

    def end(self) -> None:
        """End it, whatever it is doing; this does not wait."""
        self._process.kill()

    def wait(self) -> None:
        """Wait until it has ended, be it by :meth:`end`."""
        self._reader.join()

    def _talk(self, request: StudyRequest) -> None:
        """Ask, take in what it answers, and see it to its end."""
        stdin, stdout = self._process.stdin, self._process.stdout
        assert stdin is not None
        assert stdout is not None
        with open(stdout.fileno(), "rb", closefd=False) as lines, stdout, stdin:
            with suppress(OSError):  # it has ended already
                self._send(stdin, pickle.dumps(request))
            self._listen(lines)
            self._process.kill()
            self._process.wait()
        self._on_news()

    @staticmethod
    def _send(stdin: IO[bytes], message: bytes) -> None:
        left = memoryview(message)
        while left:
            left = left[stdin.write(left) :]

    def _listen(self, lines: IO[bytes]) -> None:
        """Take in line after line, until the end, or a line that is none."""
        with suppress(OSError, ValueError, KeyError, TypeError):
            while line := lines.readline(_LONGEST_LINE):
                self.study = of_json(json.loads(line))
                self._on_news()
        if self.study.state in (StudyState.STARTING, StudyState.RUNNING):
            self.study = replace(self.study, state=StudyState.FAILED, message="its process ended by itself")
