"""``rl-tui watch``."""

from __future__ import annotations

import json
import os
from functools import partial
from pathlib import Path
from textwrap import dedent

import called
import pytest

from rl_tui.commands.by_name import watch
from rl_tui.programs.watched.program_log import ProgramLog

pytestmark = pytest.mark.process

Q_LEARNING = """\
import gymnasium as gym
import numpy as np
env = gym.make("FrozenLake-v1", is_slippery=False)
Q = np.zeros((16, 4))
N = np.zeros((16, 4))
rng = np.random.default_rng()
for episode in range(600):
    state, info = env.reset()
    done = False
    while not done:
        best = np.flatnonzero(Q[state] == Q[state].max())
        action = int(rng.choice(best)) if rng.random() > 0.3 else env.action_space.sample()
        next_state, reward, terminated, truncated, info = env.step(action)
        target = reward + 0.9 * Q[next_state].max() * (not terminated)
        N[state, action] += 1
        Q[state, action] += 0.5 * (target - Q[state, action])
        state, done = next_state, terminated or truncated
"""


document = partial(called.document, "watch")


def run(*args: str) -> tuple[int, str, str]:
    result = called.called("watch", *args)
    return result.exit_code, result.stdout, result.stderr


def script_in(folder: Path, text: str) -> str:
    path = folder / "script.py"
    path.write_text(dedent(text))
    return str(path)


def test_the_document(tmp_path: Path) -> None:
    path = script_in(tmp_path, Q_LEARNING)
    code, text, complaint = run(path, "--json", "--seed", "3")
    assert (code, complaint) == (0, "")
    found = json.loads(text)
    assert list(found) == [
        *("script", "environment", "table", "steps", "episodes"),
        *("expected_return", "best_expected_return", "value_at_start"),
        *("update", "exploration", "findings", "notes", "error"),
    ]
    assert found["script"] == path
    assert found["environment"] == {"id": "FrozenLake-v1", "states": 16, "actions": 4}
    assert found["table"] == {
        "name": "Q",
        "kind": "array",
        "shape": [16, 4],
        "dtype": "float64",
        "others": found["table"]["others"],
    }
    assert found["episodes"] == 600
    assert found["steps"] > 600
    assert (found["expected_return"], found["best_expected_return"]) == (1.0, 1.0)
    assert list(found["update"]) == [
        *("rule", "alpha", "alpha_schedule", "gamma", "epsilon", "reward", "fits", "informative"),
        "departs_at",
    ]
    assert found["error"] is None
    assert json.loads(run(path, "--json", "--seed", "4")[1])["steps"] != found["steps"]


def test_findings_are_no_failure_and_have_their_line(tmp_path: Path) -> None:
    path = script_in(tmp_path, Q_LEARNING.replace("Q[state, action] +=", "Q[next_state, action] +="))
    found = document(path)
    finding = next(each for each in found["findings"] if each["fault"] == "updates-after-moving")
    assert {"kind", "certainty", "step", "steps_for", "steps_against", "file", "line", "text"} <= set(finding)
    assert (finding["kind"], finding["certainty"]) == ("fault", "proven")
    assert (finding["file"], finding["line"]) == (path, 16)


def test_the_example_is_the_script_of_the_docs_with_its_bug() -> None:
    code, text, complaint = run("--example", "--json", "--steps", "1500")
    found = json.loads(text)
    assert (code, complaint) == (0, "")
    assert Path(found["script"]) == Path(__file__).parents[2] / "docs" / "lake.py"
    assert ([each["fault"] for each in found["findings"]], found["steps"]) == (["updates-after-moving"], 1500)


@pytest.mark.parametrize("args", [(), ("--example", "mine.py")])
def test_there_is_one_script(args: tuple[str, ...]) -> None:
    code, text, complaint = run(*args)
    assert (code, text, complaint.count("\n")) == (2, "", 1)
    assert "--example" in complaint


def test_where_nothing_is_known_there_is_null(tmp_path: Path) -> None:
    found = document(script_in(tmp_path, "print('nothing to watch')\n"))
    assert (found["environment"], found["table"], found["steps"], found["episodes"]) == (None, None, 0, 0)
    assert [found[name] for name in ("expected_return", "best_expected_return", "value_at_start")] == [
        None
    ] * 3
    assert (found["update"]["rule"], found["update"]["fits"], found["update"]["gamma"]) == (
        "unknown",
        None,
        None,
    )


