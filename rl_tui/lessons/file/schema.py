"""A lesson file: what may stand in its tables."""

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
"""What a page may keep back until its prediction is in; ``run`` is whatever takes a step."""

_WORD: Final = re.compile(r"[a-z][a-z0-9_-]*")
_PYTHON_FILE: Final = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_-]*\.py")


def is_word(value: object) -> bool:
    """Return whether a value can name a page, a setup or a figure."""
    return isinstance(value, str) and len(value) <= 60 and _WORD.fullmatch(value) is not None


def is_file_name(value: object) -> bool:
    """Return whether a value can name the file of a program, in whatever folder."""
    return isinstance(value, str) and len(value) <= 60 and _PYTHON_FILE.fullmatch(value) is not None


def _list(what: str, least: int = 0) -> Expect:
    return Expect(f"a list of {least} to {MOST_IN_A_LIST} {what}", sized(list, MOST_IN_A_LIST, least))


# made here: in a table with a key of that name, text would be the key
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
    Expect("a number, a text, true or false", lambda value: isinstance(value, int | float | str)),
]


class Figure(FileSection):
    """A number of the lesson's texts: ``value`` as it stands there, and ``by`` what it is worked out.

    ``by`` is an expression over the world of ``setup``, the first one where that is not given.
    """

    value: ShortLine
    by: Expression
    setup: Word | None = None


class Setup(FileSection):
    """How a run of the lesson begins: a scenario by its id or file, or a ``world`` written out as one.

    ``settings`` are the algorithm and hyper-parameters where they are not the scenario's. ``speed`` is in
    steps a second.
    """

    scenario: FileName = ""
    world: Annotated[str, markdown(LONGEST_WORLD)] = ""
    settings: Table = Field(default_factory=dict)
    seed: Annotated[int, whole_number(0, 2**31)] = 0
    speed: Annotated[float | None, number(0.1, 1e9)] = None

    @model_validator(mode="after")
    def _has_one_world(self) -> Setup:
        if bool(self.scenario) == bool(self.world):
            raise refused("both or neither of scenario and world", "one of them")
        return self


class AnswerChoice(FileSection):
    """One answer to choose, and what is said to who chooses it."""

    text: Line
    reply: Prose
    right: TruthValue = False


class WrongAnswer(FileSection):
    """A known wrong number, and what is said to who gives it: where it comes from."""

    answer: Number
    reply: Prose


class Measured(FileSection):
    """What is measured of a run: a name of ``judging/measures``, with its arguments.

    These are ``state``, ``action``, ``actions`` and the like; ``at = "start"`` asks for the settings of the
    first step, not of the last.
    """

    measure: Word
    state: ShortLine | None = None
    action: ShortLine | None = None
    actions: Annotated[tuple[str, ...], _list("actions")] = ()
    first: Count | None = None
    last: Count | None = None
    at: Annotated[str, Expect("start or now", lambda value: value in ("start", "now"))] = "now"


class Ask(FileSection):
    """Something to answer: a number, right within ``tolerance``, or one of several ``choices``.

    Of a prediction, the truth is shown once ``steps`` more steps were taken, by the ``keys`` that the page
    asks for, in their order; ``shows`` is measured of the run at that very step, to stand beside it.
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
        if self.choices and (len(self.choices) < 2 or not any(choice.right for choice in self.choices)):
            raise refused(f"{len(self.choices)} choices", "two or more, one of them with right = true")
        if self.shows is not None and not self.steps:
            raise refused("shows without steps", "in how many steps it is measured: steps")
        if self.keys and not self.steps:
            raise refused("keys without steps", "how many steps they take to the truth: steps")
        return self

    def is_right(self, answer: float) -> bool:
        """Return whether ``answer`` is right: the number within the tolerance, or the place of a choice."""
        if self.choices:
            return answer in range(len(self.choices)) and self.choices[int(answer)].right
        rounding = 1e-9 * max(1.0, abs(answer))
        return self.answer is not None and abs(answer - self.answer) <= self.tolerance + rounding


class Condition(Measured):
    """One condition of a task: a ``measure`` of the run, and what it has to be.

    With ``seeds`` the run is begun again under so many seeds, 0 first, with the settings that it began with,
    for ``episodes`` (or ``steps``), and the measure has to hold in ``hold`` of them; with ``mean`` it is the
    mean over all that has to.
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
            raise refused(
                shown(self.measure), "what it has to be: at_least, at_most, above, below, equals, one_of"
            )
        if self.seeds and not self.mean and not 0 < self.hold <= self.seeds:
            raise refused(f"hold = {self.hold}", f"in how many of the {self.seeds} seeds it has to hold")
        if self.seeds and (self.episodes is None) == (self.steps is None):
            raise refused("both or neither of episodes and steps", "how far each seed goes")
        return self


class Attempt(FileSection):
    """What somebody did to solve a task, recorded: settings from the start, changes on the way, how far.

    ``changes`` are written as for ``train --change``. ``claim`` says that it was called impossible,
    ``program`` is the code that was handed in.
    """

    name: Line
    settings: Table = Field(default_factory=dict)
    changes: Annotated[tuple[str, ...], Expect("a list of changes, STEP:NAME=VALUE", sized(list, 2_000))] = ()
    steps: Count | None = None
    episodes: Count | None = None
    claim: TruthValue = False
    program: Annotated[str, markdown(LONGEST_WORLD)] = ""


class ImpossibilityProof(FileSection):
    """Why a task cannot be done: the best that there is of the condition's measure, a name of a figure."""

    condition: Count
    best: Word


class ProgramToWrite(FileSection):
    """Code that a learner writes: the name of its file, and what stands in it at first."""

    file: Annotated[str, Expect("the name of a Python file, such as my_agent.py", is_file_name)]
    skeleton: Annotated[str, markdown(LONGEST_WORLD)]


class Task(FileSection):
    """Something to do, judged from the replay of the run alone: all ``conditions`` at one step of it.

    ``hints`` come one by one, then the ``solution``. ``accepts`` and ``rejects`` are attempts that it has to
    pass and to refuse. With a ``proof`` it cannot be done, and to say so is right. With a ``program`` it is
    judged by watching that.
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
    """One page: a text and at most one of a prediction, a question and a task.

    ``setup`` begins another run than the page before, where it differs. ``spotlight`` is the id of the panel
    to look at; ``panels`` are the ids of those in view, by default those of the page before, and all where no
    page names any. ``hides`` is hidden until the page is done. The ``explanation`` is shown once it is.
    ``guess`` marks a prediction that cannot be worked out: it does not count among the right ones.
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
            raise refused("a question that shows a measure", "a prediction: a question waits for no step")
        if self.guess and self.prediction is None:
            raise refused("guess without a prediction", "a prediction, or no guess")
        return self

    @property
    def asked(self) -> Ask | None:
        """The prediction or the question, None where there is neither."""
        return self.prediction or self.question


class LessonFile(FileSection):
    """A whole lesson file. ``order`` places it among the others; ``minutes`` is about how long it takes.

    ``core`` marks the lessons of the core course.

    ``variants`` has for each name the values it may take: the file is read with ``${name}`` replaced by one
    of them, the same place of each list for one variant.
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
