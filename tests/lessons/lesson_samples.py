"""A small valid lesson, into which tests put errors."""

from __future__ import annotations

from pathlib import Path
from typing import Final

from rl_tui.lessons.lesson import Lesson, lesson_of

SOUND: Final = """\
title = "A lesson for tests"
summary = "One of each kind of page."
minutes = 5
goals = ["Find faults"]

[figures]
first = { value = "−1", by = "alpha * reward('Class', 'study')" }
second = { value = "−1.5", by = "first + alpha * (reward('Class', 'study') - first)" }
best = { value = "7.5", by = "best_return()" }

[setups.evening]
scenario = "student"
settings = { algorithm = "q-learning", alpha = 0.5, gamma = 0.9, epsilon = 0.0, initial_q = 0.0 }
seed = 0

[[pages]]
id = "predict"
title = "The second update"
spotlight = "last_step"
text = "The first update makes it {first}, with α 0.5 and reward −2. Press `2`, see equation 6.8."
[pages.prediction]
ask = "What will Q(Class, study) be after the next one?"
answer = "{second}"
tolerance = 0.005
steps = 1
wrong = [{ answer = -2.5, reply = "−2.5 is too far." }]

[[pages]]
id = "ask"
title = "A question"
[pages.question]
ask = "Which is it?"
choices = [
    { text = "this one", reply = "Yes.", right = true },
    { text = "17 of them", reply = "No, not 17." },
]

[[pages]]
id = "do"
title = "Learn to study"
[pages.task]
do = "Study once by your own hand, in 3 steps or fewer."
hints = ["Take the step yourself."]
solution = "Take *study*."
conditions = [
    { text = "Q(Class, study) is below 0", measure = "q", state = "Class", action = "study", below = 0.0 },
    { text = "at least 1 step was yours", measure = "taken", at_least = 1 },
    { text = "3 steps or fewer", measure = "steps", at_most = 3 },
]
accepts = [{ name = "study", changes = ["0:take=study"] }]
rejects = [
    { name = "the phone", changes = ["0:take=check phone"] },
    { name = "four steps", changes = ["0:take=study"], steps = 4 },
    { name = "hands off", steps = 3 },
]

[[pages]]
id = "impossible"
title = "More than there is"
[pages.task]
do = "Reach a mean return of 8."
hints = ["What does the planner say?"]
solution = "It cannot be done: {best} is the best."
conditions = [{ text = "mean return of 8", measure = "expected_return", at_least = 8 }]
accepts = [{ name = "a claim", claim = true }]
rejects = [
    { name = "study", steps = 100 },
    { name = "explore", settings = { epsilon = 0.1 }, steps = 100 },
    { name = "hope", settings = { initial_q = 5.0 }, steps = 100 },
]
proof = { condition = 0, best = "best" }
"""


def changed(*changes: tuple[str, str]) -> str:
    text = SOUND
    for before, after in changes:
        assert text.count(before) == 1, f"{before!r} stands there {text.count(before)} times"
        text = text.replace(before, after)
    return text


def with_figures(*figures: str) -> Lesson:
    lines = "\n".join(("[figures]", *figures))
    return lesson_of(changed(("[figures]", lines)), Path("sample.toml"))


def written(folder: Path, text: str) -> str:
    path = folder / "sample.toml"
    path.write_text(text, encoding="utf-8")
    return str(path)
