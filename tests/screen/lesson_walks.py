"""A learner who takes a lesson with keys."""

from __future__ import annotations

from collections.abc import AsyncIterator, Mapping
from contextlib import asynccontextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from seams import app_at, choose, notes, on_screen, playground, press, snapshot
from textual.pilot import Pilot
from textual.widgets import OptionList

from rl_tui.agents.hyperparameters import PARAMETERS
from rl_tui.common.errors import UserError
from rl_tui.lessons.file.schema import Ask, Attempt, Page
from rl_tui.lessons.file.view import LessonRecord, LessonView, begun
from rl_tui.lessons.judging.conditions import judged_task
from rl_tui.lessons.lesson import Lesson
from rl_tui.live.sessions.progress import LessonStart
from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.runs.changes import ALGORITHM, SWEEP, TAKE, name_and_value, read_change
from rl_tui.runs.recipe import JournalEntry
from rl_tui.screen.app.screenshot import settle
from rl_tui.screen.dialogs.dialog import Confirm
from rl_tui.screen.panels.controls.slider import Slider
from rl_tui.screen.panels.lesson.words import open_page
from rl_tui.screen.playground.actions.lesson import NOT_DONE
from rl_tui.screen.playground.modes.action_keys import action_towards, acts_in, digit_keys, has_directions
from rl_tui.screen.playground.modes.mode import STEPS

BY_HAND: Final[Mapping[tuple[str, str], tuple[str, ...]]] = {
    ("loop", "second"): ("down", "down", "right", "right", "down", "right"),
    ("loop", "hole"): ("down", "right"),
    ("q-by-hand", "first"): ("study",),
    ("q-by-hand", "second"): ("study",),
    ("q-by-hand", "end"): ("sleep",),
    ("q-by-hand", "fourth"): ("study",),
    ("q-by-hand", "fifth"): ("sleep",),
    ("q-by-hand", "sixth"): ("study",),
    ("q-by-hand", "zero"): ("check phone",),
    ("beyond-tables", "same-bin"): ("left", "left"),
}
"""Actions that a text or a prediction asks for, and that the agent would not take."""

_FEW: Final = 4  # steps taken singly
_NAMED: Final = {"-": "minus", ".": "full_stop", ",": "comma"}


