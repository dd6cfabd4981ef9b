"""The parts of the text of a world, of every kind."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Final

ARRAY: Final = """
def new_table(value):
    return np.full(($states, $actions), value)
"""
RAGGED: Final = """
def new_table(value):
    # Not every action can be taken in every state, so each state has a row of its own length
    return [np.full($actions_of_state, value) for $state in $states]
"""
LOOKUP: Final = """
def new_table(value):
    # A state gets its row when it is first met
    return defaultdict(lambda: np.full($actions, value))
"""

FIELDS: Final = "probability, next_state, reward, terminated"
NOISY_FIELDS: Final = f"{FIELDS}, noise"

ENVIRONMENT: Final = """
class World(gym.Env):
    # Gymnasium's way to put it: reset() begins an episode, step() takes an action
    observation_space = gym.spaces.Discrete($states)
    action_space = gym.spaces.Discrete($actions)

    def reset(self, seed=None, options=None):
        super().reset(seed=seed)
        self.state = $start
        return self.state, {}

    def step(self, action):
        draw = self.np_random.random()
        for $fields in outcomes(self.state, action):
            draw -= probability
            if draw < 0:
                break
        $noise
        self.state = next_state
        return next_state, reward, terminated, False, {}


env = $environment
"""
NOISE: Final = "reward += noise * self.np_random.standard_normal()"

ARROWS_ON_MAP: Final = """
# An arrow for each move that looks best, a question mark where nothing is known
drawn = []
for row, line in enumerate(MAP):
    cells = []
    for column, letter in enumerate(line):
        values = Q[row * len(line) + column]
        if letter in $shown:
            cells.append(letter)
        elif values.max() == values.min():
            cells.append("?")
        else:
            best = np.flatnonzero($equals)
            cells.append($between.join(ARROWS[a] for a in best))
    drawn.append(cells)
width = max(len(cell) for cells in drawn for cell in cells)
for cells in drawn:
    print(" ".join(f"{cell:>{width}}" for cell in cells))
"""

STATE_BY_STATE: Final = """
known = [state for state in $states if Q[state].max() > Q[state].min()]
for state in known[:40]:
    print(f"{state}: {NAMES[np.argmax(Q[state])]}")
if len(known) > 40:
    print(f"... and {len(known) - 40} more")
"""


@dataclass(frozen=True, slots=True)
class WorldText:
    """A world in the words of a script.

    ``setup`` makes ``env``. ``outcomes(state, action)``, for those who plan, gives ``fields``; it is there
    already or comes with ``model``. ``starts`` is the expression of the states to start in, empty where
    there is no model. ``new_table`` makes a table of estimates. ``report`` prints the policy, once
    ``report_pieces`` and ``$equals``, which values are equally good, are filled in.
    ``truncates`` says whether episodes are cut off. ``imports`` are lines, ``remarks`` sentences for the head
    of the script.
    """

    setup: str
    new_table: str
    report: str
    model: str = ""
    starts: str = ""
    fields: str = FIELDS
    report_pieces: Mapping[str, str] = field(default_factory=dict)
    truncates: bool = False
    imports: tuple[str, ...] = ()
    remarks: tuple[str, ...] = ()


def limited(time_limit: int) -> str:
    """Return the expression that makes the environment, with its time limit if there is one."""
    if not time_limit:
        return "World()"
    return f"gym.wrappers.TimeLimit(World(), max_episode_steps={time_limit})"


def between(arrows: Iterable[str]) -> str:
    """Return, as a literal, what stands between moves that are equally good: some are two characters."""
    return '""' if all(len(each) == 1 for each in arrows) else '"/"'


def arrow(step: tuple[int, int] | None, name: str) -> str:
    """Return a move as characters that every terminal has; another action by its first letter."""
    if step is None:
        return name[:1]
    down, right = step
    return {-1: "^", 0: "", 1: "v"}[down] + {-1: "<", 0: "", 1: ">"}[right] or "o"
