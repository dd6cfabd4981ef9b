"""A process that works out an atlas, as seen by the program that shows it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any, Final

from rl_tui.lab.atlas.atlas_json import with_news
from rl_tui.lab.atlas.figures import Atlas, AtlasState
from rl_tui.lab.atlas.request import AtlasRequest
from rl_tui.lab.workers.answering_process import AnsweringProcess

WORKER: Final = "rl_tui.lab.atlas.worker"
"""What runs in it: it needs much that this process need not load."""


class AtlasProcess(AnsweringProcess):
    """A process that works out ``request``, and ends with this one, however that ends.

    ``on_news`` is called, in a thread of its own, when ``atlas`` has become another. Raises OSError where no
    process can be started.
    """

    def __init__(self, request: AtlasRequest, on_news: Callable[[], None]) -> None:
        self.atlas = Atlas(planned=request.cells.count * request.runs)
        """What is known by now."""
        super().__init__(WORKER, request, self._take_in, self._has_ended, on_news, "atlas")

    def _take_in(self, document: Any) -> None:
        self.atlas = with_news(self.atlas, document)
        self.pace.note(self.atlas.done / self.atlas.planned)

    def _has_ended(self) -> None:
        if not self.atlas.is_over:
            self.atlas = replace(self.atlas, state=AtlasState.FAILED, message="its process ended by itself")
