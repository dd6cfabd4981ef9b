"""Size limits. A larger input is refused, naming the limit, before memory is allocated."""

from __future__ import annotations

from typing import Final

# Of the screen
LARGEST_SCREEN: Final = (400, 150)
"""Largest screen in columns and lines."""

# Of files that people name, in bytes
LARGEST_FILE: Final = 10_000_000
"""Size of a scenario, lesson, policy or script in bytes."""
LARGEST_SESSION: Final = 64_000_000
LARGEST_RESULTS: Final = 100_000_000
"""Size of a results file in bytes. JSON takes ten times as much memory."""
LARGEST_DRAWN: Final = 1e100
"""Bound of numbers in results, ±. Their sums and ratios stay finite."""
LARGEST_NOTEBOOK: Final = 64_000_000
"""Size of a notebook in bytes, with its pictures."""
LARGEST_SOURCE: Final = 1_000_000
"""Size in bytes of a script that is shown or parsed."""

# Of a scenario file
MOST_VALUES: Final = 1_000_000
"""Values of a scenario file: keys and list entries."""
MOST_TABLES: Final = 320_000
"""Tables of a scenario file, including inline ones and dotted keys. Each takes 10 µs and up to 1 kB."""
MOST_NAMED_TABLES: Final = 1_000
"""Table headers ``[name]``. All entries ``[[name]]`` of a list count as one."""
MOST_KEY_PARTS: Final = 20
"""Parts of a dotted key or header. Reading takes time and memory with their square."""
LONGEST_WORD: Final = 10_000
"""Characters of a number, or of a key without quotes."""
MOST_KEYS: Final = 1_000
"""Keys of one table, except tables of states."""
MOST_FAULTS: Final = 100
"""Errors of a file that are reported together."""
MOST_FINDINGS: Final = 1_000
"""Errors of each kind that are collected before reporting."""

# Of any world
LARGEST_NUMBER: Final = 1e12
"""Bound of rewards and similar numbers, ±."""
LARGEST_STD: Final = 1e6
"""Standard deviation of noise."""
LONGEST_NAME: Final = 60
"""Characters in the name of a state or action."""
LONGEST_EDIT: Final = 1_000_000
"""Characters of one edit in a session. Filling a large map takes one range."""
LONGEST_TIME_LIMIT: Final = 1_000_000
"""Time limit of an episode, in steps."""

# Of [mdp]
MOST_STATES_WRITTEN: Final = 10_000
MOST_ACTIONS_WRITTEN: Final = 1_000
MOST_TRANSITIONS: Final = 100_000
LARGEST_PLACE: Final = 999
"""Column or row in the drawing of a graph."""

# Of [grid]
LONGEST_SIDE: Final = 10_000
MOST_CELLS: Final = 4_000_000
MOST_OUTCOMES: Final = 50_000_000
"""Cells × moves × outcomes of each move."""
MOST_CHARACTERS: Final = 200
"""Different characters on a map, and characters in a legend."""
STRONGEST_WIND: Final = 100

# Of [bandit]
MOST_ARMS: Final = 10_000
MOST_PULLS: Final = 1_000_000_000

# Of [gymnasium]
MOST_STATES: Final = 1_000_000
MOST_ACTIONS: Final = 10_000
MOST_PAIRS: Final = 10_000_000
MOST_PARTS: Final = 100
"""Discrete parts of an observation, or dimensions cut into bins."""
MOST_BINS: Final = 1_000_000
"""Bins of equal width in one dimension."""
MOST_EDGES: Final = 10_000
"""Bin edges written out for one dimension."""
LARGEST_ARGUMENTS: Final = 10_000
"""Characters and values in all arguments of an environment."""

# Of a sweep
MOST_SWEEP_CELLS: Final = 10_000_000
"""Combinations of settings."""
MOST_SWEEP_RUNS: Final = 100_000
"""Runs per cell."""
MOST_SWEEP_EPISODES: Final = 10**15
"""Episodes per run."""
MOST_SWEEP_ROWS: Final = 20_000_000
"""Runs of a stored plan that is drawn. Comparing takes about 40 bytes each."""
