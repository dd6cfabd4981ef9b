"""How large what a file describes, or a terminal says of itself, may be.

A file with more is refused in one line that says the limit, before memory is taken for it.
"""

from __future__ import annotations

from typing import Final

# Of the screen
LARGEST_SCREEN: Final = (400, 150)
"""Columns and lines that are drawn, of a terminal or a browser that says it is larger."""

# Of files that people name, in bytes
LARGEST_FILE: Final = 10_000_000
"""Of a scenario, a lesson, a policy or a script."""
LARGEST_SESSION: Final = 64_000_000
LARGEST_RESULTS: Final = 100_000_000
"""Of results that are plotted: JSON takes ten times as much memory."""
LARGEST_DRAWN: Final = 1e100
"""Numbers of results lie within ± this: sums and ratios of them are numbers too."""
LARGEST_SOURCE: Final = 1_000_000
"""Of a script whose text is shown, or whose syntax tree is kept."""

# Of a scenario file
MOST_VALUES: Final = 1_000_000
"""Values in a scenario file: keys, and entries of lists."""
MOST_TABLES: Final = 320_000
"""Tables in a scenario file, within lines and dotted keys too: each takes 10 µs and up to a kilobyte."""
MOST_NAMED_TABLES: Final = 1_000
"""Names of tables with a header, ``[name]``; entries of a list, ``[[name]]``, have one name together."""
MOST_KEY_PARTS: Final = 20
"""Parts of one dotted key or header. Reading it takes time and memory with the square of them."""
LONGEST_WORD: Final = 10_000
"""Characters of a number or of a key without quotes."""
MOST_KEYS: Final = 1_000
"""Keys of one table, where they are not the names of states."""
MOST_FAULTS: Final = 100
"""Faults of a file that are reported at once."""
MOST_FINDINGS: Final = 1_000
"""Faults of each kind that are looked for before the first of them are reported."""

# Of any world
LARGEST_NUMBER: Final = 1e12
"""Rewards and the like lie within ± this."""
LARGEST_STD: Final = 1e6
"""The standard deviation of any noise."""
LONGEST_NAME: Final = 60
"""Characters in the name of a state or an action."""
LONGEST_EDIT: Final = 1_000_000
"""Characters of one stroke in a world, as a session keeps it: a fill of a large map is one range."""
LONGEST_TIME_LIMIT: Final = 1_000_000
"""Steps after which an episode is cut off at the latest, where there is a time limit."""

# Of [mdp]
MOST_STATES_WRITTEN: Final = 10_000
MOST_ACTIONS_WRITTEN: Final = 1_000
MOST_TRANSITIONS: Final = 100_000
LARGEST_PLACE: Final = 999
"""Of a column or a row in the drawing."""

# Of [grid]
LONGEST_SIDE: Final = 10_000
MOST_CELLS: Final = 4_000_000
MOST_OUTCOMES: Final = 50_000_000
"""Cells × moves × ways each may turn out."""
MOST_CHARACTERS: Final = 200
"""Different characters on one map, and characters in one legend."""
STRONGEST_WIND: Final = 100

# Of [bandit]
MOST_ARMS: Final = 10_000
MOST_PULLS: Final = 1_000_000_000

# Of [gymnasium]
MOST_STATES: Final = 1_000_000
MOST_ACTIONS: Final = 10_000
MOST_PAIRS: Final = 10_000_000
MOST_PARTS: Final = 100
"""Discrete parts of an observation, or dimensions that are cut into bins."""
MOST_BINS: Final = 1_000_000
"""Bins of one dimension, of equal width."""
MOST_EDGES: Final = 10_000
"""Edges of the bins of one dimension, where they are written out."""
LARGEST_ARGUMENTS: Final = 10_000
"""Characters and values in all arguments of an environment: what it makes of them is its own affair."""

# Of a sweep
MOST_SWEEP_CELLS: Final = 10_000_000
"""Combinations of settings."""
MOST_SWEEP_RUNS: Final = 100_000
"""Runs of one cell."""
MOST_SWEEP_EPISODES: Final = 10**15
"""Episodes of one run."""
MOST_SWEEP_ROWS: Final = 20_000_000
"""Runs of a stored plan that is drawn: to compare them takes some 40 bytes each."""
