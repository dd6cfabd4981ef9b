"""Errors in a scenario file."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from rl_tui.common.errors import ScenarioError
from rl_tui.worlds.files.scenario import read_scenario
from rl_tui.worlds.files.shipped import shipped_folder

STUDENT = (shipped_folder() / "student.toml").read_text(encoding="utf-8")
BANDIT = "[bandit]\narms = 3\n"
LAKE = '[gymnasium]\nid = "FrozenLake-v1"\n'


@pytest.fixture
def faults(tmp_path):
    """Return a function: the text of a file → its faults as (place, found, expected)."""

    def faults_of(content: str | bytes) -> list[tuple[str, str, str]]:
        path = tmp_path / "mine.toml"
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        with pytest.raises(ScenarioError) as error:
            read_scenario(path)
        assert {fault.file for fault in error.value.faults} == {str(path)}
        assert len(str(error.value).splitlines()) == len(error.value.faults)
        return [(fault.place, fault.found, fault.expected) for fault in error.value.faults]

    return faults_of


def student(old: str, new: str) -> str:
    assert old in STUDENT
    return STUDENT.replace(old, new)


ONE_FAULT = {
    "no world": ('title = "t"\n', ("", "no world", "exactly one of [gymnasium], [mdp], [grid], [bandit]")),
    "two worlds": (
        BANDIT + LAKE,
        ("", "[bandit] and [gymnasium]", "exactly one of [gymnasium], [mdp], [grid], [bandit]"),
    ),
    "an answer that is neither": (
        'answer = "maybe"\n' + BANDIT,
        ("answer", '"maybe"', '"hidden" or "shown"'),
    ),
    "a panel that there is not": (
        'panels = ["world", "curv"]\n' + BANDIT,
        ("panels", '"curv"', 'the id of a panel: world, .*last_step (did you mean "curve"?)'),
    ),
    "panels that are none": ("panels = []\n" + BANDIT, ("panels", ".*", "a list of ids of panels")),
    "an answer that is no text": ("answer = [true]\n" + BANDIT, ("answer", ".*", '"hidden" or "shown"')),
    "a world that is no table": ("mdp = 3\n", ("mdp", "3", "a table")),
    "an unknown key at the top": (
        'sumary = "s"\n' + BANDIT,
        ("sumary", 'unknown key; use one of .* (did you mean "summary"?)', ""),
    ),
    "an unknown key in a world": (
        student("time_limit", "time_limt"),
        (
            "mdp.time_limt",
            'unknown key; use one of .* (did you mean "time_limit"?)',
            "",
        ),
    ),
    "an unknown key in an outcome": (
        student("Pass = 0.8", "Pass = { p = 0.8, rewards = 1 }"),
        (
            "mdp.transition[0].to.Pass.rewards",
            'unknown key; use one of .* (did you mean "reward"?)',
            "",
        ),
    ),
    "an unknown key that needs quotes": ('"a b" = 1\n' + BANDIT, ('"a b"', "unknown key; use one of .*", "")),
    "probabilities below 1": (
        student("Pass = 0.8", "Pass = 0.7"),
        ("mdp.transition[0].to", "0.9", "probabilities that sum to 1 (±1e-9)"),
    ),
    "probabilities just beyond the tolerance": (
        student("Pass = 0.8", "Pass = 0.80000001"),
        ("mdp.transition[0].to", "1.00000001", "probabilities that sum to 1 (±1e-9)"),
    ),
    "no outcome": (
        student(
            "{ Pass = 0.8, Class = 0.2 }",
            '{ }\n[[mdp.transition]]\nstate = "Class"\naction = "go"\nreward = 0\nto = "Pass"',
        ),
        ("mdp.transition[0].to", "0", "probabilities that sum to 1 (±1e-9)"),
    ),
    "a probability above 1": (
        student("Pass = 0.8, Class = 0.2", "Pass = 1.8, Class = 0.2"),
        ("mdp.transition[0].to.Pass", "1.8", "a probability from 0 to 1, .*"),
    ),
    "NaN as a reward": (
        student("reward = 10.0", "reward = nan"),
        ("mdp.transition[4].reward", "nan", "a finite number from -1e+12 to 1e+12"),
    ),
    "an infinite probability": (
        student("Class = 0.2", "Class = inf"),
        ("mdp.transition[0].to.Class", "inf", "a probability from 0 to 1, .*"),
    ),
    "NaN in a table of its own": (
        student("Class = 0.2", "Class = { p = nan }"),
        ("mdp.transition[0].to.Class.p", "nan", "a finite number from 0 to 1"),
    ),
    "an infinite reward of one outcome": (
        student("Class = 0.2", "Class = { p = 0.2, reward = -inf }"),
        ("mdp.transition[0].to.Class.reward", "-inf", "a finite number from -1e+12 to 1e+12"),
    ),
    "a truth value for a number": (
        student("reward = 10.0", "reward = true"),
        ("mdp.transition[4].reward", "true", "a finite number from -1e+12 to 1e+12"),
    ),
    "a number too large to be one": (
        student("reward = 10.0", f"reward = {10**400}"),
        ("mdp.transition[4].reward", "1000.*…", "a finite number from -1e+12 to 1e+12"),
    ),
    "a number too long to write out": (
        student("time_limit = 100", "time_limit = 0x" + "f" * 5000),
        ("mdp.time_limit", "a whole number of 20,000 bits", "a whole number from 0 to 1,000,000"),
    ),
    "an unknown state in an outcome": (
        student("Pass = 0.8", "Pas = 0.8"),
        (
            "mdp.transition[0].to",
            'unknown state "Pas"; use a state with transitions, or a terminal one '
            'named in mdp.place (did you mean "Pass"?)',
            "",
        ),
    ),
    "an unknown state as the only outcome": (
        student('"Sleep"', '"Nowhere"').replace("Sleep = [2, 1]", ""),
        (
            "mdp.transition[4].to",
            'unknown state "Nowhere"; use a state with transitions, or a terminal one named in mdp.place',
            "",
        ),
    ),
    "an unknown state at the start": (
        student('start = "Class"', 'start = "class"'),
        ("mdp.start", 'unknown state "class"; use a state with transitions (did you mean "Class"?)', ""),
    ),
    "an unknown state with a place": (
        student("Sleep = [2, 1]", "Sleep = [2, 1]\nBed = [3, 1]"),
        ("mdp.place.Bed", 'unknown state "Bed"; use a state that a transition mentions', ""),
    ),
    "a state that differs only in case": (
        '[mdp]\nstart = "A"\n[[mdp.transition]]\nstate = "A"\naction = "go"\nreward = 1\nto = "a"\n',
        (
            "mdp.transition[0].to",
            'unknown state "a"; use a state with transitions, or a terminal one '
            'named in mdp.place (did you mean "A"?)',
            "",
        ),
    ),
    "an unreachable state": (
        student(
            'to = "Phone"\n\n[[mdp.transition]]\nstate = "Phone"\naction = "scroll"',
            'to = "Class"\n\n[[mdp.transition]]\nstate = "Phone"\naction = "scroll"',
        ),
        (
            "mdp.transition[2].state",
            'unreachable state "Phone"; add a way from the start, or remove it',
            "",
        ),
    ),
    "a state reached with probability 0 only": (
        '[mdp]\nstart = "A"\ntransition = [{ state = "A", action = "x", reward = 1, to = { B = 1, C = 0}}]\n',
        ("mdp.transition[0].to", 'unreachable state "C"; add a way from the start, or remove it', ""),
    ),
    "a pair given twice": (
        student('action = "quit"', 'action = "scroll"'),
        (
            "mdp.transition[3]",
            'state "Phone" with action "scroll" is listed already, in mdp.transition[2]; list it once',
            "",
        ),
    ),
    "no start": (
        student('start = "Class"', ""),
        (
            "mdp.start",
            "nothing",
            "the name of a state, or a table of at most 10,000 states and their probabilities",
        ),
    ),
    "an empty start": (
        student('start = "Class"', "start = {}"),
        ("mdp.start", "0", "probabilities that sum to 1 (±1e-9)"),
    ),
    "a terminal start": (
        student('start = "Class"', "start = { Class = 0.5, Sleep = 0.5 }"),
        ("mdp.start", '"Sleep" is a terminal state; start in a state with transitions', ""),
    ),
    "no transition": (
        '[mdp]\nstart = "A"\n',
        ("mdp.transition", "nothing", "1 to 100,000 tables [[mdp.transition]]"),
    ),
    "no action": (
        student('action = "sleep"\n', ""),
        ("mdp.transition[4].action", "nothing", "a name of 1 to 60 characters"),
    ),
    "no reward": (
        student("reward = 10.0\n", ""),
        ("mdp.transition[4].reward", "nothing", "a reward, here or in every outcome"),
    ),
    "two states in one place": (
        student("Sleep = [2, 1]", "Sleep = [1, 1]"),
        ("mdp.place.Sleep", '"Pass" is already at [1, 1]; choose a free place', ""),
    ),
    "a place between two": (
        student("Sleep = [2, 1]", "Sleep = [2.5, 1]"),
        ("mdp.place.Sleep", "[2.5, 1]", "[column, row], whole numbers from 0 to 999"),
    ),
    "a negative time limit": (
        student("time_limit = 100", "time_limit = -1"),
        ("mdp.time_limit", "-1", "a whole number from 0 to 1,000,000"),
    ),
    "a name with a control character": (
        student('"Sleep"', '"Sle\\u0007ep"').replace("Sleep = [2, 1]", ""),
        ('mdp.transition[4].to."Sle\\u0007ep"', 'U+0007 in "Sle\\u0007ep"', "a name of 1 to 60 characters"),
    ),
    "no arms": ("[bandit]\narms = 0\n", ("bandit.arms", "0", "a whole number from 1 to 10,000")),
    "half an arm": ("[bandit]\narms = 2.5\n", ("bandit.arms", "2.5", "a whole number from 1 to 10,000")),
    "arms left out": ("[bandit]\n", ("bandit.arms", "nothing", "a whole number from 1 to 10,000, or means")),
    "an empty list of means": ("[bandit]\nmeans = []\n", ("bandit.means", "[]", "1 to 10,000 numbers")),
    "NaN among the means": (
        "[bandit]\nmeans = [1, nan]\n",
        ("bandit.means[1]", "nan", "a finite number from -1e+12 to 1e+12"),
    ),
    "more means than arms": (
        BANDIT + "means = [1, 2, 3, 4]\n",
        ("bandit.means", "4 means", "as many as there are arms (3)"),
    ),
    "mean and means": (
        "[bandit]\nmeans = [1]\nmean = { normal = [0, 1] }\n",
        ("bandit.mean", "mean and means are both set; keep one of them", ""),
    ),
    "a negative deviation of the means": (
        BANDIT + "mean = { normal = [0, -1] }\n",
        ("bandit.mean.normal", "[0, -1]", "[mean, standard deviation], the second from 0 to 1e+06"),
    ),
    "negative noise": (BANDIT + "std = -1\n", ("bandit.std", "-1", "a finite number from 0 to 1e+06")),
    "no pulls": (BANDIT + "budget = 0\n", ("bandit.budget", "0", "a whole number from 1 to 1,000,000,000")),
    "an environment that is not registered": (
        '[gymnasium]\nid = "FrozenLke-v1"\n',
        (
            "gymnasium.id",
            'no environment is registered as "FrozenLke-v1"; choose another (did you mean "FrozenLake-v1"?)',
            "",
        ),
    ),
    "an environment near to none that is small": (
        '[gymnasium]\nid = "Hoper-v5"\n',
        ("gymnasium.id", 'no environment is registered as "Hoper-v5"; choose another', ""),
    ),
    "an environment near to one in other letters": (
        '[gymnasium]\nid = "BlackJack-v2"\n',
        (
            "gymnasium.id",
            'no environment is registered as "BlackJack-v2"; choose another (did you mean "Blackjack-v1"?)',
            "",
        ),
    ),
    "an environment that is not discrete": (
        '[gymnasium]\nid = "CartPole-v1"\n',
        (
            "gymnasium.id",
            "CartPole-v1 returns 4 real numbers (a Box), not numbered states; write a "
            "scenario file with [gymnasium.bins], which turns them into states",
            "",
        ),
    ),
    "a module to import": (
        '[gymnasium]\nid = "os:FrozenLake-v1"\n',
        (
            "gymnasium.id",
            '"os:FrozenLake-v1" names a module, which is not imported; '
            "if you trust it, add --allow-module os",
            "",
        ),
    ),
    "an argument that the environment refuses": (
        LAKE + "kwargs = { slippery = true }\n",
        (
            "gymnasium.kwargs",
            "FrozenLake-v1 cannot be created with these arguments (TypeError: .*); correct them",
            "",
        ),
    ),
    "rewards beyond the range": (
        LAKE + "kwargs = { reward_schedule = [1e300, 0.0, 0.0] }\n",
        (
            "gymnasium.kwargs",
            "the table of FrozenLake-v1 has an error: a reward of state 14, "
            "action 1 is 1e+300, not within ±1e+12; choose another environment",
            "",
        ),
    ),
    "a window": (
        LAKE + 'kwargs = { render_mode = "human" }\n',
        ("gymnasium.kwargs.render_mode", '"human"', "no such argument, because rl-tui draws the world"),
    ),
    "a number for an id": (
        "[gymnasium]\nid = 3\n",
        ("gymnasium.id", "3", "one line of at most 100 characters, without control characters"),
    ),
    "no id": ("[gymnasium]\n", ("gymnasium.id", "nothing", "one line of at most 100 characters, .*")),
    "a control character in the title": (
        'title = "a\\u001b[31m"\n' + BANDIT,
        ("title", 'U+001B in "a\\u001b[31m"', "one line of at most 80 characters, .*"),
    ),
    "a title of two lines": (
        'title = "a\\nb"\n' + BANDIT,
        ("title", 'U+000A in "a\\nb"', "one line of at most 80 characters, .*"),
    ),
    "a number for the notes": (
        "notes = 3\n" + BANDIT,
        ("notes", "3", "a text of at most 20,000 characters, .*"),
    ),
    "defaults that are no table": ("defaults = 3\n" + BANDIT, ("defaults", "3", "a table")),
    "TOML with a mistake": (
        'title = "t"\narms = \n',
        ("line 2, column 8", "not valid TOML (Invalid value)", ""),
    ),
    "a decimal comma": (
        "[grid]\nstep_reward = -0,04\n",
        ("line 2, column 17", "-0,04", "-0.04, with a decimal point"),
    ),
    "a decimal comma within a table": (
        "to = { Pass = 0,8, Class = 0,2 }\n",
        ("line 1, column 18", "0,8", "0.8, with a decimal point"),
    ),
    "a decimal comma before a bracket": (
        "a = { b = 0,5 }\n",
        ("line 1, column 15", "0,5", "0.5, with a decimal point"),
    ),
    "a decimal comma in a list": (
        "a = [-0,04]\n",
        ("line 1, column 10", "-0,04", "-0.04, with a decimal point"),
    ),
    "a list without a comma": ("a = [1 3,4]\n", ("line 1, column 8", "not valid TOML (.*)", "")),
    "a thousand": ("a = 1,000\n", ("line 1, column 6", "1,000", "1.000, .* or 1000 without a comma")),
    "a comma that is none of a number": (
        'a = "1,5" 2\n',
        ("line 1, column 11", "not valid TOML (.*)", ""),
    ),
    "TOML that breaks off": ("a = 1\nb = [\n", ("line 2", "not valid TOML (.*)", "")),
    "a string without end": (
        'order = 1\nnotes = """\n"a"\n',
        ("line 2", "not valid TOML (Unterminated string)", ""),
    ),
    "a literal string without end": (
        "order = 1\nnotes = '''\na\n",
        ("line 2", "not valid TOML (Expected \"'''\")", ""),
    ),
    "a number with too many digits": (f"a = {'1' * 5000}\n", ("", "not valid TOML (.*)", "")),
    "tables without end": (
        f"a = {'[' * 100_000}",
        ("", "tables are nested too deeply; use fewer levels", ""),
    ),
    "no UTF-8": (
        b'title = "t"\nsummary = "\xff"\n',
        ("line 2", "byte 0xff is not UTF-8; save the file as UTF-8", ""),
    ),
}


