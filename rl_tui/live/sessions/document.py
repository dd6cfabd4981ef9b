"""The JSON document of a session, with its limits."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, Final, Literal

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, FailFast, Field, model_validator

from rl_tui.agents.catalogue import SweepPhase
from rl_tui.common.findings import control_character
from rl_tui.common.limits import LONGEST_EDIT
from rl_tui.lessons.file.schema import LONGEST_LESSON, LONGEST_PROGRAM

if TYPE_CHECKING:
    from rl_tui.lessons.lesson import Lesson

# Fields and their limits


FORMAT: Final = "rl-tui session"
VERSION: Final = 2
LONGEST_NAME: Final = 80
MOST_LANES: Final = 4
MOST_BRANCHES: Final = 1_000
MOST_ENTRIES: Final = 200_000
MOST_STEPS: Final = 10**15
_MOST_KEYS: Final = 100
_MOST_BREAKPOINTS: Final = 100_000
MOST_DRAWN: Final = 100_000
MOST_IN_ALL: Final = 20_000_000  # entries of all branches, with shared ones counted for each
_LONGEST_TEXT: Final = 20_000_000
# Taxi has 2,400 pairs. For this many, a file grows by 70 kB, and takes 2.7 ms to write and 2.2 ms to read.
MOST_PAIRS_KEPT: Final = 2_500
MOST_PAGES_NAMED: Final = 1_000
MOST_GIVEN: Final = 10_000


def _plain(text: str) -> str:
    character = control_character(text)
    if character:
        raise ValueError(f"{character} is a control character, which is not allowed")
    return text


def _of_few_keys(value: object) -> object:
    """Refuse an object with too many keys at once: an error for each would take a kilobyte."""
    if isinstance(value, dict) and len(value) > _MOST_KEYS:
        raise ValueError(f"{len(value):,} keys; expected at most {_MOST_KEYS}")
    return value


Name = Annotated[str, Field(max_length=LONGEST_NAME), AfterValidator(_plain)]
Word = Annotated[str, Field(max_length=200), AfterValidator(_plain)]
Number = Annotated[float, Field(allow_inf_nan=False)]
Count = Annotated[int, Field(ge=0, le=MOST_STEPS)]
Place = Annotated[int, Field(ge=0, le=10**12)]
Value = Number | Word
Digest = Annotated[str, Field(pattern=r"^([0-9a-f]{64})?$")]
Settings = Annotated[dict[Word, Value], BeforeValidator(_of_few_keys)]
DrawnChoice = Annotated[tuple[Place, Place], Field(strict=False)]


class Part(BaseModel):
    """An object that converts no values and refuses unknown keys."""

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True)

    @model_validator(mode="before")
    @classmethod
    def _has_few_keys(cls, value: object) -> object:
        return _of_few_keys(value)


class Entry(Part):
    """A change after `step` steps.

    Its keys are one of: `set` and `to` (a parameter), `algorithm`, `take` (an action of the user, by name or
    number), `sweep` (an order to a planner), or `world` (an edit as on the command line, an undo or a redo).
    """

    step: Count
    set: Word | None = None
    to: Value | None = None
    algorithm: Word | None = None
    take: Place | Name | None = None
    sweep: SweepPhase | None = None
    world: Annotated[str, Field(max_length=LONGEST_EDIT)] | None = None


class StoredBranch(Part):
    """A branch: `shared` counts its parent's entries, and `journal` has the others."""

    name: Name
    parent: Annotated[int, Field(ge=0, lt=MOST_BRANCHES)] | None = None
    fork: Count = 0
    end: Count = 0
    here: Count = 0
    shared: Annotated[int, Field(ge=0, le=MOST_ENTRIES)] = 0
    journal: Annotated[tuple[Entry, ...], FailFast(), Field(max_length=MOST_ENTRIES, strict=False)] = ()


class StoredLane(Part):
    """A run: its start, branches, and current one."""

    seed: Annotated[int, Field(ge=0)]
    algorithm: Word
    hyperparameters: Settings
    branches: Annotated[
        tuple[StoredBranch, ...], FailFast(), Field(min_length=1, max_length=MOST_BRANCHES, strict=False)
    ]
    branch: Annotated[int, Field(ge=0)]

    @model_validator(mode="after")
    def _check_numbers(self) -> StoredLane:
        if self.branch >= len(self.branches):
            raise ValueError(f"there is no branch {self.branch}")
        for number, branch in enumerate(self.branches):
            if branch.parent is not None and branch.parent >= number:
                raise ValueError(f"branch {number}: its parent comes after it")
        return self

    @property
    def algorithm_in_force(self) -> str:
        """Current algorithm, perhaps an ancestor's."""
        switches = (entry.algorithm for entry in self._entries_in_force() if entry.algorithm is not None)
        return next(switches, self.algorithm)

    @property
    def settings_in_force(self) -> dict[str, Value]:
        """Current hyperparameters by name."""
        settings = dict[str, Value]()
        for entry in self._entries_in_force():
            if entry.set is not None and entry.to is not None:
                settings.setdefault(entry.set, entry.to)
        return {**self.hyperparameters, **settings}

    def _entries_in_force(self) -> Iterator[Entry]:
        branch: StoredBranch | None = self.branches[self.branch]
        here, own = self.branches[self.branch].here, MOST_ENTRIES
        while branch is not None:
            left = max(0, own - branch.shared)
            yield from (entry for entry in reversed(branch.journal[:left]) if entry.step <= here)
            own = min(own, branch.shared)
            branch = None if branch.parent is None else self.branches[branch.parent]


