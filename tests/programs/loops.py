"""Programs of one loop, in the style of students. Lines with a fault end in ``#!``."""

from __future__ import annotations

import re
from textwrap import indent
from typing import Any, Final, NamedTuple

_TEXT: Final = """\
import copy
import random

import gymnasium as gym
import numpy as np

env = gym.make({env})
{before}
for episode in range({episodes}):
    s, _ = env.reset()
    done = False
    while not done:
{choice}
        s2, r, terminated, truncated, _ = env.step(a){mark}
        done = terminated or truncated
{update}
        s = s2
{after}"""


class Loop(NamedTuple):
    expect: Any
    """The id of the fault, or the update of a correct program."""
    env: str
    episodes: int
    before: str
    update: str
    choice: str = "a = env.action_space.sample()"
    after: str = ""
    names: str = ""
    """Other names for variables: ``s:state a:action``."""
    step_is_marked: bool = False

    @property
    def text(self) -> str:
        text = _TEXT.format(
            env=self.env,
            before=self.before,
            episodes=self.episodes,
            choice=indent(self.choice, " " * 8),
            mark="  #!" if self.step_is_marked else "",
            update=indent(self.update, " " * 8),
            after=indent(self.after, " " * 4),
        )
        names = dict(each.split(":") for each in self.names.split())
        return re.sub(r"\b\w+\b", lambda word: names.get(word[0], word[0]), text)


LAKE: Final = "'FrozenLake-v1', is_slippery=False"
SLIPPERY: Final = "'FrozenLake-v1', is_slippery=True"
SHORT_CLIFF: Final = "'CliffWalking-v1', max_episode_steps={}"
CLIFF: Final = "'CliffWalking-v1'"
TAXI: Final = "'Taxi-v3'"
ARRAY: Final = "Q = np.zeros((env.observation_space.n, env.action_space.n))"
LISTS: Final = "Q = [[{}] * env.action_space.n for _ in range(env.observation_space.n)]"
SOMETIMES: Final = "a = np.random.randint(4) if np.random.rand() < {} else int(np.argmax(Q[s]))"
FAIR: Final = """\
if np.random.rand() < {}:
    a = np.random.choice(4)
else:
    a = np.random.choice(np.flatnonzero(Q[s] == Q[s].max()))"""
FIRST: Final = """
def choose(s):
    if np.random.uniform() < 0.05:
        return env.action_space.sample()
    return np.argmax(Q[s])  #!
"""
RIGHT: Final = "Q[s, a] += {} * (r + {} * np.max(Q[s2]) * (not terminated) - Q[s, a])"
IN_ROWS: Final = "Q[s][a] += {} * (r + {} * max(Q[s2]) * (1 - terminated) - Q[s][a])"
LONG: Final = "s:state a:action r:reward s2:next_state"

COPIES: Final = """
def update(q, s, a, r, s2, terminated, alpha=0.1, gamma=0.9):
    q = copy.deepcopy(q)
    target = r + (0 if terminated else gamma * max(q[s2]))
    q[s][a] += alpha * (target - q[s][a])
    return q
"""
TWICE: Final = """
gamma = 0.99
def discounted_value(Q, s):
    return gamma * np.max(Q[s])
"""

