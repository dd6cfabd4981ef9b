"""The process of a study, as seen by the program that asked for it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any, Final

from rl_tui.lab.many_seeds.figures import SeedStudy, StudyState
from rl_tui.lab.many_seeds.request import StudyRequest
from rl_tui.lab.many_seeds.study_json import of_json
from rl_tui.lab.workers.answering_process import AnsweringProcess

WORKER: Final = "rl_tui.lab.many_seeds.worker"
"""What runs in it: it needs much that this process need not load."""


class StudyProcess(AnsweringProcess):
    """A process that works out ``request``, and ends with this one, however that ends.

    ``on_news`` is called, in a thread of its own, when ``study`` has become another. Raises OSError where no
    process can be started.
    """

    def __init__(self, request: StudyRequest, on_news: Callable[[], None]) -> None:
        self.study: SeedStudy = request.nothing_yet
        """What is known by now."""
        self._on_news = on_news
        super().__init__(WORKER, request, self._take_in, self._has_ended, "many seeds")

    def _take_in(self, document: Any) -> None:
        self.study = of_json(document)
        self._on_news()

    def _has_ended(self) -> None:
        if self.study.state in (StudyState.STARTING, StudyState.RUNNING):
            self.study = replace(self.study, state=StudyState.FAILED, message="its process ended by itself")
        self._on_news()
