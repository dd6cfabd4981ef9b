"""The schema of a lesson file."""

from __future__ import annotations

import re
from typing import Annotated, Any, Final

from pydantic import Field, model_validator

from rl_tui.common.findings import shown
from rl_tui.worlds.sections.schema import (
    Expect,
    FileSection,
    Number,
    TruthValue,
    is_table,
    markdown,
    number,
    refused,
    sized,
    text,
    whole_number,
)

LONGEST_LINE: Final = 300
LONGEST_TEXT: Final = 6_000
LONGEST_WORLD: Final = 100_000
LONGEST_PROGRAM: Final = 200_000
LONGEST_SHORT_LINE: Final = 60
LONGEST_LESSON: Final = 1_000_000
MOST_PAGES: Final = 60
MOST_IN_A_LIST: Final = 60
MOST_SEEDS: Final = 1_000
MOST_STEPS: Final = 10**9

HIDEABLE: Final = ("answer", "policies", "why", "flips", "many seeds", "model", "run")
"""What a page may hide until its prediction is given. `run` means everything that takes steps."""

_WORD: Final = re.compile(r"[a-z][a-z0-9_-]*")
_PYTHON_FILE: Final = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_-]*\.py")


def is_word(value: object) -> bool:
    """Return True for names of pages, setups and figures."""
    return isinstance(value, str) and len(value) <= 60 and _WORD.fullmatch(value) is not None


def is_file_name(value: object) -> bool:
    """Return True for a program file in any folder."""
    return isinstance(value, str) and len(value) <= 60 and _PYTHON_FILE.fullmatch(value) is not None


def _list(what: str, least: int = 0) -> Expect:
    return Expect(f"a list of {least} to {MOST_IN_A_LIST} {what}", sized(list, MOST_IN_A_LIST, least))


# defined here because a field named `text` would shadow the function
Line = Annotated[str, text(LONGEST_LINE)]
ShortLine = Annotated[str, text(LONGEST_SHORT_LINE)]
FileName = Annotated[str, text(400)]
Expression = Annotated[str, text(500)]
Prose = Annotated[str, markdown(LONGEST_TEXT)]
Word = Annotated[str, Expect("a name of small letters, digits, - and _, such as first-walk", is_word)]
Count = Annotated[int, whole_number(0, MOST_STEPS)]
Table = Annotated[dict[str, Any], Expect("a table", is_table)]
Value = Annotated[
    float | str | bool,
    Expect("a number, a string, true or false", lambda value: isinstance(value, int | float | str)),
]


class Figure(FileSection):
    """A number in the texts: `value` as written, and `by`, its expression in the world of `setup` (default
    the first).
    """

    value: ShortLine
    by: Expression
    setup: Word | None = None


class Setup(FileSection):
    """The start of a run: a scenario by id or file, or a `world` as text.

    `settings` replace the scenario's algorithm and hyperparameters. `speed` is in steps per second.
    """

    scenario: FileName = ""
    world: Annotated[str, markdown(LONGEST_WORLD)] = ""
    settings: Table = Field(default_factory=dict)
    seed: Annotated[int, whole_number(0, 2**31)] = 0
    speed: Annotated[float | None, number(0.1, 1e9)] = None

    @model_validator(mode="after")
    def _has_one_world(self) -> Setup:
        if bool(self.scenario) == bool(self.world):
            raise refused("both or neither of scenario and world", "exactly one of them")
        return self


class AnswerChoice(FileSection):
    """A choice with its reply."""

    text: Line
    reply: Prose
    right: TruthValue = False


class WrongAnswer(FileSection):
    """A known wrong number with its reply."""

    answer: Number
    reply: Prose


class Measured(FileSection):
    """A metric with its arguments. `at = "start"` reads the settings of the first step, not the last."""

    measure: Word
    state: ShortLine | None = None
    action: ShortLine | None = None
    actions: Annotated[tuple[str, ...], _list("actions")] = ()
    first: Count | None = None
    last: Count | None = None
    at: Annotated[str, Expect("start or now", lambda value: value in ("start", "now"))] = "now"


class Ask(FileSection):
    """A prediction or question: a number, right within `tolerance`, or several `choices`.

    The answer to a prediction is revealed after `steps` further steps with the `keys` on the page. `shows` is
    a metric of the run at that step.
    """

    ask: Prose
    answer: Number | None = None
    tolerance: Annotated[float, number(0)] = 0.0
    wrong: Annotated[tuple[WrongAnswer, ...], _list("wrong answers")] = ()
    choices: Annotated[tuple[AnswerChoice, ...], _list("choices")] = ()
    steps: Count = 0
    keys: Annotated[tuple[ShortLine, ...], _list("keys")] = ()
    shows: Measured | None = None

    @model_validator(mode="after")
    def _has_one_answer(self) -> Ask:
        if (self.answer is None) != bool(self.choices):
            raise refused("both or neither of answer and choices", "a number as answer, or choices")
        if len(self.choices) == 1:
            raise refused("1 choice", "two or more")
        if self.choices and not any(choice.right for choice in self.choices):
            raise refused("no choice with right = true", "a right choice")
        if self.shows is not None and not self.steps:
            raise refused("shows without steps", "steps: the number of steps until it is measured")
        if self.keys and not self.steps:
            raise refused("keys without steps", "steps: the number of steps until the result")
        return self

    def is_right(self, answer: float) -> bool:
        """Return True if `answer` is right: a number within `tolerance`, or the index of a choice."""
        if self.choices:
            return answer in range(len(self.choices)) and self.choices[int(answer)].right
        rounding = 1e-9 * max(1.0, abs(answer))
        return self.answer is not None and abs(answer - self.answer) <= self.tolerance + rounding