FAULTY: Final[dict[str, Loop]] = {
    "always_the_first": Loop(
        "first-of-ties", LAKE, 700, ARRAY + FIRST, RIGHT.format(0.1, 0.99), "a = choose(s)", names=LONG
    ),
    "bootstraps_random_table": Loop(
        "bootstraps-after-end",
        *(SLIPPERY, 400, "Q = np.random.rand(env.observation_space.n, env.action_space.n)"),
        *("Q[s, a] += 0.1 * (r + 0.99 * np.max(Q[s2]) - Q[s, a])  #!", SOMETIMES.format(0.2)),
        names=LONG,
    ),
    "breaks_before_update": Loop(
        "loses-update",
        *(SHORT_CLIFF.format(500), 100, ARRAY),
        *("if done:\n    break\n" + RIGHT.format(0.5, 0.9), SOMETIMES.format(0.1)),
        step_is_marked=True,
    ),
    "column_maximum": Loop(
        "wrong-axis",
        *(LAKE, 900, ARRAY),
        "best = 0.0 if terminated else np.max(Q[:, a])\nQ[s, a] += 0.1 * (r + 0.9 * best - Q[s, a])  #!",
        FAIR.format(0.3),
        names=LONG,
    ),
    "compares": Loop(
        "loses-update",
        *(LAKE, 1500, ARRAY, RIGHT.format(0.1, 0.95).replace("+=", "== Q[s, a] +")),
        names=LONG,
        step_is_marked=True,
    ),
    "cut_off_cliff": Loop(
        "no-bootstrap-after-truncation",
        *(SHORT_CLIFF.format(40), 300, ARRAY),
        "target = r if done else r + 0.95 * Q[s2].max()\nQ[s, a] = Q[s, a] + 0.2 * (target - Q[s, a])  #!",
        SOMETIMES.format(0.1),
    ),
    "discounted_twice": Loop(
        "gamma-twice",
        *(SHORT_CLIFF.format(300), 80, ARRAY + TWICE),
        "if not terminated:\n    r += gamma * discounted_value(Q, s2)\nQ[s, a] += 0.1 * (r - Q[s, a])  #!",
        SOMETIMES.format(0.1),
        names=LONG,
    ),
    "first_column_only": Loop(
        "wrong-cell", TAXI, 40, LISTS.format(0.0), IN_ROWS.format(0.1, 0.95).replace("[a]", "[0]") + "  #!"
    ),
    "if_not_done": Loop(
        "loses-update",
        *(LAKE, 600, ARRAY, f"if not done:\n    {RIGHT.format(0.1, 0.9)}"),
        names="s2:s_next done:over terminated:term truncated:trunc",
        step_is_marked=True,
    ),
    "integers": Loop(
        "rounding-table",
        *(SHORT_CLIFF.format(200), 50, f"alpha, gamma = 0.1, 0.9\n{ARRAY[:-1]}, dtype=int)  #!"),
        *(RIGHT.format("alpha", "gamma"), SOMETIMES.format(0.1)),
        names=LONG,
    ),
    "large_step": Loop(
        "step-size-out-of-range",
        *(SHORT_CLIFF.format(100), 60, ARRAY),
        "target = r if terminated else r + 0.9 * np.max(Q[s2])\nQ[s, a] += 1.1 * (target - Q[s, a])  #!",
    ),
    "moves_first": Loop(
        "updates-after-moving",
        *(SHORT_CLIFF.format(200), 80, ARRAY),
        "s = s2\nQ[s, a] = Q[s, a] + 0.1 * (r + 0.99 * np.max(Q[s2]) - Q[s, a])  #!",
        SOMETIMES.format(0.1),
        names=LONG,
    ),
    "no_exploration": Loop(
        "never-explores",
        LAKE,
        700,
        LISTS.format(0.0),
        IN_ROWS.format(0.1, 0.99),
        "a = Q[s].index(max(Q[s]))  #!",
    ),
    "same_list": Loop(
        "shared-table",
        LAKE,
        400,
        "Q = [[0.0] * 4] * 16  #!",
        IN_ROWS.format(0.1, 0.9),
        "a = random.randrange(4)",
    ),
    "same_row": Loop(
        "shared-table",
        *(SHORT_CLIFF.format(200), 60, "Q = dict.fromkeys(range(48), np.zeros(4))  #!"),
        *(IN_ROWS.format(0.5, 0.9), SOMETIMES.format(0.1)),
    ),
    "transposed": Loop(
        "wrong-cell",
        *("'FrozenLake-v1', desc=['SF', 'FG']", 300, ARRAY),
        *(RIGHT.format(0.1, 0.9).replace("[s, a]", "[a, s]") + "  #!", "a = np.random.randint(4)"),
        names=LONG,
    ),
    "updates_a_copy": Loop(
        "loses-update",
        *(SHORT_CLIFF.format(50), 40, ARRAY + COPIES, "update(Q, s, a, r, s2, terminated)"),
        names="Q:q_table",
        step_is_marked=True,
    ),
    "wrong_sign": Loop(
        "step-size-out-of-range",
        LAKE,
        2000,
        ARRAY,
        RIGHT.format(0.05, 0.9).replace("+=", "-=") + "  #!",
        names=f"{LONG} Q:q_table",
    ),
}

UNKNOWN: Final = {"rule": "unknown", "alpha": None, "gamma": None}


def _q(alpha: float | None, gamma: float, table: str = "Q", schedule: str = "constant") -> dict[str, Any]:
    return {"rule": "q-learning", "alpha": alpha, "gamma": gamma, "alpha_schedule": schedule, "table": table}


