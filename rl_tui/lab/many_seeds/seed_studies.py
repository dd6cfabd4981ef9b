"""What many seeds say of the runs of a playground: at most one study at a time."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final

from rl_tui.common.errors import UserError
from rl_tui.lab.many_seeds.figures import SeedStudy, StudyState
from rl_tui.lab.many_seeds.request import StudiedRun, StudyRequest, studied_runs, study_request
from rl_tui.lab.many_seeds.study_json import of_json
from rl_tui.lab.workers.answering_process import AnsweringProcess

if TYPE_CHECKING:
    from rl_tui.lab.timeline.run_group import RunGroup


WORKER: Final = "rl_tui.lab.many_seeds.worker"
"""What runs in it: it needs much that this process need not load."""


class StudyProcess(AnsweringProcess):
    """A process that works out ``request``, and ends with this one, however that ends.

    ``on_news`` is called, in a thread of its own, when ``study`` has become another. Raises OSError where no
    process can be started.
    """

    def __init__(self, request: StudyRequest, on_news: Callable[[], None]) -> None:
        self._known: SeedStudy = request.nothing_yet
        super().__init__(WORKER, request, self._take_in, self._has_ended, on_news, "many seeds")

    @property
    def study(self) -> SeedStudy:
        """What is known by now, and how it gets on."""
        if self._known.is_over:
            return self._known
        return replace(self._known, how_long=self.how_long)

    def _take_in(self, document: Any) -> None:
        self._known = of_json(document)
        self.pace.note(self._known.seeds / self._known.most if self._known.most else 0.0)

    def _has_ended(self) -> None:
        if not self._known.is_over:
            self._known = replace(self._known, state=StudyState.FAILED, message="its process ended by itself")


class SeedStudies:
    """Has studies worked out in a process of their own, at the lowest priority.

    ``on_news`` is called, from any thread, when there is more to tell. With ``automatic`` off :meth:`begin`
    waits for the end of a study of one block, so that what is known does not depend on the time.
    """

    def __init__(self, on_news: Callable[[], None], *, automatic: bool) -> None:
        self._on_news = on_news
        self._automatic = automatic
        self._lock = threading.Lock()  # guards the process and whether there may be one
        self._process: StudyProcess | None = None
        self._is_closed = False
        self._refused: SeedStudy | None = None
        self._lanes: tuple[StudiedRun, ...] = ()

    def begin(self, group: RunGroup) -> None:
        """Begin a study of the runs of ``group`` as they are now, in place of any other.

        Where there can be none, the study says why.
        """
        self.end()
        self._lanes = studied_runs(group)
        try:
            request = study_request(group, is_awaited=not self._automatic)
            with self._lock:
                if self._is_closed:
                    return
                process = self._process = StudyProcess(request, self._on_news)
        except (UserError, OSError) as reason:
            if isinstance(reason, UserError):
                self._refused = SeedStudy(StudyState.REFUSED, message=str(reason))
            else:
                why = f"no process can be started: {reason}"
                self._refused = SeedStudy(StudyState.FAILED, message=why)
            return
        if not self._automatic:
            process.wait()

    def end(self) -> None:
        """End the study; nothing of it is known any more."""
        with self._lock:
            process, self._process = self._process, None
        self._refused = None
        if process is not None:
            process.end()

    def close(self) -> None:
        """End the study, from any thread, and begin none any more."""
        with self._lock:
            self._is_closed = True
            if self._process is not None:
                self._process.end()

    def study_of(self, group: RunGroup) -> SeedStudy | None:
        """Return what is known by now, with whether it is of the runs of ``group``; None without a study."""
        process = self._process
        study = self._refused if process is None else process.study
        if study is None or studied_runs(group) == self._lanes:
            return study
        return replace(study, is_outdated=True)
