"""A lesson with a page of each kind."""

from __future__ import annotations

from pathlib import Path
from typing import Final

from rl_tui.lessons.lesson import Lesson, lesson_of

TEXT: Final = '''
title = "Q-learning by hand"
summary = "Seven steps, one cell each."
minutes = 20
goals = ["Work out an update"]
[figures]
second = { value = "−1.5", by = "1" }
[setups.evening]
scenario = "student"
settings = { algorithm = "q-learning", alpha = 0.5, gamma = 0.9, epsilon = 0.0, initial_q = 0.0 }
[setups.lake]
scenario = "frozenlake"
[[pages]]
id = "start"
title = "One cell a step"
setup = "evening"
spotlight = "table"
text = """
Each step moves **one cell** of the table, and `α` says how far:

    Q(s,a) ← Q(s,a) + α · δ

- [bold]this[/bold] is no markup
"""
[[pages]]
id = "predict"
title = "The second update"
hides = ["answer", "policies", "why", "flips", "many seeds", "model"]
text = "Study failed once."
spotlight = "microscope"
explanation = "Half the way from −1 to the target −2."
[pages.prediction]
ask = "What will Q(Class, study) be after two more steps?"
answer = "{second}"
tolerance = 0.005
steps = 2
wrong = [{ answer = -2, reply = "That is the target: **α** was forgotten." }]
[[pages]]
id = "quiz"
title = "Which cell"
text = "Look at it."
explanation = "A step changes one cell."
[pages.question]
ask = "Which cell does a step change?"
choices = [
    { text = "That of the next state", reply = "That one is only looked up." },
    { text = "That of the state left", reply = "Yes.", right = true },
]
[[pages]]
id = "learn"
title = "Learn to study"
explanation = "An optimist tries everything."
[pages.task]
do = "Make it learn to study."
conditions = [
    { text = "study is greedy in Class", measure = "policy_in", state = "Class", equals = "study" },
    { text = "no step by you", measure = "taken", equals = 0 },
]
hints = ["Why does it never study again?", "What would an optimist do?"]
solution = "Set the initial Q to 5."
[[pages]]
id = "never"
title = "More than there is"
explanation = "The best there is earns less."
[pages.task]
do = "Earn 100 in an evening."
conditions = [{ text = "an evening earns 100", measure = "episode_return", at_least = 100 }]
[pages.task.proof]
condition = 0
best = "second"
[[pages]]
id = "lake"
title = "On the ice"
setup = "lake"
text = "Elsewhere."
'''

LESSON: Final[Lesson] = lesson_of(TEXT, Path("sample.toml"))

_PAGES: Final = {page.id: page for page in LESSON.pages}
HALF_THE_WAY: Final = _PAGES["predict"].explanation
ONE_CELL: Final = _PAGES["quiz"].explanation
SET_INITIAL_Q: Final = _PAGES["learn"].task.solution