class Condition(Measured):
    """A metric and its bounds.

    With `seeds`, the run is repeated under that many seeds from 0 with its initial settings, for `episodes`
    or `steps`. The bounds must then be met in `hold` of them, or by the mean with `mean`.
    """

    text: Line
    at_least: Number | None = None
    at_most: Number | None = None
    above: Number | None = None
    below: Number | None = None
    equals: Value | None = None
    one_of: Annotated[tuple[float | str, ...], _list("values")] = ()
    seeds: Annotated[int, whole_number(0, MOST_SEEDS)] = 0
    hold: Count = 0
    mean: TruthValue = False
    episodes: Count | None = None
    steps: Count | None = None

    @model_validator(mode="after")
    def _asks_something(self) -> Condition:
        bounds = (self.at_least, self.at_most, self.above, self.below, self.equals)
        if all(bound is None for bound in bounds) and not self.one_of:
            raise refused(shown(self.measure), "one of at_least, at_most, above, below, equals, one_of")
        if self.seeds and not self.mean and not 0 < self.hold <= self.seeds:
            raise refused(
                f"hold = {self.hold}", f"hold from 1 to {self.seeds}: the number of seeds that must pass"
            )
        if self.seeds and (self.episodes is None) == (self.steps is None):
            raise refused("both or neither of episodes and steps", "one of them, for the length of each run")
        return self


class Attempt(FileSection):
    """A recorded attempt: settings from the start, changes as for `train --change`, and its length.

    `claim` means that the task was called impossible, and `program` is the submitted code.
    """

    name: Line
    settings: Table = Field(default_factory=dict)
    changes: Annotated[tuple[str, ...], Expect("a list of changes, STEP:NAME=VALUE", sized(list, 2_000))] = ()
    steps: Count | None = None
    episodes: Count | None = None
    claim: TruthValue = False
    program: Annotated[str, markdown(LONGEST_WORLD)] = ""


class ImpossibilityProof(FileSection):
    """A proof that a task is impossible: `best` is the figure of the best possible value in `condition`."""

    condition: Count
    best: Word


class ProgramToWrite(FileSection):
    """A program to write: its file name and initial code."""

    file: Annotated[str, Expect("the name of a Python file, such as my_agent.py", is_file_name)]
    skeleton: Annotated[str, markdown(LONGEST_WORLD)]


class Task(FileSection):
    """A task, judged by a replay of the run: all `conditions` at one step.

    `hints` come one by one, then the `solution`. `accepts` and `rejects` are attempts that must pass and
    fail. With a `proof` the task is impossible, and saying so is right. With a `program`, that is watched.
    """

    do: Prose
    conditions: Annotated[tuple[Condition, ...], _list("conditions", 1)]
    hints: Annotated[tuple[Prose, ...], _list("hints")] = ()
    solution: Prose = ""
    accepts: Annotated[tuple[Attempt, ...], _list("attempts")] = ()
    rejects: Annotated[tuple[Attempt, ...], _list("attempts")] = ()
    proof: ImpossibilityProof | None = None
    program: ProgramToWrite | None = None


class Page(FileSection):
    """A text and at most one prediction, question or task.

    `setup` begins another run if it differs. `spotlight` is the panel to look at, and `panels` are the
    visible ones (default those of the page before, or all). `hides` applies until the page is done, when the
    `explanation` appears. `guess` marks a prediction that cannot be derived, and is not scored.
    """

    id: Word
    title: ShortLine
    text: Prose = ""
    setup: Word | None = None
    spotlight: Word | None = None
    panels: Annotated[tuple[Word, ...], _list("panels", 1)] | None = None
    hides: Annotated[
        tuple[str, ...],
        Expect(
            f"a list of {', '.join(HIDEABLE)}",
            lambda value: isinstance(value, list) and all(each in HIDEABLE for each in value),
        ),
    ] = ()
    prediction: Ask | None = None
    guess: TruthValue = False
    question: Ask | None = None
    task: Task | None = None
    explanation: Prose = ""

    @model_validator(mode="after")
    def _asks_one_thing(self) -> Page:
        asked = [name for name in ("prediction", "question", "task") if getattr(self, name) is not None]
        if len(asked) > 1:
            raise refused(" and ".join(asked), "at most one of them on a page")
        if self.question is not None and self.question.shows is not None:
            raise refused(
                "a question that shows a measure", "a prediction, because a question does not wait for steps"
            )
        if self.guess and self.prediction is None:
            raise refused("guess without a prediction", "a prediction, or no guess")
        return self

    @property
    def asked(self) -> Ask | None:
        """The prediction or question, if any."""
        return self.prediction or self.question


class LessonFile(FileSection):
    """A lesson file.

    `order` is its position, `minutes` its duration, and `core` marks the core course. `variants` lists the
    values for each name: `${name}` is replaced by the value at the variant's position.
    """

    title: ShortLine
    summary: Line
    order: Annotated[int, whole_number(0, 1_000_000)] = 1_000_000
    core: TruthValue = False
    minutes: Annotated[int, whole_number(1, 600)]
    goals: Annotated[tuple[Line, ...], _list("goals", 1)]
    variants: Table = Field(default_factory=dict)
    figures: Annotated[dict[str, Figure], Expect("a table of figures", sized(dict, 300))] = Field(
        default_factory=dict
    )
    setups: Annotated[dict[str, Setup], Expect("a table of setups", sized(dict, 30, 1))]
    pages: Annotated[
        tuple[Page, ...], Expect(f"a list of 1 to {MOST_PAGES} pages", sized(list, MOST_PAGES, 1))
    ]
