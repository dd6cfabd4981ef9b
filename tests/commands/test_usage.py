"""Usage errors, with their words and exit status."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import tomllib
from dataclasses import replace
from pathlib import Path

import pytest
from called import assert_refused
from called import called as run
from click.testing import CliRunner, Result

from rl_tui import __version__
from rl_tui.agents.hyperparameters import PARAMETERS
from rl_tui.commands.line import program as program_module
from rl_tui.commands.line.key_on_screen import key_on_screen
from rl_tui.commands.main import RlTui, program
from rl_tui.common.packages import NEEDED
from rl_tui.live.record import Record
from rl_tui.live.sessions.session import encoded
from rl_tui.runs.library import find, recipe_for
from rl_tui.runs.timeline.branches import FIRST, RunRecord
from rl_tui.screen.keys.registry import ACTIONS
from rl_tui.studies.sweeps.cell import MEASURES


def one_line(result: Result) -> str:
    assert result.stdout == ""
    assert "Traceback" not in result.stderr
    assert result.stderr.count("\n") == 1
    return result.stderr


def test_version() -> None:
    result = run("--version")
    assert (result.exit_code, result.stdout) == (0, f"rl-tui, version {__version__}\n")


def test_help_lists_every_command() -> None:
    result = run("--help")
    assert result.exit_code == 0
    listed = re.findall(r"^  ([a-z]+) {2,}", result.stdout.partition("Commands:")[2], re.MULTILINE)
    assert listed[:9] == ["play", "learn", "edit", "train", "sweep", "watch", "replay", "solve", "evaluate"]
    assert set(listed) == set(RlTui.modules)
    for name in RlTui.modules:
        assert f"\n  {name} " in result.stdout
        assert run(name, "--help").exit_code == 0


def test_every_hyper_parameter_is_an_option_with_its_range() -> None:
    for command in ("train", "play", "screenshot"):
        text = " ".join(run(command, "--help").stdout.split())
        for parameter in PARAMETERS.values():
            assert f"--{parameter.name.replace('_', '-')} " in text


def test_help_has_a_section_for_each_purpose() -> None:
    text = run("train", "--help").stdout
    titles = re.findall(r"^(\w.*):$", text, re.MULTILINE)
    assert titles == [
        "Options",
        "How the agent learns",
        "How it chooses actions",
        "For some algorithms only",
        "How α and ε change from episode to episode",
    ]
    parts = dict(zip(titles, re.split(r"^\w.*:$", text, flags=re.MULTILINE)[1:], strict=True))
    assert re.findall(r"^  --([\w-]+)", parts["How the agent learns"], re.MULTILINE) == [
        "algorithm",
        "alpha",
        "gamma",
        "initial-q",
    ]
    assert "--ties" in parts["How it chooses actions"]
    assert "--traces" in parts["For some algorithms only"]
    assert text.count("thompson") == 1, "a word is told once"
    assert max(map(len, text.splitlines())) <= 80
    assert "SCENARIO" not in text.split("\n", 1)[1]


@pytest.mark.parametrize(
    ("option", "range_"),
    [
        (("--alpha", "-1"), "(0, 1]"),
        (("--alpha", "nan"), "(0, 1]"),
        (("--alpha", "fast"), "(0, 1]"),
        (("--gamma", "1.01"), "[0, 1]"),
        (("--gamma", "inf"), "[0, 1]"),
        (("--epsilon=-1e-9",), "[0, 1]"),
        (("--epsilon-min", "2"), "[0, 1]"),
        (("--epsilon-decay", "inf"), "[0, ∞)"),
        (("--initial-q", "nan"), "[-1e+12, 1e+12]"),
        (("--initial-q", "-1e13"), "[-1e+12, 1e+12]"),
        (("--ties", "last"), "random or first"),
        (("--episodes", "0"), "[1, "),
        (("--episodes", "1e3"), "[1, "),
        (("--steps", "-5"), "[1, "),
        (("--runs", "0"), "[1, "),
        (("--seed", "-1"), "[0, "),
        (("--seed", "9" * 5000), "[0, "),
    ],
)
def test_a_value_out_of_range_is_refused_with_the_range(option: tuple[str, ...], range_: str) -> None:
    result = run("train", "frozenlake", *option)
    assert result.exit_code == 2
    message = one_line(result)
    assert range_ in message
    assert option[0].split("=")[0] in message


@pytest.mark.parametrize(
    "args",
    [
        ("train",),
        ("train", "student", "--episodes", "3", "--steps", "3"),
        ("train", "student", "--algorithm", "guessing"),
        ("train", "student", "--csv", "-", "--json"),
        ("train", "student", "--no-such-option"),
        ("solve", "student", "--gamma", "2"),
        ("evaluate", "student"),
        ("evaluate", "student", "--policy", "uniform", "--epsilon", "2"),
        ("evaluate", "student", "--policy", "greedy", "--episodes", "3", "--steps", "3"),
        ("check",),
        ("bench", "--rounds", "0"),
        ("screenshot", "student"),
        ("screenshot", "student", "--out", "x.svg", "--size", "80"),
        ("screenshot", "student", "--out", "x.svg", "--size", "1x1"),
        ("screenshot", "student", "--out", "x.svg", "--fps", "nan"),
        ("screenshot", "student", "--out", "x.svg", "--colors", "7"),
        ("--theme", "light", "list"),
        ("frozenlake",),
    ],
)
def test_wrong_usage_is_one_line_and_status_2(args: tuple[str, ...]) -> None:
    result = run(*args)
    assert result.exit_code == 2
    one_line(result)


def test_near_commands_are_suggested() -> None:
    assert "did you mean train?" in run("tran").stderr
    assert "did you mean plot?" in run("plots").stderr
    assert "rl-tui play frozenlake" in run("frozenlake").stderr
    assert "to play a scenario: rl-tui play maze" in run("maze").stderr  # also a word for a key
    assert_refused(run("frobnicate"), 2, "unknown command 'frobnicate' (rl-tui --help lists the commands)")


@pytest.mark.parametrize(
    ("word", "said"),
    [
        ("export", "start rl-tui play, then press m x ("),
        ("explain", "start rl-tui play, then press t y (why) ("),
        ("ATLAS", "start rl-tui play, then press t s (settings map) ("),
        ("heatmap", "start rl-tui play, then press t s (settings map) ("),
        ("restart", "start rl-tui play, then press r r (the same) ("),
        ("findings", "start rl-tui watch SCRIPT.py, then press a f ("),
        ("hint", "start rl-tui learn, then press h ("),
        ("delete", "start rl-tui, then press del ("),
    ],
)
def test_words_of_keys_are_found_on_screen(word: str, said: str) -> None:
    assert_refused(run(word, "frozenlake"), 2, f"unknown command {word!r}; it is a key on screen: {said}")


def test_each_key_is_found_by_its_label() -> None:
    for action in ACTIONS:
        assert "it is a key on screen" in key_on_screen(action.label)


@pytest.mark.parametrize("command", ["train", "solve"])
def test_unknown_scenarios_suggest_near_ones(command: str) -> None:
    assert_refused(run(command, "frozenlak"), 1, "did you mean frozenlake")


def test_a_missing_file_is_named() -> None:
    assert_refused(run("train", "nowhere/to-be-found.toml"), 1, "nowhere/to-be-found.toml")


def test_a_csv_file_that_cannot_be_written_is_named(tmp_path: Path) -> None:
    target = str(tmp_path / "missing" / "episodes.csv")
    for more in ((), ("--runs", "2")):
        assert_refused(run("train", "student", "--csv", target, *more), 1, target)


@pytest.mark.screen
def test_a_picture_that_cannot_be_written_is_named(tmp_path: Path) -> None:
    target = str(tmp_path / "missing" / "picture.svg")
    assert_refused(run("screenshot", "student", "--out", target, "--size", "80x24"), 1, target)


def test_check_reports_every_fault_and_fails(tmp_path: Path) -> None:
    good = tmp_path / "good.toml"
    good.write_text(
        "[bandit]\narms = 2\nmean = { normal = [0.0, 1.0] }\nstd = 1.0\nbudget = 10\n", encoding="utf-8"
    )
    bad = tmp_path / "bad.toml"
    bad.write_text(
        '[defaults]\nalpha = 3\n[mdp]\nstart = "Nowhere"\nplace = { A = [0, 0], B = [1, 0] }\n'
        '[[mdp.transition]]\nstate = "A"\naction = "go"\nreward = 0.0\nto = { B = 0.7 }\n',
        encoding="utf-8",
    )
    result = run("check", str(good), str(bad))
    assert result.exit_code == 1
    assert result.stdout == f"{good}: ok\n"
    lines = result.stderr.splitlines()
    assert all(line.startswith(f"{bad}: ") for line in lines)
    assert any("defaults.alpha" in line and "(0, 1]" in line for line in lines)
    assert any("mdp.transition[0].to" in line for line in lines)
    assert any("mdp.start" in line for line in lines)


ENDLESS = """
[mdp]
start = "Home"
{limit}
[[mdp.transition]]
state = "Home"
action = "go"
reward = 0.0
to = {{ Forest = 0.5, Work = 0.5 }}
[[mdp.transition]]
state = "Forest"
action = "walk"
reward = -1.0
to = {{ {to} }}
[[mdp.transition]]
state = "Lake"
action = "swim"
reward = -1.0
to = "Forest"
"""


@pytest.mark.parametrize(
    ("limit", "to", "warned"),
    [
        ("", "Forest = 0.9, Lake = 0.1", True),
        ("time_limit = 50", "Forest = 0.9, Lake = 0.1", False),
        ("", "Forest = 0.9, Lake = 0.05, Work = 0.05", False),
    ],
)
def test_check_warns_of_a_world_that_never_ends(limit: str, to: str, warned: bool, tmp_path: Path) -> None:
    file = tmp_path / "endless.toml"
    file.write_text(ENDLESS.format(limit=limit, to=to), encoding="utf-8")
    result = run("check", str(file))
    assert (result.exit_code, result.stdout) == (0, f"{file}: ok\n")
    assert result.stderr == (
        f"{file}: warning: state Forest can never reach a terminal state, and there is no time limit: "
        "training stops after 10,000,000 steps of one episode; add a time_limit to end such episodes\n"
        if warned
        else ""
    )


TOLL_ROAD = """
[mdp]
start = "Home"
{limit}
[[mdp.transition]]
state = "Home"
action = "stay"
reward = 0.0
to = "Home"
[[mdp.transition]]
state = "Home"
action = "toll road"
reward = {reward}
to = "Work"
"""


@pytest.mark.parametrize(
    ("limit", "reward", "epsilon", "warned"),
    [
        ("", -1.0, 0.0, "after SARSA has learned, with γ 0.99 and ε 0, an episode takes almost forever"),
        ("", -1.0, 0.1, "the optimal policy for γ 0.99 may never end an episode"),
        ("", 1.0, 0.0, ""),
        ("time_limit = 50", -1.0, 0.0, ""),
    ],
)
def test_check_warns_where_an_agent_may_learn_never_to_end(
    limit: str, reward: float, epsilon: float, warned: str, tmp_path: Path
) -> None:
    file = tmp_path / "toll.toml"
    world = TOLL_ROAD.format(limit=limit, reward=reward)
    file.write_text(f"[defaults]\nepsilon = {epsilon}\n{world}", encoding="utf-8")
    result = run("check", str(file))
    assert (result.exit_code, result.stdout) == (0, f"{file}: ok\n")
    why = (
        "and there is no time limit: the path to the end costs more than it earns; "
        "add a time_limit to end such episodes"
    )
    assert result.stderr == (f"{file}: warning: {warned}, {why}\n" if warned else "")


@pytest.mark.parametrize("more", [(), ("--json",), ("--runs", "2")])
@pytest.mark.parametrize("count", ["--episodes", "--steps"])
def test_more_pulls_than_the_budget_are_made_but_said(count: str, more: tuple[str, ...]) -> None:
    result = run("train", "bandit", count, "1001", *more)
    assert result.exit_code == 0
    assert result.stderr == "the budget of this bandit is 1,000 pulls; on screen the run ends there\n"
    assert "1001" in result.stdout.replace(",", "")
    assert run("train", "bandit", count, "1000", *more).stderr == ""


def test_check_accepts_the_shipped_scenarios() -> None:
    files = sorted(str(file) for file in (Path(__file__).parents[2] / "scenarios").glob("*.toml"))
    result = run("check", *files)
    assert result.exit_code == 0
    assert result.stderr == ""
    assert result.stdout == "".join(f"{file}: ok\n" for file in files)
    assert len(files) >= 25


@pytest.mark.parametrize(
    ("args", "said"),
    [
        (("learn", "nolesson"), 'no lesson "nolesson"'),
        (("play", "nowhere"), 'no scenario "nowhere"'),
        (("edit", "nowhere"), 'no scenario "nowhere"'),
        (("watch", "nowhere.py"), "nowhere.py: no such file"),
    ],
)
def test_an_unknown_name_is_reported_without_a_terminal_too(args: tuple[str, ...], said: str) -> None:
    assert_refused(run(*args), 1, said)


@pytest.mark.parametrize("args", [(), ("play",), ("play", "frozenlake")])
def test_without_a_terminal_one_sentence_and_status_2(args: tuple[str, ...]) -> None:
    assert_refused(run(*args), 2, "needs a terminal")


def test_a_bug_is_one_line_too(monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*args: object, **more: object) -> None:
        raise ZeroDivisionError("a\nb")

    monkeypatch.delenv(program_module.TRACEBACK, raising=False)
    monkeypatch.setattr("rl_tui.runs.library.find", broken)
    assert_refused(run("train", "student"), 1, "ZeroDivisionError: a b")
    monkeypatch.setenv(program_module.TRACEBACK, "1")
    assert isinstance(run("train", "student").exception, ZeroDivisionError)


@pytest.mark.parametrize(("package", "args"), [("tomlkit", ("new", "own")), ("gymnasium", ("list",))])
def test_a_missing_package_is_named_with_how_to_install_it(
    package: str, args: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    for module in {package, *(each for each in sys.modules if each.startswith(f"{package}."))}:
        monkeypatch.setitem(sys.modules, module, None)
    done = run(*args)
    assert (done.exit_code, done.stdout) == (1, "")
    assert done.stderr == f"rl-tui: the package {package} is missing; install it: pip install {package}\n"


def test_the_packages_that_are_needed_are_those_of_pyproject() -> None:
    project = tomllib.loads((Path(__file__).parents[2] / "pyproject.toml").read_text(encoding="utf-8"))
    assert {re.split(r"[>=<]", each)[0] for each in project["project"]["dependencies"]} == NEEDED


@pytest.mark.process
def test_a_reader_that_has_gone_is_no_traceback() -> None:
    reading, writing = os.pipe()
    os.close(reading)
    try:
        done = subprocess.run(
            [sys.executable, "-m", "rl_tui", "list", "--json"],
            stdout=writing,
            stderr=subprocess.PIPE,
            check=False,
        )
    finally:
        os.close(writing)
    assert (done.returncode, done.stderr) == (1, b"")


@pytest.mark.process
@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="needs /dev/full, which Linux has")
def test_a_full_disk_under_stdout_is_one_line() -> None:
    with open("/dev/full", "wb") as full:
        done = subprocess.run(
            [sys.executable, "-m", "rl_tui", "list"], stdout=full, stderr=subprocess.PIPE, check=False
        )
    message = b"rl-tui: stdout: cannot be written (No space left on device)\n"
    assert (done.returncode, done.stderr) == (1, message)


@pytest.mark.process
@pytest.mark.parametrize("name", ["train", "replay"])
def test_an_interrupt_is_quiet(tmp_path: Path, name: str) -> None:
    pipe, session = tmp_path / "episodes.csv", tmp_path / "session.json"
    os.mkfifo(pipe)
    branch = replace(FIRST, end=10**15, here=10**15)
    session.write_bytes(encoded(Record((RunRecord(recipe_for(find("student")), (branch,)),))))
    endless = {"train": ["student", "--steps", str(10**15)], "replay": [str(session)]}
    command = [sys.executable, "-m", "rl_tui", name, *endless[name], "--csv", str(pipe)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        with pipe.open("rb", buffering=0) as stream:
            assert stream.read(4) == b"run,"
            while len(stream.read(65536)) < 4096:  # until training has begun
                pass
            process.send_signal(signal.SIGINT)
            while stream.read(65536):
                pass
        out, err = process.communicate()
    assert process.returncode == 130
    assert (out, err.strip()) == (b"", b"")


@pytest.mark.parametrize(
    ("option", "message"),
    [
        ("--kiosk", "unknown option --kiosk here; it belongs to rl-tui, rl-tui play, rl-tui learn"),
        ("--runes=3", "unknown option --runes; did you mean --runs?"),
        ("--zzz", "unknown option --zzz"),
        ("-z", "unknown option -z"),
    ],
)
def test_an_unknown_option_leads_to_where_it_is_known(option: str, message: str) -> None:
    result = CliRunner().invoke(program, ["train", option, "student"], prog_name="rl-tui")
    assert result.exit_code == 2
    assert one_line(result) == f"rl-tui train: {message} (rl-tui train --help lists the options)\n"


def test_an_option_that_nobody_uses_is_told() -> None:
    result = run("train", "frozenlake", "--episodes", "5", "--lambda", "0.5", "--temperature", "1")
    assert result.exit_code == 0
    assert result.stderr.splitlines() == [
        "--temperature has no effect: q-learning with policy epsilon-greedy does not use it",
        "--lambda has no effect: q-learning with policy epsilon-greedy does not use it",
    ]
    planned = run("train", "frozenlake", "--algorithm", "value-iteration", "--epsilon", "0.5")
    assert planned.stderr == "--epsilon has no effect: value-iteration does not use it\n"
    used = run("train", "frozenlake", "--episodes", "5", "--algorithm", "sarsa-lambda", "--lambda", "0.5")
    assert used.stderr == ""


def test_help_lists_every_metric_of_a_sweep() -> None:
    said = run("sweep", "--help").stdout
    assert [name for name in MEASURES if name not in said] == []
