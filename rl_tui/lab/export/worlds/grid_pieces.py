"""The pieces of a script's map: each rule that a grid may have."""

from __future__ import annotations

from typing import Final

ABOUT_TURNS: Final = "# A move may turn out as the one before or after it in MOVES, a turn to the side"
SHAKEN: Final = "[0, 1, -1]"
GUST: Final = " + (gust if WIND[column] else 0)"
SIDE_GUST: Final = " + (side_gust if WIND_ROWS[row] else 0)"

SETUP: Final = """
$map
ROWS, COLUMNS = len(MAP), len(MAP[0])  # a state is a cell, numbered row by row
$cells
$rules
$moves
NAMES, ARROWS = list(MOVES), $arrows
STARTS = [state for state, letter in enumerate("".join(MAP)) if letter in $starts]


def at(state):
    return MAP[state // COLUMNS][state % COLUMNS]


def is_open(row, column):
    return 0 <= row < ROWS and 0 <= column < COLUMNS$no_wall


$land


$arrive


$outcomes
"""

LAND: Final = """
def land(state, move$gusts):
    # Where a move leads, unless a wall or the edge stops it
    row, column = divmod(state, COLUMNS)
    down, right = MOVES[move]
    $only
    $wind
    $wind_rows
    $bumped
    if is_open(row + down, column + right):
        row, column = row + down, column + right
    $blow
    $blow_rows
    return row * COLUMNS + column$and_bumped
"""
ONLY: Final = """if move not in ONLY.get(at(state), MOVES):
    down, right = 0, 0"""
WIND: Final = """
# The wind pushes up; a step against it only takes from it
push = -WIND[column]$gust
if down * push < 0:
    down, push = 0, push + down
"""
WIND_ROWS: Final = """
# The wind of the row pushes to the right
shove = WIND_ROWS[row]$gust
if right * shove < 0:
    right, shove = 0, shove + right
"""
BUMPED: Final = "bumped = not is_open(row + down, column + right)"
BLOW: Final = """for _ in range(abs(push)):
    if is_open(row + np.sign(push), column):
        row += np.sign(push)"""
BLOW_ROWS: Final = """for _ in range(abs(shove)):
    if is_open(row, column + np.sign(shove)):
        column += np.sign(shove)"""

ARRIVE: Final = """
def arrive(probability, state, entered$bumped):
    reward = $reward
    $bump
    $back
    return probability, $next_state, reward, $ends
"""
BUMP: Final = "reward += BUMP_REWARD if bumped else 0.0"
BACK: Final = "next_state = STARTS[0] if at(entered) in BACK else entered"

OUTCOMES: Final = """
def outcomes(state, action):
    # All that may happen: (probability, next state, reward, whether the episode ends)
    $exit
    $jump
    $possible
"""
EXIT: Final = """
if at(state) in EXITS:
    return [(1.0, state, $reward, True)]
"""
JUMP: Final = """
if at(state) in JUMPS:
    return [arrive(1.0, state, "".join(MAP).index(JUMPS[at(state)])$no_bump)]
"""
GUSTS: Final = """
# Wind is as strong as told, or one more, or one less, equally likely
up = $up
side = $side
share = 1 / (len(up) * len(side))
return [
    arrive($p, state, $land)
    $turns
    for gust in up for side_gust in side
]
"""
