"""Errors in a [grid] table."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rl_tui.common.errors import ScenarioError
from rl_tui.worlds.files.scenario import read_scenario
from rl_tui.worlds.grid.section import GridSection
from rl_tui.worlds.sections.schema import parsed

MAP = 'map = """\nS..#\n.#.G\n"""\n'


@pytest.fixture
def faults(tmp_path):
    """Return a function: the text of a [grid] table → its faults as (place, found, expected)."""

    def faults_of(content: str) -> list[tuple[str, str, str]]:
        path = tmp_path / "mine.toml"
        path.write_text(f"[grid]\n{content}", encoding="utf-8")
        with pytest.raises(ScenarioError) as error:
            read_scenario(path)
        return [
            (fault.place.removeprefix("grid."), fault.found, fault.expected) for fault in error.value.faults
        ]

    return faults_of


def legend(entry: str, text: str = "S.XG") -> str:
    return f'map = "{text}"\n[grid.legend]\n{entry}\n'


X = "legend.X"
ONE_FAULT = {
    "neither map nor random": ("", ("map", "nothing", "a map of characters, or random")),
    "map and random": (
        MAP + "random = { rows = 3, columns = 3 }\n",
        ("random", "map and random are both set; keep one of them", ""),
    ),
    "a map that is no text": ("map = 3\n", ("map", "3", "a map of characters, a line for each row")),
    "a wall in the way of a drawn map": (
        'random = { rows = 3, columns = 3 }\n[grid.legend]\nG = { kind = "wall" }\n',
        ("legend.G.kind", "walls would block the path to the goal of a random map; choose another kind", ""),
    ),
    "an empty map": (
        'map = ""\n',
        ("map", "the map is empty; write one line of characters for each row", ""),
    ),
    "a map of line breaks": (
        'map = "\\n\\n"\n',
        ("map", "the map is empty; write one line of characters for each row", ""),
    ),
    "a ragged map": (
        'map = """\nS..\n..\n..G\n"""\n',
        ("map", "line 2 has 2 characters, line 1 has 3; make all equally long", ""),
    ),
    "a map with several odd lines": (
        'map = "S..\\n.\\n..G\\n...."\n',
        (
            "map",
            "line 2 has 1 character, line 1 has 3 (1 more line of another length); make all equally long",
            "",
        ),
    ),
    "an empty line inside": (
        'map = "SG\\n\\n.."\n',
        ("map", "line 2 has 0 characters, line 1 has 2; make all equally long", ""),
    ),
    "no start": (
        'map = "..G"\n',
        ("map", 'the map has no start; add a cell of the kind "start", such as S', ""),
    ),
    "an unknown character": (
        'map = "S.\\n?G"\n',
        ("map", '"?" in line 2, column 1 is not in the legend; add it to [grid.legend]', ""),
    ),
    "a control character": (
        'map = "S\\tG"\n',
        ("map", '"\\t" in line 1, column 2 is not in the legend; add it to [grid.legend]', ""),
    ),
    "too many cells": (
        f'map = """\n{chr(10).join(["S" * 3001] * 1334)}\n"""\n',
        ("map", "1,334 × 3,001 cells", "at most 4,000,000 cells and 10,000 on a side"),
    ),
    "too long a side": (
        f'map = "{"S" * 10_001}"\n',
        ("map", "1 × 10,001 cells", "at most 4,000,000 cells and 10,000 on a side"),
    ),
    "too large a random map": (
        "random = { rows = 2001, columns = 2000 }\n",
        ("random", "2,001 × 2,000 cells", "at most 4,000,000 cells and 10,000 on a side"),
    ),
    "too many outcomes": (
        f'random = {{ rows = 2000, columns = 2000 }}\nmoves = "king"\nwind = {[1] * 2000}\ngusts = true\n',
        ("random", "2,000 × 2,000 cells with 96,000,000 outcomes", "at most 50,000,000 outcomes"),
    ),
    "a random map of one cell": (
        "random = { rows = 1, columns = 1 }\n",
        ("random", "1 × 1 cells", "2 cells or more, for a start and a goal"),
    ),
    "a random map without a size": (
        "random = { rows = 3 }\n",
        ("random.columns", "nothing", "a whole number from 1 to 10,000"),
    ),
    "more holes than can be": (
        "random = { rows = 3, columns = 3, holes = 1 }\n",
        ("random.holes", "1", "a finite number from 0 to 0.9"),
    ),
    "a random map that is no table": (
        "random = 8\n",
        ("random", "8", "a table, { rows = …, columns = …, holes = … }"),
    ),
    "unknown moves": (
        MAP + 'moves = "eight"\n',
        ("moves", '"eight"', "one of four, clockwise, king, king+stay"),
    ),
    "unknown moves on ice": (
        MAP + 'moves = "eight"\nslippery = true\n',
        ("moves", '"eight"', "one of four, clockwise, king, king+stay"),
    ),
    "unknown moves with noise": (
        MAP + "moves = [1]\nnoise = 0.1\n",
        ("moves", "[1]", "one of four, clockwise, king, king+stay"),
    ),
    "moves that are no text": (
        MAP + "moves = 4\n",
        ("moves", "4", "one of four, clockwise, king, king+stay"),
    ),
    "moves that are a list": (
        MAP + "moves = []\n",
        ("moves", "[]", "one of four, clockwise, king, king+stay"),
    ),
    "unknown rewards": (MAP + 'rewards = "both"\n', ("rewards", '"both"', '"entering" or "leaving"')),
    "rewards that are a list": (MAP + "rewards = [[1]]\n", ("rewards", "[[1]]", '"entering" or "leaving"')),
    "noise beyond 1": (MAP + "noise = 1.5\n", ("noise", "1.5", "a finite number from 0 to 1")),
    "noise on ice": (
        MAP + "noise = 0.2\nslippery = true\n",
        ("slippery", "noise and slippery are both set; keep one of them", ""),
    ),
    "noise with king's moves": (
        MAP + 'noise = 0.2\nmoves = "king"\n',
        ("noise", 'noise does not work with moves = "king"; use moves = "four", or leave out noise', ""),
    ),
    "ice with king's moves": (
        MAP + 'slippery = true\nmoves = "king+stay"\n',
        (
            "slippery",
            'slippery does not work with moves = "king+stay"; use moves = "four", or leave out slippery',
            "",
        ),
    ),
    "ice that is no truth value": (MAP + "slippery = 1\n", ("slippery", "1", "true or false")),
    "wind for too few columns": (MAP + "wind = [0, 1]\n", ("wind", "2 numbers", "one for each column (4)")),
    "wind for too many rows": (
        MAP + "wind_rows = [0, 1, 1]\n",
        ("wind_rows", "3 numbers", "one for each row (2)"),
    ),
    "wind of half a cell": (
        MAP + "wind = [0, 0.5, 0, 0]\n",
        ("wind[1]", "0.5", "a whole number from -100 to 100"),
    ),
    "wind that is no list": (MAP + "wind = 1\n", ("wind", "1", "a list of at most 10,000 whole numbers")),
    "wind in more columns than can be": (
        f'map = "SG"\nwind_rows = {[0] * 10_001}\n',
        ("wind_rows", "a list of 10,001", "a list of at most 10,000 whole numbers"),
    ),
    "wind too strong": (
        MAP + "wind = [0, 0, 0, 101]\n",
        ("wind[3]", "101", "a whole number from -100 to 100"),
    ),
    "gusts in a calm": (
        MAP + "gusts = true\n",
        ("gusts", "gusts need wind; add wind or wind_rows, or leave out gusts", ""),
    ),
    "gusts of no wind": (
        MAP + "gusts = true\nwind = [0, 0, 0, 0]\n",
        ("gusts", "gusts need wind; add wind or wind_rows, or leave out gusts", ""),
    ),
    "a time limit below 0": (
        MAP + "time_limit = -1\n",
        ("time_limit", "-1", "a whole number from 0 to 1,000,000"),
    ),
    "an infinite step reward": (
        MAP + "step_reward = inf\n",
        ("step_reward", "inf", "a finite number from -1e+12 to 1e+12"),
    ),
    "a legend that is no table": (
        MAP + "legend = 3\n",
        ("legend", "3", "a table of characters and what they mean, at most 200"),
    ),
    "two characters": (legend('XX = { kind = "floor" }', "S.G"), ("legend.XX", '"XX"', "one character")),
    "a character that moves the cursor": (
        legend('"\\u0007" = { kind = "floor" }', "S.G"),
        ('legend."\\u0007"', 'U+0007 in "\\u0007"', "one character"),
    ),
    "an entry that is no table": (legend('X = "floor"'), (X, '"floor"', "a table")),
    "an entry without a kind": (
        legend("X = { reward = 1 }"),
        (f"{X}.kind", "nothing", "one of floor, start, goal, hole, wall, cliff"),
    ),
    "an unknown kind": (
        legend('X = { kind = "lava" }'),
        (f"{X}.kind", '"lava"', "one of floor, start, goal, hole, wall, cliff"),
    ),
    "an unknown key in an entry": (
        legend('X = { kind = "floor", rewrd = 1 }'),
        (
            f"{X}.rewrd",
            'unknown key; use one of kind, reward, terminal, exit, jump, back, only (did you mean "reward"?)',
            "",
        ),
    ),
    "a reward in a wall": (
        legend('X = { kind = "wall", reward = 1 }'),
        (f"{X}.reward", "a wall cannot be entered; leave out reward", ""),
    ),
    "a terminal start": (
        legend('X = { kind = "start", terminal = true }'),
        (f"{X}.terminal", "a start cannot be terminal; leave out terminal", ""),
    ),
    "an exit from a terminal cell": (
        legend('X = { kind = "goal", terminal = true, exit = true }'),
        (f"{X}.exit", "a terminal cell has no exit; leave it out, or set terminal = false", ""),
    ),
    "a jump from a terminal cell": (
        legend('X = { kind = "goal", jump = "S" }'),
        (f"{X}.jump", "a terminal cell has no jump; leave it out, or set terminal = false", ""),
    ),
    "a way back from a terminal cell": (
        legend('X = { kind = "hole", back = true }'),
        (f"{X}.back", "a terminal cell has no back; leave it out, or set terminal = false", ""),
    ),
    "two special things at once": (
        legend('X = { kind = "floor", back = true, exit = true }'),
        (f"{X}.back", "exit and back are both set; keep one of them", ""),
    ),
    "back in a start": (
        legend('X = { kind = "start", back = true }', ".XG"),
        (f"{X}.back", "a start cannot lead back to itself; leave out back", ""),
    ),
    "back to several starts": (
        legend('X = { kind = "cliff", back = true }', "SSXG"),
        (f"{X}.back", "back = true leads to the start, but the map has 2; keep one start", ""),
    ),
    "a jump to what is not on the map": (
        legend('X = { kind = "floor", jump = "Y" }'),
        (f"{X}.jump", '"Y" is not on the map; use a character that occurs once', ""),
    ),
    "a jump to several cells": (
        legend('X = { kind = "floor", jump = "." }', "S..XG"),
        (f"{X}.jump", '"." occurs 2 times on the map; use a character that occurs once', ""),
    ),
    "a jump into a wall": (
        legend('X = { kind = "floor", jump = "#" }', "S#XG"),
        (f"{X}.jump", '"#" is a wall; use a cell that can be entered', ""),
    ),
    "a jump that is no character": (
        legend('X = { kind = "floor", jump = "home" }'),
        (f"{X}.jump", '"home"', "one character"),
    ),
    "a move that there is not": (
        legend('X = { kind = "floor", only = ["north"] }'),
        (
            f"{X}.only",
            '["north"]',
            "a list of moves, from left, down, right, up, down-left, down-right, up-right, up-left, stay",
        ),
    ),
    "moves that are no names": (
        legend('X = { kind = "floor", only = [["up"]] }'),
        (
            f"{X}.only",
            '[["up"]]',
            "a list of moves, from left, down, right, up, down-left, down-right, up-right, up-left, stay",
        ),
    ),
    "a move that the grid has not": (
        legend('X = { kind = "floor", only = ["stay"] }'),
        (f"{X}.only", '"stay"', "moves of this grid: left, down, right, up"),
    ),
    "a goal that never pays": (
        'rewards = "leaving"\nmap = "S.G"\n',
        (
            "map",
            'the agent never leaves cell "G", so it never gets the reward 1; use '
            'exit = true, reward = 0, or rewards = "entering"',
            "",
        ),
    ),
    "a cliff that never pays": (
        'rewards = "leaving"\n' + legend('X = { kind = "cliff", reward = -9, back = true }', "S.X"),
        (
            X,
            'the agent never leaves cell "X", so it never gets the reward -9; use '
            'exit = true, reward = 0, or rewards = "entering"',
            "",
        ),
    ),
}