@dataclass
class Learner:
    """Takes ``lesson`` by the keys of ``pilot``. Pages turn only by their keys."""

    pilot: Pilot[UserError]
    lesson: Lesson

    @property
    def now(self) -> Snapshot:
        return snapshot(self.pilot)

    @property
    def view(self) -> LessonView:
        view = self.now.lesson
        assert view is not None
        return view

    @property
    def record(self) -> LessonRecord:
        return self.view.record

    @property
    def page(self) -> Page:
        return open_page(self.record)

    async def keys(self, *keys: str) -> None:
        """Press ``keys``, none of which may turn the page."""
        page = self.record.page
        await press(self.pilot, *keys)
        assert self.record.page == page, f"{keys} turned the page {page}"

    async def type(self, text: str) -> None:
        await self.pilot.press(*(_NAMED.get(each, each) for each in text), "enter")
        await settle(self.pilot)

    # Reading

    async def read(self) -> str:
        place = playground(self.pilot).board.lesson
        if not place.is_in_view:
            await self.keys("enter")
        panel = place.panel
        rows = (panel.render_line(y).text.rstrip(" │█").strip(" ┃") for y in range(panel.size.height))
        return " ".join([panel.heading, *" ".join(rows).split()])

    async def turn(self) -> None:
        """Turn to the next page. At the end of a page, one press must be enough."""
        await self.read()
        before = self.record.page
        while playground(self.pilot).board.lesson.panel.scroll_page(1):
            pass
        await press(self.pilot, "pagedown")
        assert NOT_DONE not in notes(self.pilot.app), f"the page {before} is not done"
        assert self.record.page != before

    # Answering

    async def answer(self, ask: Ask, answer: float) -> None:
        await self.read()
        await self.keys("enter")
        if ask.choices:
            await choose(self.pilot, str(int(answer)))
        else:
            await self.type(f"{answer:.12g}")

    # The run

    async def set_up(self) -> None:
        await self.keys("r", "p")
        if isinstance(self.pilot.app.screen, Confirm):
            await self.keys("enter")
        assert self.now.counters.step == 0
        setup = judged_task(self.lesson, self.record.page).setup
        assert self.now.recipe == setup, "r p has brought other settings back"

    async def set(self, name: str, value: float | str) -> None:
        agent = self.now.agent
        in_force = agent.algorithm if name == ALGORITHM else agent.hyperparameters.value(name)
        if in_force == value:
            return
        sliders = [each.parameter.name for each in playground(self.pilot).query(Slider)]
        if name in (ALGORITHM, "policy"):
            await self.keys("a", "a" if name == ALGORITHM else "p")
            await choose(self.pilot, str(value))
        elif name == "ties":
            await self.keys("a", "t")
        elif name == "initial_q":
            await self.keys("r", "i")
            await self.type(_written(value))
        elif name in sliders and not isinstance(value, str):
            if self._is_manual:
                await self.keys("y")
            await self.keys(str(1 + sliders.index(name)), "enter")
            await self.type(_written(value))
        else:
            await self._set_option(name, value)
        agent = self.now.agent
        assert (agent.algorithm if name == ALGORITHM else agent.hyperparameters.value(name)) == value

    async def _set_option(self, name: str, value: float | str) -> None:
        await self.keys("a", "o")
        listed = self.pilot.app.screen.query_one(OptionList)
        if name not in {option.id for option in listed.options}:
            await choose(self.pilot, "schedules")
        await choose(self.pilot, name)
        if PARAMETERS[name].range is None or isinstance(value, str):
            await choose(self.pilot, str(value))
        else:
            await self.type(_written(value))
        await self.keys("escape")

    async def act(self, name: str) -> None:
        if not self._is_manual:
            await self.keys("y")
            assert self._is_manual, notes(self.pilot.app)
        before, place = self.now, playground(self.pilot).board.lesson
        key = _key_of(before, before.world.space.action_names.index(name))
        if key in STEPS and place.panel.takes_turns:
            await self.keys("escape")  # on the page arrows scroll
        await self.keys(key)
        assert self.now.counters.step == before.counters.step + 1

    @property
    def _is_manual(self) -> bool:
        return playground(self.pilot).manual.is_on

    async def sweep(self, phase: str) -> None:
        await self.keys("a", phase[0])

    async def run_to(self, step: int) -> None:
        missing = step - self.now.counters.step
        assert missing >= 0, f"step {step} is over"
        if missing <= _FEW:
            await self.keys(*"s" * missing)
        else:
            await self._until("step", step)

    async def run_episodes(self, count: int) -> None:
        missing = count - self.now.counters.episodes
        if missing <= _FEW:
            await self.keys(*"e" * max(0, missing))
        else:
            await self._until("episode", count + 1)

    async def _until(self, event: str, number: int) -> None:
        await self.keys("u")
        await choose(self.pilot, event)
        await self.type(str(number))

    async def attempt(self, attempt: Attempt) -> None:
        """Repeat a recorded attempt: its settings first, then its changes on the way, then the rest."""
        if attempt.program:
            await self.write_program(attempt.program)
            return
        for name, value in _in_order(attempt.settings):
            await self.set(name, value)
        if attempt.settings:
            await self.keys("r", "r")
        for entry in map(read_change, attempt.changes):
            await self._change(entry)
        if attempt.episodes is not None:
            await self.run_episodes(attempt.episodes)
        elif attempt.steps is not None and not self._is_done:
            await self.run_to(attempt.steps)
        if attempt.claim:
            await self.read()
            await self.keys("enter", "2")

    async def write_program(self, code: str) -> None:
        task = self.page.task
        file = Path(task.program.file)
        await self.read()
        if not file.exists():
            await self.keys("enter", "enter")
            assert file.read_text(encoding="utf-8") == task.program.skeleton
        file.write_text(code, encoding="utf-8")
        await self.keys("enter", "enter")

    async def _change(self, entry: JournalEntry) -> None:
        await self.run_to(entry.step)
        name, value = name_and_value(entry.change)
        if name == TAKE:
            await self.act(str(value))
        elif name == SWEEP:
            await self.sweep(str(value))
        else:
            await self.set(name, value)

    @property
    def _is_done(self) -> bool:
        return self.now.playback.phase is Phase.DONE


@asynccontextmanager
async def taking(
    lesson: Lesson, size: tuple[int, int], sessions: Path | None = None, page: str = ""
) -> AsyncIterator[Learner]:
    record = begun(lesson)
    start = LessonStart(record.open(page) if page else record)
    async with on_screen(app_at(start, sessions=sessions), size, notifications=True) as pilot:
        yield Learner(pilot, lesson)


def right_answer(ask: Ask) -> float:
    if ask.answer is not None:
        return ask.answer
    return next(place for place, choice in enumerate(ask.choices) if choice.right)


def wrong_answer(ask: Ask) -> float:
    if ask.wrong:
        return ask.wrong[0].answer
    return next(place for place, choice in enumerate(ask.choices) if not choice.right)


def _key_of(snapshot: Snapshot, action: int) -> str:
    """The key of ``action``: an arrow in worlds with directions, otherwise a digit."""
    world, state = snapshot.world, acts_in(snapshot)
    if has_directions(world):
        arrow = (key for key, step in STEPS.items() if action_towards(world, state, step) == action)
        if key := next(arrow, ""):
            return key
    return next(key for key, meant in digit_keys(world, state).items() if meant == action)


def _in_order(settings: Mapping[str, float | str]) -> list[tuple[str, float | str]]:
    """Algorithm and policy come first."""
    first = (ALGORITHM, "policy")
    return sorted(settings.items(), key=lambda item: first.index(item[0]) if item[0] in first else len(first))


def _written(value: float | str) -> str:
    return value if isinstance(value, str) else f"{value:g}"
