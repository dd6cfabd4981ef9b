"""``rl-tui why``."""

from __future__ import annotations

from functools import partial

import called
import pytest

from rl_tui.runs.answers.first_update_words import NOTHING_IN_THE_WAY

document = partial(called.document, "why")


def run(*args: str) -> tuple[int, str, str]:
    result = called.called("why", *args)
    return result.exit_code, result.stdout, result.stderr


def test_the_document() -> None:
    found = document("frozenlake", "--ties", "first")
    assert list(found) == [
        *("scenario", "algorithm", "hyperparameters", "first_update", "cause", "distance", "remedies")
    ]
    assert found["first_update"]["chance"] == pytest.approx(5.41665e-6, rel=1e-5)
    assert found["first_update"]["mean_episodes"] == pytest.approx(184_616, rel=1e-5)
    assert found["first_update"]["median_episodes"] == 127_966
    assert (found["cause"], found["distance"]) == ("ties", 6)
    assert [(each["setting"], each["value"], each["median_episodes"]) for each in found["remedies"]] == [
        ("initial_q", 1.0, 1),
        ("ties", "random", 50),
        ("epsilon", 1.0, 50),
    ]


@pytest.mark.parametrize(
    ("args", "figures"),
    [
        (("cliff",), (1.0, 1.0, 1)),
        (("frozenlake", "--initial-q", "1"), (1.0, 1.0, 1)),
        (("frozenlake", "--ties", "first", "--epsilon", "0"), (0.0, None, None)),
    ],
)
def test_waits_of_1_and_none(args: tuple[str, ...], figures: tuple[float, float | None, int | None]) -> None:
    assert tuple(document(*args)["first_update"].values()) == figures


def test_the_text_has_the_wait_the_cause_and_the_remedies() -> None:
    code, text, _ = run("frozenlake", "--ties", "first")
    assert code == 0
    for words in ("5.41665e-6", "184,616", "127,966 or fewer", "ties = first", "ties random", "71.7"):
        assert words in text
    assert NOTHING_IN_THE_WAY in run("cliff")[1]


@pytest.mark.parametrize(
    ("args", "reason"),
    [
        (("frozenlake", "--policy", "softmax"), "ε-greedy"),
        (("frozenlake", "--algorithm", "dyna-q"), "Dyna-Q"),
        (("discount",), "plans with the model"),
        (("cartpole",), "no transition table"),
        (("bandit-drifting",), "drift"),
    ],
)
def test_what_is_refused_in_one_line(args: tuple[str, ...], reason: str) -> None:
    code, text, complaint = run(*args)
    assert (code, text) == (1, "")
    assert reason in complaint
    assert complaint.count("\n") == 1