def test_a_script_without_an_environment_is_told_of_once_before_it_ends(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(watch, "WORTH_TELLING", 0.0)
    say = watch.step_missed("script.py")
    log = ProgramLog(notes=["CartPole-v1 is not watched"])
    say(log)
    say(log)
    line = "rl-tui: script.py has not taken a step yet: CartPole-v1 is not watched\n"
    assert capsys.readouterr().err == line


def test_without_a_table_only_the_best_is_known(tmp_path: Path) -> None:
    text = """\
    import gymnasium
    env = gymnasium.make("FrozenLake-v1", is_slippery=False)
    env.reset()
    env.step(0)
    """
    found = document(script_in(tmp_path, text))
    assert (found["table"], found["steps"], found["episodes"]) == (None, 1, 0)
    assert (found["expected_return"], found["best_expected_return"]) == (None, 1.0)


def test_the_script_gets_its_arguments_and_options_may_stand_anywhere(tmp_path: Path) -> None:
    path = script_in(tmp_path, "import sys\nraise ValueError(sys.argv[1:])\n")
    expected = [
        ((path, "one", "-2", "--episodes", "5", "--json"), ["one", "-2", "--episodes", "5"]),
        (("--json", path, "--alpha=0.1", "-v"), ["--alpha=0.1", "-v"]),
        (("--json", path, "--", "--seed", "7", "--json"), ["--seed", "7", "--json"]),
        (("--seed", "1", path, "--json", "ä b", ""), ["ä b", ""]),
    ]
    for args, given in expected:
        code, text, _ = run(*args)
        assert (code, json.loads(text)["error"]["text"]) == (1, str(given))


def test_what_the_script_raises_stands_in_the_document_and_in_a_line(tmp_path: Path) -> None:
    path = script_in(tmp_path, "x = 1\nprint('printed')\nraise ValueError('of\\nits own')\n")
    code, text, complaint = run(path, "--json")
    assert code == 1
    assert json.loads(text)["error"] == {"type": "ValueError", "text": "of\nits own", "file": path, "line": 3}
    assert complaint == f"rl-tui: {path}, line 3: ValueError: of its own\n"


def test_a_table_may_be_named(tmp_path: Path) -> None:
    path = script_in(tmp_path, Q_LEARNING)
    assert document(path, "--table", "N")["table"]["name"] == "N"


@pytest.mark.parametrize(
    ("content", "text"),
    [
        (b"if x\n    pass\n", "line 1: expected ':'"),
        (b"x = 1\nreturn x\n", "line 2: 'return' outside function"),
        (b"x = '\xff'\n", "line 1: byte 0xff is not utf-8"),
        (b"# coding: no-such\nx = 1\n", "no-such"),
        (b"x = 1\0\n", "null"),
        (b"x = " + b"(" * 50_000, "line 1: too many nested parentheses"),
        (b"x = " + b"-" * 200_000 + b"1\n", "script.py: is nested too deeply for Python"),
        (b"# " + b"x" * 11_000_000, "expected a Python file of at most 10 MB"),
        (None, "no such file; expected a Python file"),
    ],
)
def test_what_is_no_script_is_refused_in_a_line(tmp_path: Path, content: bytes | None, text: str) -> None:
    path = tmp_path / "script.py"
    if content is not None:
        path.write_bytes(content)
    code, printed, complaint = run(str(path), "--json")
    (line,) = complaint.splitlines()
    assert (code, printed) == (1, "")
    assert text in line
    assert len(line) < 500


@pytest.mark.parametrize("name", [".", "/dev/null", "no\0name.py"])
def test_what_is_no_file_is_refused_in_a_line(name: str) -> None:
    code, printed, complaint = run(name, "--json")
    assert (code, printed, len(complaint.splitlines())) == (1, "", 1)


def notebook_in(folder: Path, *cells: str) -> Path:
    said = [{"cell_type": "markdown", "source": ["a text\n", "of two lines"]}]
    said += [{"cell_type": "code", "outputs": [], "source": each.splitlines(keepends=True)} for each in cells]
    path = folder / "course.ipynb"
    path.write_text(json.dumps({"cells": said}, indent=1))
    return path


def test_a_line_of_a_notebook_has_its_cell(tmp_path: Path) -> None:
    path = notebook_in(tmp_path, "x = 1", "y = 2\n\nx / 0")
    code, printed, complaint = run(str(path), "--json")
    assert code == 1
    assert "course.ipynb, cell 3, line 3: ZeroDivisionError" in complaint
    error = json.loads(printed)["error"]
    assert (error["file"], error["cell"], error["line"]) == (str(path), 3, 3)


def test_without_a_terminal_json_does(tmp_path: Path) -> None:
    code, _, complaint = run(script_in(tmp_path, "x = 1\n"))
    assert (code, complaint.endswith("; --json works without one\n")) == (2, True)


@pytest.mark.parametrize(("name", "value"), [("RL_TUI_KIOSK", "1"), ("TEXTUAL_DRIVER", "rl_tui")])
def test_strangers_cannot_run_scripts(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, value: str
) -> None:
    from rl_tui.screen.terminal.driver_choice import IN_BROWSER

    monkeypatch.setenv(name, IN_BROWSER if name == "TEXTUAL_DRIVER" else value)
    monkeypatch.chdir(tmp_path)
    path = script_in(tmp_path, "open('done', 'w')\n")
    code, printed, complaint = run(path, "--json")
    assert (code, printed, len(complaint.splitlines())) == (1, "", 1)
    assert os.listdir(tmp_path) == ["script.py"]