def agrees(text: str, pattern: str) -> bool:
    """Compare literally, except that ``.*`` stands for anything."""
    return re.fullmatch(".*".join(re.escape(part) for part in pattern.split(".*")), text) is not None


@pytest.mark.parametrize("name", ONE_FAULT)
def test_gives_its_one_line(name, faults):
    content, expected = ONE_FAULT[name]
    (found,) = faults(content)
    for text, pattern in zip(found, expected, strict=True):
        assert agrees(text, pattern), f"{text!r} is not {pattern!r}"


def test_tells_all_faults_at_once_in_the_order_of_the_file(faults):
    content = (
        STUDENT.replace("order = 20", "order = -1")
        .replace('start = "Class"', 'start = "Clas"')
        .replace("Sleep = [2, 1]", "Sleep = [1, 1]")
        .replace("Pass = 0.8", "Pass = 0.7")
        .replace("reward = 10.0", "reward = nan")
        + "\n[bandit]\narms = 0\nbudgets = 4\n"
    )
    assert [place for place, _, _ in faults(content)] == [
        "",
        "order",
        "mdp.start",
        "mdp.place.Sleep",
        "mdp.transition[0].to",
        "mdp.transition[4].reward",
        "bandit.arms",
        "bandit.budgets",
    ]


def test_a_fault_of_form_brings_no_faults_that_only_follow_from_it(faults):
    assert [place for place, _, _ in faults(student("Pass = 0.8, Class = 0.2", "Pass = true"))] == [
        "mdp.transition[0].to.Pass"
    ]
    assert [place for place, _, _ in faults(student('state = "Pass"', ""))] == ["mdp.transition[4].state"]


