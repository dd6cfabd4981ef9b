"""``solve --flips``."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import called
import pytest

from rl_tui.worlds.files.shipped import shipped_folder

pytestmark = pytest.mark.unit
printed, document = partial(called.printed, "solve"), partial(called.document, "solve")


def test_the_document_is_that_of_solve_and_the_flips() -> None:
    answer = document("frozenlake-slippery", "--flips")
    found = answer.pop("flips")
    assert answer == document("frozenlake-slippery")
    assert [round(flip["gamma"], 12) for flip in found] == [0.808783309216, 0.978316459143]
    assert list(found[0]) == ["gamma", "turns_the_way", "expected_return", "changes"]
    assert found[0]["changes"] == [
        {"state": "0", "from": ["down", "right"], "to": ["left"]},
        {"state": "2", "from": ["right"], "to": ["left"]},
    ]
    assert found[1]["changes"] == [{"state": "2", "from": ["left"], "to": ["up"]}]
    assert found[0]["expected_return"][1] == found[1]["expected_return"][0]


def test_flips_do_not_depend_on_the_gamma_that_is_solved_for() -> None:
    assert (
        document("student", "--flips", "--gamma", "0.1")["flips"] == document("student", "--flips")["flips"]
    )


def test_above_100_live_states_there_is_a_reason_in_place_of_flips() -> None:
    answer = document("blackjack-table", "--flips")
    assert answer["flips"] is None
    assert answer["flips_refused"].endswith("here there are 290")
    assert answer["flips_refused"] in printed("blackjack-table", "--flips").splitlines()


def test_text_has_actions_in_the_order_of_the_screen_and_both_returns() -> None:
    assert "flip" not in printed("frozenlake-slippery")
    lines = printed("frozenlake-slippery", "--flips").splitlines()
    at = next(place for place, line in enumerate(lines) if line.startswith("0.80878"))
    assert lines[at].split() == ["0.808783309216", "*", "0", "right,", "down", "left", "0.44660", "0.72977"]
    assert lines[at + 1].split() == ["2", "right", "left"]
    assert lines[at + 2].split()[:3] == ["0.978316459143", "*", "2"]
    assert "within 100 steps" in lines[-1]
    assert "within" not in printed("discount", "--flips").splitlines()[-1]


def test_only_what_turns_the_way_is_marked() -> None:
    rows = printed("discount", "--flips").splitlines()[-16:-2]
    assert [line.split()[0] for line in rows if "*" in line] == ["0.518845036131"]


@pytest.mark.parametrize("scenario", ["frozenlake", "bandit"])
def test_where_nothing_flips_it_says_so(scenario: str) -> None:
    assert document(scenario, "--flips")["flips"] == []
    last = printed(scenario, "--flips").splitlines()[-1]
    assert last == "no flip points: the same actions are optimal at every γ in (0, 1)"


def test_a_world_drawn_from_the_seed_is_that_of_the_seed(tmp_path: Path) -> None:
    text = (shipped_folder() / "frozenlake-random.toml").read_text(encoding="utf-8")
    file = tmp_path / "lake.toml"
    small = text.replace("rows = 8, columns = 8", "rows = 4, columns = 5")
    file.write_text(f"{small}slippery = true\n", encoding="utf-8")
    first, again, other = (document(str(file), "--flips", "--seed", seed)["flips"] for seed in "112")
    assert first == again != other


def test_a_world_without_a_table_is_refused() -> None:
    result = called.called("solve", "cartpole", "--flips")
    assert result.exit_code != 0
    assert "has no exact values" in result.stderr