class StoredScenario(Part):
    """The world: the text of its file, or a Gymnasium id."""

    id: Annotated[str, Field(min_length=1, max_length=400), AfterValidator(_plain)]
    kind: Literal["file", "gymnasium"]
    title: Word
    text: Annotated[str, Field(max_length=_LONGEST_TEXT)] = ""


class StoredBreakpoints(Part):
    """Numbers of states and pairs."""

    states: Annotated[tuple[Place, ...], FailFast(), Field(max_length=_MOST_BREAKPOINTS, strict=False)] = ()
    pairs: Annotated[tuple[Place, ...], FailFast(), Field(max_length=_MOST_BREAKPOINTS, strict=False)] = ()


class StoredTable(Part):
    """Q and visits of each pair, and the agent's state."""

    q: Annotated[tuple[Number, ...], FailFast(), Field(max_length=MOST_PAIRS_KEPT, strict=False)]
    visits: Annotated[tuple[Count, ...], FailFast(), Field(max_length=MOST_PAIRS_KEPT, strict=False)]
    episodes: Count
    state: Place

    @model_validator(mode="after")
    def _check_numbers(self) -> StoredTable:
        if len(self.q) != len(self.visits):
            raise ValueError(f"Q has {len(self.q):,} pairs, but visits has {len(self.visits):,}")
        return self


class StoredGiven(Part):
    """An answer: a number or choice. `step` is -1 without a run."""

    page: Name
    answer: Number
    right: bool
    step: Annotated[int, Field(ge=-1, le=MOST_STEPS)] = -1
    digest: Digest = ""


class StoredPassed(Part):
    """A passed task, proved by a run up to `step`."""

    page: Name
    scenario: StoredScenario
    seed: Annotated[int, Field(ge=0)]
    algorithm: Word
    hyperparameters: Settings
    journal: Annotated[tuple[Entry, ...], FailFast(), Field(max_length=MOST_ENTRIES, strict=False)] = ()
    step: Count
    claim: bool = False
    program: Annotated[str, Field(max_length=LONGEST_PROGRAM)] = ""


class StoredLesson(Part):
    """Progress in a lesson.

    `text` is the whole file, so that the session works anywhere. `source` is its path, empty for a shipped
    lesson. `hints` are counts by page.
    """

    id: Annotated[str, Field(min_length=1, max_length=200), AfterValidator(_plain)]
    title: Word
    text: Annotated[str, Field(max_length=LONGEST_LESSON)]
    source: Annotated[str, Field(max_length=4_000), AfterValidator(_plain)] = ""
    variant: Name = ""
    page: Name
    given: Annotated[tuple[StoredGiven, ...], FailFast(), Field(max_length=MOST_GIVEN, strict=False)] = ()
    passed: Annotated[
        tuple[StoredPassed, ...], FailFast(), Field(max_length=MOST_PAGES_NAMED, strict=False)
    ] = ()
    skipped: Annotated[tuple[Name, ...], FailFast(), Field(max_length=MOST_PAGES_NAMED, strict=False)] = ()
    hints: Annotated[dict[Name, Count], BeforeValidator(_of_few_keys)] = Field(default_factory=dict)
    finished: bool = False


class Document(Part):
    """A session without its checksum. Version 1 had no lessons."""

    format: Literal["rl-tui session"]
    version: Literal[1, 2]
    program: Word
    title: Name
    kept: bool
    saved: Annotated[str, Field(max_length=40)]
    scenario: StoredScenario
    lanes: Annotated[
        tuple[StoredLane, ...], FailFast(), Field(min_length=1, max_length=MOST_LANES, strict=False)
    ]
    shown: Annotated[int, Field(ge=0)]
    breakpoints: StoredBreakpoints
    speed: Annotated[float, Field(gt=0, allow_inf_nan=False)] | None
    digest: Digest
    answer_hidden: bool | None = None
    table: StoredTable | None = None
    # state and action number of each choice in the drawn policy
    drawn: Annotated[tuple[DrawnChoice, ...], FailFast(), Field(max_length=MOST_DRAWN, strict=False)] = ()
    lesson: StoredLesson | None = None

    @model_validator(mode="after")
    def _check_numbers(self) -> Document:
        if self.version == 1 and self.lesson is not None:
            raise ValueError("a session of format 1 has no lesson")
        if self.shown >= len(self.lanes):
            raise ValueError(f"there is no run {self.shown}")
        return self

    @property
    def changes(self) -> int:
        """Changes in all runs, shared ones once."""
        return sum(len(branch.journal) for lane in self.lanes for branch in lane.branches)


def stored_source(lesson: Lesson) -> str:
    """Return a lesson's path, "" if it is shipped."""
    from rl_tui.lessons.lesson import lesson_folder  # most sessions are of no lesson

    return "" if lesson.source.parent == lesson_folder() else str(lesson.source)