@pytest.mark.parametrize("name", ONE_FAULT)
def test_gives_its_one_line(name, faults):
    content, expected = ONE_FAULT[name]
    assert faults(content) == [expected]


def test_all_faults_are_told_at_once_in_the_order_of_the_file(faults):
    found = faults("""map = "..?"
noise = 2
slippery = true
wind = [1]
time_limit = 0.5
[grid.legend]
A = { kind = "floor", jump = "B" }
"." = { kind = "floor", exit = 3 }
"C" = { kind = "wall", back = true }
""")
    assert [place for place, _, _ in found] == [
        "map",
        "noise",
        "slippery",
        "wind",
        "time_limit",
        'legend.".".exit',
        "legend.C.back",
    ]


def test_what_the_legend_says_of_characters_that_the_map_has_not_is_no_fault(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text('[grid]\nmap = "SG"\n[grid.legend]\nA = { kind = "floor", jump = "B" }\n')
    assert read_scenario(path).build(np.random.default_rng(0)).space.states == 2


def test_a_random_map_that_no_draw_opens_is_refused(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text("[grid]\nrandom = { rows = 60, columns = 60, holes = 0.9 }\n")
    scenario = read_scenario(path)
    with pytest.raises(ScenarioError) as error:
        scenario.build(np.random.default_rng(0))
    (fault,) = error.value.faults
    assert (fault.place, fault.expected) == ("grid.random.holes", "")
    assert fault.found == "none of 1,000 random maps had a path to the goal; use fewer holes than 0.9"


JUNK = st.sampled_from(
    [0, 3, -1, 0.5, math.nan, math.inf, True, "", "x", "SG", "leaving", [], [1], [[1]], ["up"], {}, {"a": {}}]
)
ENTRY = st.one_of(
    JUNK,
    st.dictionaries(
        st.sampled_from(["kind", "reward", "terminal", "exit", "jump", "back", "only"]),
        st.one_of(JUNK, st.sampled_from(["start", "goal", "floor", "wall", "cliff", "S", "G", "A"])),
    ),
)
RAW = st.fixed_dictionaries(
    {},
    optional={
        **dict.fromkeys(GridSection.model_fields, JUNK),
        "map": st.one_of(JUNK, st.text("SGHA.#\n", max_size=8)),
        "random": st.one_of(JUNK, st.just({"rows": 2, "columns": 2})),
        "legend": st.one_of(JUNK, st.dictionaries(st.sampled_from(["S", "G", "A", "AB", "."]), ENTRY)),
    },
)


@settings(deadline=None, max_examples=500)
@given(RAW)
def test_whatever_a_table_holds_it_has_faults_or_makes_a_world(raw):
    section, findings = parsed(GridSection, raw)
    findings += GridSection.connection_findings(raw)
    assert section is not None or findings
    if section is not None and not findings:
        assert section.build(np.random.default_rng(0)).space.states > 0
