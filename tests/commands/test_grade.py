"""``rl-tui grade``."""

from __future__ import annotations

import json
import os
import time
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from called import called
from programs.course_agents import BERKELEY, UDACITY, agent_in

from rl_tui.programs.diagnosis.diagnosis import verdict_of
from rl_tui.programs.evidence.verdict import ProgramVerdict
from rl_tui.programs.grading.grade import Grading, yardstick_of
from rl_tui.programs.grading.submissions import submissions_in
from rl_tui.programs.watched.program_log import ProgramLog
from rl_tui.runs.library import recipe_named
from rl_tui.runs.recipe import begin

SCRIPT = """
import gymnasium as gym
import numpy as np

env = gym.make("FrozenLake-v1", is_slippery={slippery})
q = np.zeros((16, 4))
rng = np.random.default_rng()
for episode in range(600):
    s, _ = env.reset()
    done = False
    while not done:
        best = np.flatnonzero(q[s] == q[s].max())
        a = int(rng.integers(4)) if rng.random() < 0.2 else int(rng.choice(best))
        s2, r, terminated, truncated, _ = env.step(a)
        q[s, a] += 0.2 * (r + 0.95 * {best_next} - q[s, a])
        s, done = s2, terminated or truncated
"""
LAKE = "gymnasium.make('FrozenLake-v1', is_slippery=False)"
RIGHT = "(not terminated) * q[s2].max()"
UNFILLED = BERKELEY[: BERKELEY.index("    def update")] + (
    "    def update(self, state, action, nextState, reward):\n"
    "        best = self.computeValueFromQValues(nextState)\n"
)
DEAD_END = """
title = "For ever"
[mdp]
start = "here"
[[mdp.transition]]
state = "here"
action = "stay"
reward = -1
to = "here"
[[mdp.transition]]
state = "here"
action = "go"
reward = -20
to = "end"
[defaults]
episodes = 30
"""
run = partial(called, "grade")


def document(*args: object) -> dict[str, Any]:
    result = run(*args, "--json")
    answer: dict[str, Any] = json.loads(result.stdout)
    assert list(answer) == ["scenario", "seeds", "threshold", "best_expected_return", "submissions"]
    assert result.exit_code == (0 if all(each["passed"] for each in answer["submissions"]) else 1)
    return answer


def script(slippery: bool = False, best_next: str = RIGHT) -> str:
    return SCRIPT.format(slippery=slippery, best_next=best_next)


@pytest.mark.process
def test_an_agent_passes(tmp_path: Path) -> None:
    path = agent_in(tmp_path, UDACITY)
    answer = document(path, "--scenario", "frozenlake", "--seeds", 2, "--episodes", 600)
    assert (answer["scenario"], answer["seeds"], answer["best_expected_return"]) == ("frozenlake", 2, 1.0)
    assert answer["submissions"] == [
        {
            "file": str(path),
            "passed": True,
            "share_of_best": {"mean": 1.0, "min": 1.0},
            "runs": [{"seed": seed, "expected_return": 1.0, "error": None} for seed in (0, 1)],
            "findings": [],
        }
    ]


@pytest.mark.process
def test_a_folder_is_graded_to_its_end_whatever_is_in_it(tmp_path: Path) -> None:
    for name, text in {
        "agent.py": UDACITY,
        "away.py": UDACITY.replace("goal = reward if", "__import__('os')._exit(0)\n        goal = reward if"),
        "broken.py": "x = (",
        "crash.py": f"import gymnasium\n{LAKE}.reset()\n1 / 0\n",
        "killed.py": "import os\nos.kill(os.getpid(), 9)\n",
        "no_table.py": f"import gymnasium\nenv = {LAKE}\nenv.reset()\nenv.step(0)\n",
        "other_world.py": script(slippery=True),
        "script.py": script(),
        "test_of_mine.py": "1 / 0",
        "_helper.py": "1 / 0",
        "parts.py": "import gymnasium\nN = 4\n",
        "unfilled.py": UNFILLED,
        "whole.py": script().replace("import numpy as np", "import numpy as np\nimport parts"),
    }.items():
        (tmp_path / name).write_text(text)
    result = run(tmp_path, "--scenario", "frozenlake", "--seeds", 1, "--episodes", 500, "--json")
    assert result.exit_code == 1
    first, second, *results = result.stderr.splitlines()
    assert "Not a sandbox: a submission can read" in first
    assert second == "left out: _helper.py, parts.py (imported by others), test_of_mine.py"
    assert results[:2] == ["agent.py: passed, 1.0000 of the best", "away.py: not passed, failed in 1 seed"]
    graded = {each["file"]: each for each in json.loads(result.stdout)["submissions"]}
    assert [name for name, each in graded.items() if each["passed"]] == ["agent.py", "script.py", "whole.py"]
    assert len(results) == len(graded)
    [missing] = graded["unfilled.py"]["findings"]
    assert "add the missing update" in missing["correction"]
    assert (missing["fault"], graded["unfilled.py"]["runs"][0]["error"]) == ("loses-update", None)
    errors = {name: each["runs"][0]["error"] or "" for name, each in graded.items()}
    for name, said in {
        "away.py": "of 500 episodes",
        "broken.py": "line 1",
        "crash.py": "crash.py, line 3: ZeroDivisionError: division by zero",
        "killed.py": "SIGKILL",
        "no_table.py": "found no table of values in it",
        "other_world.py": "is_slippery=True, whose transitions differ from those of frozenlake",
    }.items():
        assert said in errors[name], errors[name]
        assert "\n" not in errors[name]


