"""What the open page of a lesson keeps back until it is done, and what the keys for it say."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from rl_tui.lessons.file.schema import HIDEABLE, Page
from rl_tui.lessons.file.view import LessonRecord
from rl_tui.live.commands import StudyPolicy
from rl_tui.live.snapshot import Phase
from rl_tui.screen.board.subject import Subject
from rl_tui.screen.kit.row import DISCOUNT, MANY_SEEDS, MICROSCOPE, POLICIES, WORLD_CHECK
from rl_tui.screen.panels.lesson.stage import keeping_page

NO_LESSON: Final = "there is no lesson here: rl-tui learn lists them"
PREDICT_FIRST: Final = "first your prediction: A says what you expect, . skips this page"
STAYS: Final = "esc leaves the lesson; its progress is kept"
_STEPS: Final = frozenset(
    {
        *("run.run_or_pause", "run.step", "run.episode", "run.evaluate", "run.improve", "run.watch"),
        *("until.choose", "manual.toggle", "lanes.compare"),
    }
)
"""What takes steps, of this run or another: refused while a prediction is open."""

_KEPT: Final[Mapping[str, tuple[str, ...]]] = {
    f"board.toggle('{POLICIES}')": ("policies",),
    "drawing.toggle": ("policies", "answer"),
    "why.explain": ("why",),
    f"board.toggle('{DISCOUNT}')": ("flips", "answer"),
    f"board.toggle('{WORLD_CHECK}')": ("policies", "why", "flips", "answer"),
    f"board.toggle('{MANY_SEEDS}')": ("many seeds",),
    "view.model": ("model",),
    f"board.toggle('{MICROSCOPE}')": ("model",),
    "view.hide_answer": ("answer",),
    "export.choose": ("answer",),
}
"""What a page may keep back, by the commands that would show it."""

_PANELS_KEPT: Final = {
    POLICIES: ("policies",),
    DISCOUNT: ("flips", "answer"),
    WORLD_CHECK: ("policies", "why", "flips", "answer"),
    MANY_SEEDS: ("many seeds",),
    MICROSCOPE: ("model",),
}
_ID_OF: Final = {
    f"board.toggle('{panel}')": f"board.{panel}"
    for panel in (POLICIES, DISCOUNT, WORLD_CHECK, MANY_SEEDS, MICROSCOPE)
}
_LEAVES: Final = frozenset({"scenario.previous", "scenario.following"})
_READING_GOES_ON: Final = ("lesson", "session", "export", "scenario", "why")
_ALSO_READING: Final = frozenset({"view.zoom", "view.model", "view.hide_answer"})
"""Commands that leave a page in view where it takes turns with the world."""


class KeptBack(Subject):
    """Refuses what would take a step before a prediction is in, or show what is to be found out."""

    @property
    def record(self) -> LessonRecord | None:
        """How far the learner has come, None where there is no lesson."""
        return self.link.wanted.lesson

    def refuses(self, command: str) -> bool:
        """Say why ``command`` has to wait, if a page keeps it back; return whether that is so."""
        record = self.record
        if record is None:
            if command.startswith("lesson."):
                self.screen.tell(NO_LESSON)
                return True
            return False
        if command in _LEAVES:
            self.screen.tell(STAYS)
            return True
        if command in _STEPS and "run" in record.hidden and not self._is_pause(command):
            self.screen.tell(PREDICT_FIRST)
            return True
        page = next((page for what in _KEPT.get(command, ()) if (page := keeping_page(record, what))), None)
        if page is not None:
            self.screen.tell(_kept_until(record, page))
            return True
        self._show_world_for(command)
        return False

    def refuses_to_act(self) -> bool:
        """Say that no step is taken, if a prediction is open; return whether that is so."""
        is_open = self.record is not None and "run" in self.record.hidden
        if is_open:
            self.screen.tell(PREDICT_FIRST)
        return is_open

    @property
    def idle_keys(self) -> frozenset[str]:
        """The ids of the actions that are refused now: the key line leaves them out."""
        record = self.record
        if record is None:
            return frozenset()
        kept = {command for command, names in _KEPT.items() if record.hidden.intersection(names)}
        if "run" in record.hidden:
            kept |= _STEPS
        return frozenset(kept | {_ID_OF.get(command, command) for command in kept})

    @property
    def notes(self) -> str:
        """What the help says in place of the notes of the scenario; empty where nothing is kept back."""
        record = self.record
        if record is None:
            return ""
        page = next((page for what in HIDEABLE if (page := keeping_page(record, what))), None)
        return "" if page is None else f"They are {_kept_until(record, page)}."

    def _is_pause(self, command: str) -> bool:
        phase = None if self.snapshot is None else self.snapshot.playback.phase
        return command == "run.run_or_pause" and phase in (Phase.RUNNING, Phase.SEEKING)

    def _show_world_for(self, command: str) -> None:
        """Let the world have the place again where what is done is to be seen there."""
        target = command.partition(".")[0]
        if (
            target not in _READING_GOES_ON
            and command not in _ALSO_READING
            and not self.board.lesson.is_docked
        ):
            self.board.lesson.reads = False

    def close_what_is_kept(self, record: LessonRecord) -> None:
        """Close what the page that ``record`` has open keeps back."""
        opened = self.board.opened
        if opened is not None and any(what in record.hidden for what in _PANELS_KEPT.get(opened, ())):
            self.board.close()
        if self.link.wanted.studied is not None and record.hidden & {"policies", "answer"}:
            self.link.send(StudyPolicy(None))


def _kept_until(record: LessonRecord, page: Page) -> str:
    if page.id != record.page:
        return f"kept back until page {record.lesson.number_of(page.id) + 1} is done"
    if page.prediction is not None:
        return "kept back until your prediction is in: A says what you expect, . skips this page"
    return "kept back until this page is done; . skips it"
