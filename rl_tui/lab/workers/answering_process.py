"""A process that answers one request, as seen by the program that asks."""

from __future__ import annotations

import json
import os
import pickle
import threading
from collections.abc import Callable
from contextlib import suppress
from typing import IO, Any, Final

from rl_tui.agents.compiling.base_folder import base_folder
from rl_tui.common.child_process import python_process
from rl_tui.lab.workers.pace import Pace, how_long

_LONGEST_LINE: Final = 4_000_000
"""Bytes of one answer. The curves of four lanes are a tenth of it, Q*(γ) of all pairs is the longest."""
_LOOKS: Final = 1.0  # seconds from one look to the next at whether it gets on


class AnsweringProcess:
    """A process that works out ``request``, and ends with this one, however that ends.

    ``module`` is what runs in it: its ``main`` calls :func:`~rl_tui.lab.workers.answering.answer`. In a
    thread of its own, called ``name``, ``on_answer`` gets each answer, a JSON document, and ``on_end`` is
    called when no more will come. ``on_news`` is called after each of these, and when the process is held up
    or no longer is. An answer of which ``on_answer`` raises ValueError, KeyError or TypeError is the last.
    Raises OSError where no process can be started.
    """

    def __init__(
        self,
        module: str,
        request: object,
        on_answer: Callable[[Any], None],
        on_end: Callable[[], None],
        on_news: Callable[[], None],
        name: str,
    ) -> None:
        self.pace = Pace()
        """How it gets on."""
        self._on_answer = on_answer
        self._on_end = on_end
        self._on_news = on_news
        self._over = threading.Event()
        self._process = python_process(
            module, {}, os.environ | {"RL_TUI_CACHE_DIR": str(base_folder().absolute())}
        )
        self._reader = threading.Thread(target=self._talk, args=(request,), name=name, daemon=True)
        try:
            threading.Thread(target=self._watch, name=f"pace of {name}", daemon=True).start()
            self._reader.start()
        except RuntimeError as error:  # there may be only so many threads
            self._process.kill()
            self._process.wait()
            self._over.set()
            raise OSError(str(error)) from error

    @property
    def is_held_up(self) -> bool:
        """Whether a busy machine keeps it waiting."""
        return self.pace.is_held_up and not self._over.is_set()

    @property
    def how_long(self) -> str:
        """How long the rest takes, or that the machine is busy; empty where neither is known."""
        return how_long(self.pace.seconds_left, is_held_up=self.is_held_up)

    def end(self) -> None:
        """End it, whatever it is doing; this does not wait."""
        self._process.kill()

    def wait(self) -> None:
        """Wait until it has ended, be it by :meth:`end`."""
        self._reader.join()

    def _talk(self, request: object) -> None:
        """Ask, take in what it answers, and see it to its end."""
        stdin, stdout = self._process.stdin, self._process.stdout
        assert stdin is not None
        assert stdout is not None
        try:
            with open(stdout.fileno(), "rb", closefd=False) as lines, stdout, stdin:
                with suppress(OSError):  # it has ended already
                    self._send(stdin, pickle.dumps(request))
                with suppress(OSError, ValueError, KeyError, TypeError):
                    while line := lines.readline(_LONGEST_LINE):
                        self._hand_on(json.loads(line))
                self._process.kill()
                self._process.wait()
        finally:
            self._over.set()
        self._on_end()
        self._on_news()

    def _hand_on(self, document: Any) -> None:
        self.pace.note()
        self._on_answer(document)
        self._on_news()

    def _watch(self) -> None:
        """Notice when it does not get on: no answer says so."""
        was_held_up = False
        while not self._over.wait(_LOOKS):
            if self.is_held_up is not was_held_up:
                was_held_up = not was_held_up
                self._on_news()

    @staticmethod
    def _send(stdin: IO[bytes], message: bytes) -> None:
        left = memoryview(message)
        while left:
            left = left[stdin.write(left) :]
