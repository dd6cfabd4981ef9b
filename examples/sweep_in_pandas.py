"""Read the store of a sweep into pandas, and compare settings.

pip install rl-tui pandas
rl-tui sweep cliff --vary alpha=0.1,0.5 --vary algorithm=q-learning,sarsa --runs 10 --store cliff.sqlite
python sweep_in_pandas.py cliff.sqlite
"""

import json
import sqlite3
import sys
from contextlib import closing

import pandas as pd

RUNS = "SELECT cells.scenario, cells.settings, rows.* FROM rows JOIN cells USING (key) WHERE failed IS NULL"


def runs_of(store: str) -> pd.DataFrame:
    """Return a row for each run: its settings, its seed, and its metrics.

    The best settings have more runs than the others: the sweep tests them again with new seeds.
    """
    with closing(sqlite3.connect(store)) as connection:
        rows = pd.read_sql(RUNS, connection)
    settings = pd.DataFrame([json.loads(text) for text in rows.pop("settings")])
    return settings.join(rows)


def main(store: str) -> None:
    """Print the mean and the standard error of each combination of settings."""
    runs = runs_of(store)
    settings = list(runs.columns[: runs.columns.get_loc("scenario")])
    print(runs.groupby(settings)["area"].agg(["mean", "sem", "count"]).sort_values("mean", ascending=False))


if __name__ == "__main__":
    main(*sys.argv[1:])