CORRECT: Final[dict[str, Loop]] = {
    "alpha_by_episode": Loop(
        _q(None, 0.97, schedule="by-episode"),
        *(CLIFF, 80, "Q = np.random.uniform(-0.01, 0.01, (48, 4))\nQ[47] = 0\nlr = 0.8"),
        "best = 0 if terminated else np.max(Q[s2])\nQ[s, a] = Q[s, a] * (1 - lr) + lr * (r + 0.97 * best)",
        *(SOMETIMES.format(0.1), "lr = max(0.05, lr * 0.97)"),
        names=LONG,
    ),
    "clipped_values": Loop(
        UNKNOWN,
        *(SHORT_CLIFF.format(200), 100, ARRAY),
        "Q[s, a] = np.clip(Q[s, a] + 0.5 * (r + 0.99 * (not terminated) * Q[s2].max() - Q[s, a]), -5, 5)",
        SOMETIMES.format(0.1),
    ),
    "dyna_q": Loop(
        UNKNOWN,
        *(CLIFF, 12, f"{ARRAY}\nmodel = {{}}"),
        "model[s, a] = r, s2, terminated\n"
        + RIGHT.format(0.5, 0.95)
        + """
for _ in range(5):
    (ms, ma), (mr, ms2, end) = random.choice(list(model.items()))
    Q[ms, ma] += 0.5 * (mr + 0.95 * (0 if end else Q[ms2].max()) - Q[ms, ma])""",
        SOMETIMES.format(0.1),
    ),
    "frozen_training": Loop(
        {"rule": "unknown", "table": "Q"},
        *(LAKE, 600, f"{ARRAY}\ntraining = False"),
        f"if training and not terminated:\n    {RIGHT.format(0.1, 0.9)}",
    ),
    "optimistic_lists": Loop(
        _q(0.1, 0.9),
        *(LAKE, 600, LISTS.format(1.0)),
        "if terminated:\n    Q[s][a] += 0.1 * (r - Q[s][a])\n"
        "else:\n    Q[s][a] += 0.1 * (r + 0.9 * max(Q[s2]) - Q[s][a])",
        "if random.random() < 0.1:\n    a = random.randint(0, 3)\n"
        "else:\n    a = random.choice([i for i, q in enumerate(Q[s]) if q == max(Q[s])])",
    ),
    "own_step_penalty": Loop(
        {"rule": "q-learning", "alpha": 0.2, "gamma": 0.9, "reward": "own", "table": "Q"},
        *(SLIPPERY, 1000, ARRAY),
        f"r = 10.0 if r > 0 else -5.0 if terminated else -0.1\n{RIGHT.format(0.2, 0.9)}",
        SOMETIMES.format(0.3),
    ),
    "random_agent": Loop({**UNKNOWN, "table": None}, "'FrozenLake-v1'", 300, "wins = 0", "wins += r"),
    "rebound_table": Loop(
        _q(0.1, 0.9, "q_table"),
        *(CLIFF, 50, ARRAY + COPIES, "Q = update(Q, s, a, r, s2, terminated)", SOMETIMES.format(0.2)),
        names="Q:q_table",
    ),
    "replay_buffer": Loop(
        {**UNKNOWN, "table": "table"},
        *(LAKE, 300, f"{ARRAY}\nbuffer = []"),
        """\
buffer.append((s, a, r, s2, terminated))
for x, b, pay, y, end in random.sample(buffer, min(8, len(buffer))):
    Q[x, b] += 0.1 * (pay + 0.99 * (1 - end) * Q[y].max() - Q[x, b])""",
        SOMETIMES.format(0.9),
        names="Q:table s:obs s2:nxt",
    ),
    "rows_as_needed": Loop(
        _q(0.25, 0.9),
        *(
            TAXI,
            40,
            """\
Q = {}
def row(s):
    if s not in Q:
        Q[s] = [random.uniform(0, 0.001) for _ in range(6)]
    return Q[s]
""",
        ),
        "best = 0 if terminated else max(row(s2))\nrow(s)[a] += 0.25 * (r + 0.9 * best - row(s)[a])",
        "a = random.randrange(6) if random.random() < 0.1 else row(s).index(max(row(s)))",
    ),
    "sample_average": Loop(
        _q(None, 0.9, schedule="1/N"),
        *(SLIPPERY, 1500, f"{ARRAY}\nN = np.zeros((16, 4))"),
        "N[s, a] += 1\n" + RIGHT.format("1 / N[s, a]", 0.9),
        FAIR.format(0.3),
    ),
    "short_time_limit": Loop(
        _q(0.3, 0.9),
        *(SHORT_CLIFF.format(30), 100, "Q = np.full((48, 4), -1.0)"),
        *(RIGHT.format(0.3, 0.9), SOMETIMES.format(0.2)),
    ),
    "single_precision": Loop(
        _q(0.3, 0.96, "q_table"),
        *(CLIFF, 80, "Q = np.zeros((48, 4), dtype=np.float32)"),
        *(RIGHT.format(0.3, 0.96), SOMETIMES.format(0.1)),
        names="Q:q_table",
    ),
    "state_values": Loop(
        {**UNKNOWN, "table": None},
        *("'FrozenLake-v1'", 300, "V = np.zeros(env.observation_space.n)"),
        "V[s] += 0.1 * (r + 0.99 * V[s2] * (not terminated) - V[s])",
    ),
    "ucb_choice": Loop(
        _q(0.2, 0.95),
        *(SHORT_CLIFF.format(200), 40, f"{ARRAY}\ncounts = np.ones((48, 4))"),
        "counts[s, a] += 1\nQ[s, a] += 0.2 * (r + 0.95 * Q[s2].max() - Q[s, a])",
        "bonus = 2 * np.sqrt(np.log(counts[s].sum() + 1) / counts[s])\na = int(np.argmax(Q[s] + bonus))",
    ),
    "zero_at_the_goal": Loop(
        {"rule": "q-learning", "alpha": 0.1, "gamma": 0.95},
        *(SHORT_CLIFF.format(400), 150, "Q = np.random.uniform(-2, 0, (48, 4))"),
        "Q[s, a] = 0 if terminated else 0.9 * Q[s, a] + 0.1 * (r + 0.95 * np.max(Q[s2]))",
        SOMETIMES.format(0.3),
        names=LONG,
    ),
}