def test_limits_the_number_of_states(faults):
    chain = "".join(
        f'[[mdp.transition]]\nstate = "{i}"\naction = "go"\nreward = 0\nto = "{i + 1}"\n'
        for i in range(10_000)
    )
    assert faults('[mdp]\nstart = "0"\n' + chain) == [("mdp.transition", "10,001 states", "at most 10,000")]


@pytest.mark.parametrize(
    ("path", "found"),
    [
        ("missing.toml", "no such file"),
        (".", "a folder"),
        ("with\0null.toml", "the path has control characters; rename the file"),
    ],
)
def test_a_file_that_cannot_be_read(path, found, tmp_path):
    with pytest.raises(ScenarioError) as error:
        read_scenario(f"{tmp_path}/{path}")
    (fault,) = error.value.faults
    assert fault.found == found
    assert "\0" not in str(fault)


def test_a_fault_reads_as_one_line():
    path = Path("no/such.toml")
    with pytest.raises(ScenarioError, match=r"^no/such\.toml: no such file; expected a TOML file$"):
        read_scenario(path)


def test_an_environment_that_is_not_asked_tells_when_the_world_is_built(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text('[gymnasium]\nid = "CartPole-v1"\n')
    scenario = read_scenario(path, ask_environment=False)
    with pytest.raises(ScenarioError) as error:
        scenario.build(np.random.default_rng(0))
    assert error.value.faults[0].place == "gymnasium.id"
    assert error.value.faults[0].file == str(path)
