"""A lesson that asks for a program."""

from __future__ import annotations

from pathlib import Path
from typing import Final

from rl_tui.lessons.lesson import Lesson, lesson_of

MARK: Final = "        # the update of Q[state][action]\n"
SKELETON: Final = f"""\
import random
import gymnasium

env = gymnasium.make("rl_tui/frozenlake-v0", max_episode_steps=20)
states, actions = env.observation_space.n, env.action_space.n
alpha, gamma, epsilon = 0.1, 0.99, 0.1
Q = [[0.5] * actions for _ in range(states)]


def choose(state):
    if random.random() < epsilon:
        return random.randrange(actions)
    best = max(Q[state])
    return random.choice([a for a in range(actions) if Q[state][a] == best])


for episode in range(400):
    state, info = env.reset()
    over = False
    while not over:
        action = choose(state)
        next_state, reward, terminated, truncated, info = env.step(action)
{MARK}        state = next_state
        over = terminated or truncated
"""
TARGET: Final = "reward + (0 if terminated else gamma * max(Q[next_state]))"
TASK: Final = """
title = "Yours"
summary = "Write it yourself."
minutes = 5
goals = ["Write the update"]
[setups.lake]
scenario = "frozenlake"
[[pages]]
id = "write"
title = "Write the update"
text = "A line is missing."
explanation = "You wrote it."
[pages.task]
do = "Write it."
conditions = [
  { text = "its update is that of Q-learning", measure = "program_rule", equals = "q-learning" },
  { text = "its γ is 0.99", measure = "program_gamma", equals = 0.99 },
  { text = "no step departs from it", measure = "program_departs", equals = 0 },
  { text = "nothing is wrong with it", measure = "program_faults", equals = 0 },
  { text = "it finishes 300 episodes", measure = "program_episodes", at_least = 300 },
]
hints = ["Two lines."]
solution = "The target first."
"""
AFTER: Final = '[[pages]]\nid = "after"\ntitle = "After"\ntext = "That is all."\n'


def updating(target: str = TARGET, cell: str = "Q[state][action]", more: str = "") -> str:
    """The program with its update: ``target``, the moved ``cell``, and ``more`` lines after it."""
    update = f"        target = {target}\n        {cell} += alpha * (target - {cell})\n{more}"
    return SKELETON.replace(MARK, update)


def program_text(accepts: str = "", rejects: tuple[str, ...] = (), skeleton: str = SKELETON) -> str:
    attempts = [f"[[pages.task.accepts]]\nname = 'right'\nprogram = '''{accepts}'''\n"] if accepts else []
    attempts += [
        f"[[pages.task.rejects]]\nname = 'wrong {n}'\nprogram = '''{code}'''\n"
        for n, code in enumerate(rejects)
    ]
    program = f"[pages.task.program]\nfile = \"my_agent.py\"\nskeleton = '''\n{skeleton}'''\n"
    return "".join((TASK, program, *attempts, AFTER))


def program_lesson() -> Lesson:
    return lesson_of(program_text(), Path("yours.toml"))
