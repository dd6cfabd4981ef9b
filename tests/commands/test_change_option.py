"""``train --change``."""

from __future__ import annotations

import json
from functools import partial

import pytest
from called import assert_refused, called

train = partial(called, "train", "student")


def test_the_report_tells_what_was_changed() -> None:
    result = train("--steps", "200", "--change", "150:gamma=0.5", "--change", "40:epsilon=0")
    assert result.exit_code == 0
    lines = result.stdout.splitlines()
    assert [line.split() for line in lines[2:5]] == [
        ["step", "changed", "to"],
        ["after", "40", "epsilon", "0"],
        ["after", "150", "gamma", "0.5"],
    ]


def test_many_changes_are_cut_off_in_the_report() -> None:
    changes = [word for step in range(25) for word in ("--change", f"{step}:epsilon=0.{step + 1:02}")]
    assert "... and 5 more: --json has all" in train("--steps", "30", *changes).stdout


def test_json_has_the_journal_only_where_there_are_changes() -> None:
    assert "journal" not in json.loads(train("--steps", "50", "--json").stdout)
    document = json.loads(train("--steps", "50", "--json", "--change", "10:take=study").stdout)
    assert document["journal"] == [{"step": 10, "name": "take", "value": "study"}]


def test_a_change_after_the_end_is_told_to_have_no_effect() -> None:
    result = train("--steps", "50", "--change", "51:gamma=0.5")
    assert result.exit_code == 0
    assert result.stderr == "--change 51:gamma=0.5 has no effect: the run ends after 50 steps\n"


def test_settings_of_the_last_step_count_and_a_step_beyond_does_not() -> None:
    result = train("--steps", "50", "--json", "--change", "50:gamma=0.5", "--change", "50:take=study")
    assert json.loads(result.stdout)["steps"] == 50
    assert result.stderr == "--change 50:take=study has no effect: the run ends after 50 steps\n"


@pytest.mark.parametrize(
    ("args", "fault", "status"),
    [
        (["--change", "5:epsilon=2"], 'epsilon is "2"; expected a number in [0, 1]', 2),
        (["--change", "nonsense"], "is not STEP:NAME=VALUE", 2),
        (["--change", "5:take=study", "--runs", "2"], "take=ACTION works for a single run only", 2),
        (["--change", "5:take=sleeep"], '(did you mean "sleep"?)', 1),
        (["--change", "0:take=sleep"], "sleep is not available in state Class", 1),
        (["--change", "5:policy=gradient"], "policy gradient is for bandits", 1),
    ],
)
def test_faults_are_one_line(args: list[str], fault: str, status: int) -> None:
    assert_refused(train("--steps", "50", *args), status, fault)