@pytest.mark.process
def test_a_fault_is_told_once_with_how_many_seeds_show_it(tmp_path: Path) -> None:
    text = UDACITY.replace("reward if done else ", "").replace(
        "self.Q = defaultdict(lambda: np.zeros(self.nA))", "self.Q = defaultdict(lambda: np.ones(self.nA))"
    )
    path = agent_in(tmp_path, text)
    answer = document(path, "--scenario", "frozenlake", "--seeds", 2, "--episodes", 300)
    [finding] = answer["submissions"][0]["findings"]
    assert (finding["fault"], finding["kind"], finding["seeds"]) == ("bootstraps-after-end", "fault", 2)
    assert finding["file"] == str(path)
    report = run(path, "--scenario", "frozenlake", "--seeds", 2, "--episodes", 300).stdout
    assert "2 seeds, 0.95 of the best needed" in report
    assert "bug in 2 of 2 seeds, bootstraps-after-end" in report


@pytest.mark.process
def test_who_never_meets_a_reward_hears_of_the_first_of_ties(tmp_path: Path) -> None:
    text = (
        script()
        .replace("range(600)", "range(700)")
        .replace("0.2 else int(rng.choice(best))", "0.1 else best[0]")
    )
    (tmp_path / "first.py").write_text(text)
    answer = document(tmp_path / "first.py", "--scenario", "frozenlake", "--seeds", 1)
    [graded] = answer["submissions"]
    assert not graded["passed"]
    [finding] = graded["findings"]
    assert (finding["fault"], finding["kind"], finding["seeds"]) == ("first-of-ties", "risk", 1)
    assert "No reward was seen in 699 episodes" in finding["text"]
    assert "choose at random among the best actions" in finding["correction"]


