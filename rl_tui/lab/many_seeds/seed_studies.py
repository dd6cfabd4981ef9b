"""What many seeds say of the runs of a playground: at most one study at a time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Final

from rl_tui.common.errors import UserError
from rl_tui.lab.many_seeds.figures import SeedStudy, StudyState
from rl_tui.lab.many_seeds.request import StudiedRun, StudyRequest, studied_runs, study_request
from rl_tui.lab.workers.answering_process import Background

if TYPE_CHECKING:
    from rl_tui.lab.timeline.run_group import RunGroup

WORK: Final = "rl_tui.lab.many_seeds.study:work"
"""What runs in its process: it needs much that this one need not load."""


class SeedStudies:
    """Has studies worked out in a process of their own, at the lowest priority.

    ``on_news`` is called, from any thread, when there is more to tell. With ``automatic`` off :meth:`begin`
    waits for the end of a study of one block, so that what is known does not depend on the time.
    """

    def __init__(self, on_news: Callable[[], None], *, automatic: bool) -> None:
        self._automatic = automatic
        self._background = Background[StudyRequest, SeedStudy](WORK, on_news)
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
            process = self._background.begin(request, request.nothing_yet)
        except (UserError, OSError) as reason:
            if isinstance(reason, UserError):
                self._refused = SeedStudy(StudyState.REFUSED, message=str(reason))
            else:
                why = f"no process can be started: {reason}"
                self._refused = SeedStudy(StudyState.FAILED, message=why)
            return
        if process is not None and not self._automatic:
            process.wait()

    def end(self) -> None:
        """End the study; nothing of it is known any more."""
        self._background.end()
        self._refused = None

    def close(self) -> None:
        """End the study, from any thread, and begin none any more."""
        self._background.close()

    def study_of(self, group: RunGroup) -> SeedStudy | None:
        """Return what is known by now, with whether it is of the runs of ``group``; None without a study."""
        study = self._study
        if study is None or studied_runs(group) == self._lanes:
            return study
        return replace(study, is_outdated=True)

    @property
    def _study(self) -> SeedStudy | None:
        process = self._background.process
        if process is None:
            return self._refused
        known = process.known
        if known.is_over:
            return known
        if process.failed:
            return replace(known, state=StudyState.FAILED, message=process.failed)
        return replace(known, how_long=process.how_long)
