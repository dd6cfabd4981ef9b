"""What the open page of a lesson keeps back until it is done, and what the keys for it say."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from rl_tui.lessons.file.schema import HIDEABLE, Page
from rl_tui.lessons.file.view import LessonRecord
from rl_tui.live.commands import StudyPolicy
from rl_tui.live.snapshot import Phase
from rl_tui.screen.board.subject import Subject
from rl_tui.screen.keys.action import Action
from rl_tui.screen.kit.row import DISCOUNT, MANY_SEEDS, MICROSCOPE, POLICIES, WORLD_CHECK
from rl_tui.screen.panels.lesson.words import keeping_page

NO_LESSON: Final = "there is no lesson here: rl-tui learn lists them"
PREDICT_FIRST: Final = "first your prediction: A says what you expect, . skips this page"
STAYS: Final = "esc leaves the lesson; its progress is kept"
_STEPS: Final = frozenset(
    {
        *("run.run_or_pause", "run.step", "run.episode", "run.evaluate", "run.improve", "run.watch"),
        *("until.choose", "manual.toggle", "lanes.another_algorithm"),
        *("lanes.another_setting", "lanes.another_seed", "lanes.another_branch"),
    }
)
"""What takes steps, of this run or another: refused while a prediction is open."""

_PANELS_KEPT: Final[Mapping[str, tuple[str, ...]]] = {
    POLICIES: ("policies",),
    DISCOUNT: ("flips", "answer"),
    WORLD_CHECK: ("policies", "why", "flips", "answer"),
    MANY_SEEDS: ("many seeds",),
    MICROSCOPE: ("model",),
}
"""What a page may keep back, by the panel that shows it."""

_KEPT: Final[Mapping[str, tuple[str, ...]]] = {
    **{f"board.toggle('{panel}')": kept for panel, kept in _PANELS_KEPT.items()},
    "drawing.toggle": ("policies", "answer"),
    "why.explain": ("why",),
    "view.model": ("model",),
    "view.hide_answer": ("answer",),
    "export.choose": ("answer",),
}
"""The same, by the command that would show it."""
_LEAVES: Final = frozenset({"scenario.previous", "scenario.following"})
_READING_GOES_ON: Final = ("menus", "lesson", "session", "export", "scenario", "why")
_ALSO_READING: Final = frozenset({"view.zoom", "view.model", "view.hide_answer"})
"""Commands that leave a page in view where it takes turns with the world."""


class KeptBack(Subject):
    """Refuses what would take a step before a prediction is in, or show what is to be found out."""

    @property
    def record(self) -> LessonRecord | None:
        """How far the learner has come, None where there is no lesson."""
        return self.link.wanted.lesson

    def why_not_yet(self, action: Action) -> str:
        """Return why ``action`` has to wait, as a clause; empty where no page of a lesson hides it."""
        record, command = self.record, action.command or action.id
        if record is None:
            return NO_LESSON if action.of_lesson else ""
        if command in _LEAVES:
            return STAYS
        phase = None if self.snapshot is None else self.snapshot.playback.phase
        pauses = command == "run.run_or_pause" and phase in (Phase.RUNNING, Phase.SEEKING)
        if command in _STEPS and "run" in record.hidden and not pauses:
            return PREDICT_FIRST
        page = next((page for what in _KEPT.get(command, ()) if (page := keeping_page(record, what))), None)
        return "" if page is None else _kept_until(record, page)

    def refuses_to_act(self) -> bool:
        """Say that no step is taken, if a prediction is open; return whether that is so."""
        is_open = self.record is not None and "run" in self.record.hidden
        if is_open:
            self.screen.refuse(PREDICT_FIRST)
        return is_open

    @property
    def notes(self) -> str:
        """What the help says in place of the notes of the scenario; empty where nothing is kept back."""
        record = self.record
        if record is None:
            return ""
        page = next((page for what in HIDEABLE if (page := keeping_page(record, what))), None)
        return "" if page is None else f"They are {_kept_until(record, page)}."

    def show_world_for(self, command: str) -> None:
        """Let the world have the place again where what is done is to be seen there."""
        target = command.partition(".")[0]
        goes_on = target in _READING_GOES_ON or command in _ALSO_READING
        if not goes_on and not self.board.lesson.is_docked:
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