@pytest.mark.exhaustive("waits for programs that never end")
@pytest.mark.process
def test_what_takes_too_long_or_too_much_is_ended(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("rl_tui.programs.grading.grade.cores", lambda: 1)
    (tmp_path / "for_ever.py").write_text("while True: pass\n")
    (tmp_path / "huge.py").write_text("x = bytearray(3 * 2**30)\n")
    answer = document(tmp_path, "--scenario", "frozenlake", "--seeds", 2, "--seconds", 3, "--memory", 1024)
    slow, huge = (each["runs"][0]["error"] for each in answer["submissions"])
    assert "stopped after 3 seconds" in slow
    assert "MemoryError" in huge
    assert "not run" in answer["submissions"][0]["runs"][1]["error"]


@pytest.mark.process
def test_a_policy_that_never_ends_has_not_passed(tmp_path: Path) -> None:
    (tmp_path / "for_ever.toml").write_text(DEAD_END)
    text = "import numpy as np\ndef update(q, s, a, r, s_next):\n    q[0, 0] = 1.0 if r < -1 else 0.5\n"
    path = agent_in(tmp_path, text)
    scenario = tmp_path / "for_ever.toml"
    answer = document(path, "--scenario", scenario, "--seeds", 1, "--episodes", 5, "--threshold", -100)
    [graded] = answer["submissions"]
    assert graded["runs"] == [{"seed": 0, "expected_return": None, "error": None}]
    assert graded["share_of_best"] == {"mean": None, "min": None}
    assert not graded["passed"]
    report = run(path, "--scenario", scenario, "--seeds", 1, "--episodes", 5).stdout
    assert "the greedy policy may never end" in report


@pytest.mark.process
def test_what_cannot_be_read_fails_alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def wrong(log: ProgramLog) -> ProgramVerdict:
        if log.table is None:
            raise IndexError("out of range")
        return verdict_of(log)

    monkeypatch.setattr("rl_tui.programs.grading.grade.verdict_of", wrong)
    (tmp_path / "first.py").write_text("print('nothing')\n")
    agent_in(tmp_path, UDACITY, "second.py")
    answer = document(tmp_path, "--scenario", "frozenlake", "--seeds", 1, "--episodes", 600)
    first, second = answer["submissions"]
    assert first["runs"][0]["error"] == "its result cannot be read (IndexError: out of range)"
    assert second["passed"]


@pytest.mark.process
def test_an_interrupt_ends_what_still_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("rl_tui.programs.grading.grade.cores", lambda: 2)
    begun = tmp_path / "begun"
    (tmp_path / "first.py").write_text("print('over')\n")
    (tmp_path / "second.py").write_text(
        f"import os, time\nopen({str(begun)!r}, 'w').write(str(os.getpid()))\nwhile True: time.sleep(9)\n"
    )
    deadline = time.monotonic() + 60.0

    def interrupted(done: int, wanted: int) -> None:
        if done:
            while not (begun.exists() and begun.read_text()) and time.monotonic() < deadline:
                time.sleep(0.02)
            raise KeyboardInterrupt

    grading = Grading(recipe_named("frozenlake"), 1, 10, 0.95)
    with pytest.raises(KeyboardInterrupt):
        grading.grade(submissions_in(str(tmp_path)).submissions, interrupted)
    with pytest.raises(ProcessLookupError):
        os.kill(int(begun.read_text()), 0)


@pytest.mark.parametrize("threshold", ["nan", "-inf", "1.01", "much"])
def test_a_threshold_is_a_number_of_at_most_1(threshold: str) -> None:
    result = run("mine.py", "--scenario", "frozenlake", "--threshold", threshold)
    assert result.exit_code == 2
    assert f"not {threshold}" in result.stderr


@pytest.mark.parametrize(
    ("args", "said"),
    [
        (("{folder}/none.py", "--scenario", "frozenlake"), "no such file"),
        (("{folder}", "--scenario", "frozenlake"), "found no submission in this folder"),
        (("{folder}", "--scenario", "frozn"), "did you mean"),
        (("{file}", "--scenario", "cartpole"), "no exact values"),
        (("{file}", "--scenario", "blackjack"), "blackjack-table has one"),
        (("{file}", "--scenario", "bandit-drifting"), "no fixed transition table"),
    ],
)
def test_what_cannot_be_graded_at_all(args: tuple[str, ...], said: str, tmp_path: Path) -> None:
    folder = tmp_path / "empty"
    folder.mkdir()
    file = agent_in(tmp_path, UDACITY)
    result = run(*(each.format(folder=folder, file=file) for each in args))
    assert result.exit_code == 1
    assert said in result.stderr.splitlines()[-1]


def test_a_threshold_that_the_optimal_policy_does_not_reach_is_told(tmp_path: Path) -> None:
    path = tmp_path / "broken.py"
    path.write_text("x = (")
    said = "has only 0.9450 of the best return in frozenlake-8x8-slippery"
    for threshold, is_said in ((0.95, True), (0.94, False)):
        result = run(
            path, "--scenario", "frozenlake-8x8-slippery", "--seeds", 1, "--threshold", threshold, "--json"
        )
        assert (said in result.stderr) == is_said
        json.loads(result.stdout)


@pytest.mark.parametrize(
    "scenario", ["frozenlake", "frozenlake-slippery", "cliff", "taxi", "student", "bandit"]
)
def test_the_share_of_the_best(scenario: str) -> None:
    recipe = recipe_named(scenario)
    mdp = begin(recipe).world.mdp
    assert mdp is not None
    measured = yardstick_of(mdp, recipe.hyperparameters.gamma)
    best = measured.best
    assert measured.share(best) == 1.0
    shares = [measured.share(value) for value in (best - 3.0, best - 1.0, best)]
    assert shares == sorted(shares, key=lambda share: share or 0.0)
    assert measured.share(None) is None
    if scenario.startswith("frozenlake"):  # only rewards: a plain ratio
        assert measured.share(0.25) == pytest.approx(0.25 / best)
    if scenario == "cliff":  # only costs
        assert measured.share(-26.0) == pytest.approx(0.0)
