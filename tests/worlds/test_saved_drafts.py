"""The files of edited worlds."""

from __future__ import annotations

from difflib import unified_diff
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rl_tui.common.errors import UserError
from rl_tui.worlds.editing.arms_draft import Draft, UnfinishedError
from rl_tui.worlds.editing.drafts import first_draft, refusal
from rl_tui.worlds.editing.edit import read_edits
from rl_tui.worlds.editing.saving import saved_text
from rl_tui.worlds.files.catalogue import scenarios
from rl_tui.worlds.files.scenario import Scenario, scenario_of
from rl_tui.worlds.mdp.digest import table_digest

pytestmark = pytest.mark.unit

SEED = 3
DRAWN = [scenario for scenario in scenarios() if not refusal(scenario, SEED)]
WRITTEN_OUT = [each for each in DRAWN if saved_text(each.text, first_draft(each, SEED)) == each.text]

HEAD = 'title = "Mine" # not yours\n\n'
GRIDS = {
    "block": HEAD
    + "[grid] # a world\n# look\nmap = '''\nS..\n.#G\n''' # so\nnoise = 0.1\n\n[defaults]\nalpha = 1\n",
    "double quotes": HEAD + '[grid]\nmap = """\nS..\n.#G"""\n\n[grid.legend]\nG = { kind = "goal" }\n# end\n',
    "one line": HEAD + '[grid]\nmap = "S..\\n.#G\\n"\nlegend = { G = { kind = "goal", reward = 2 } }\n',
    "literal": HEAD + "[grid]\nmap = 'S..G'",
    "dotted": HEAD + "[grid]\nlegend.G.kind = 'goal'\nmap = '''\nS..\n.#G\n'''\n",
    "apart": "[grid]\nmap = '''\nS..\n.#G\n'''\n[defaults]\nalpha = 1\n[grid.legend.G]\nkind = 'goal' # g\n",
    "windy": HEAD
    + "[grid]\nmap = '''\nS..\n..G\n'''\nwind = [\n  0, # left\n  1,\n  0,\n]\nwind_rows=[0,1]\n",
}
ODD = {
    "tabs": HEAD + "[grid]\n\tmap\t=\t'''\nS..\n.#G\n'''\t# why\n\tnoise\t=\t0.1\n",
    "all in a line": HEAD + "grid = { map = 'S..G', noise = 0.1 } # one\n",
    "a line of tables": HEAD
    + 'grid = { map = "S..\\n.#G", legend = { G = { kind = "goal", reward = 2 } } }\n',
    "continued": HEAD + '[grid]\nmap = """\\\n  S..\\n\\\n  .#G\\n"""\n',
    "blanks behind": HEAD + "[grid]\nmap = '''\nS.. \n.#G \n'''\n",
    "blank lines": HEAD + "[grid]\nmap = '''\n\n\nS..\n.#G\n\n'''\n",
    "dotted from the root": HEAD
    + "grid.map = '''\nS..\n.#G\n'''\ngrid.noise = 0.1\ngrid.legend.G.kind = 'goal'\n",
    "legend first": "[grid.legend]\nG = { kind = 'goal', reward = 3 }\n[defaults]\nalpha = 0.2 # slow\n"
    "[grid]\nmap = '''\nS..\n.#G\n'''\n",
    "quoted keys": HEAD
    + """[grid]\n"map" = '''\nS..\n.#G\n'''\n[grid."legend"]\n"G" = { kind = "goal" }\n""",
    "blanks in heads": HEAD + "[ grid ]\nmap='''\nS..\n.#G\n'''\n[ grid . legend ]\nG={kind='goal'}\n",
    "mixed line ends": "[grid]\r\nmap = '''\nS..\n.#G\n'''\n[defaults] # end\r\nalpha = 1",
}
"""Files in the style of people and other programs."""
GRIDS |= ODD
CHAIN = """[mdp]
start = "A" # here
# first
[[mdp.transition]]
state = "A"
action = "go" # on
reward = 1
to = { B = 0.5, "the end" = 0.5 }

# second
[[mdp.transition]]
state = "A"
action = "stay"
reward = 0.0
to = "A"

# third
[[mdp.transition]]
state = "B"
action = "go"
reward = 2.0
[mdp.transition.to]
A = 0.25
"the end" = 0.75 # enough

# last words
[defaults]
alpha = 0.5
"""
GRAPHS = {
    "tables": CHAIN,
    "inline": '[mdp]\nstart = "A"\nplace = { A = [0, 0], B = [1, 0] }\ntransition = [\n'
    '  { state = "A", action = "go", reward = 1, to = "B" }, # one\n'
    '  { state = "A", action = "stay", reward = 1, to = "A" },\n]\n',
}
ARMS = {
    "means": "[bandit]\nmeans = [\n  0.5, # good\n  1,\n]\nstd = 1.0 # wide\nbudget = 10\n",
    "drawn": "[bandit]\narms = 3 # few\nmean = { normal = [0.0, 1.0] }\nbudget = 10\n",
}


def read(text: str) -> Scenario:
    return scenario_of(text, Path("mine.toml"))


def drawn(text: str, edits: str = "") -> Draft:
    draft = first_draft(read(text), SEED)
    for edit in read_edits(edits) if edits else ():
        draft = draft.edited(edit)
    return draft


def changed_lines(old: str, new: str) -> tuple[list[str], list[str]]:
    lines = list(unified_diff(old.splitlines(), new.splitlines(), n=0, lineterm=""))[2:]
    return [each[1:] for each in lines if each[0] == "-"], [each[1:] for each in lines if each[0] == "+"]


def comments(text: str) -> list[str]:
    return [line.partition("#")[2] for line in text.splitlines() if "# " in line]


def is_same_world(text: str, draft: Draft) -> bool:
    read_back, built = first_draft(read(text), 0).build().mdp, draft.build().mdp
    assert read_back is not None
    assert built is not None
    return table_digest(read_back) == table_digest(built)


@pytest.mark.parametrize("scenario", DRAWN, ids=lambda each: each.id)
def test_a_shipped_scenario_saved_is_the_same_world_and_says_the_rest_as_before(scenario: Scenario) -> None:
    draft = first_draft(scenario, SEED)
    text = saved_text(scenario.text, draft)
    assert is_same_world(text, draft)
    saved = read(text)
    assert (saved.title, saved.notes, saved.defaults) == (scenario.title, scenario.notes, scenario.defaults)
    assert saved_text(text, draft) == text


def test_most_worlds_that_nobody_changed_are_their_own_text() -> None:
    drawn_anew = {each.id for each in DRAWN if each not in WRITTEN_OUT}
    by_gymnasium = {each.id for each in DRAWN if each.kind == "gymnasium"}
    assert drawn_anew - by_gymnasium == {"frozenlake-random", "bandit", "bandit-bernoulli"}


@pytest.mark.parametrize(
    "scenario", [each for each in DRAWN if first_draft(each, SEED).kind == "grid"], ids=lambda each: each.id
)
def test_a_cell_is_one_line(scenario: Scenario) -> None:
    draft = first_draft(scenario, SEED)
    before = saved_text(scenario.text, draft)
    lines = draft.table["map"].split("\n")
    row, column = next((row, line.index(".")) for row, line in enumerate(lines) if "." in line)
    (edit,) = read_edits(f"world.cell[{row},{column}]=H")
    gone, new = changed_lines(before, saved_text(scenario.text, draft.edited(edit)))
    assert gone == [lines[row]]
    assert new == [f"{lines[row][:column]}H{lines[row][column + 1 :]}"]


@pytest.mark.parametrize("text", GRIDS.values(), ids=GRIDS)
def test_a_cell_is_changed_in_the_style_of_the_file(text: str) -> None:
    draft = drawn(text, "world.cell[0,1]=H")
    new = saved_text(text, draft)
    if text != ODD["continued"]:  # a string continued after a backslash becomes a plain one
        assert [len(each) for each in changed_lines(text, new)] == [1, 1]
    assert comments(new) == comments(text)
    assert is_same_world(new, draft)
    for ending in ("\r\n", "\n"):
        if "\r\n" in text:
            continue
        foreign = text.replace("\n", ending)
        assert saved_text(foreign, drawn(foreign, "world.cell[0,1]=H")) == new.replace("\n", ending)


def test_a_reward_is_the_line_of_its_cell_and_one_of_the_legend() -> None:
    text = GRIDS["double quotes"]
    gone, new = changed_lines(text, saved_text(text, drawn(text, "world.reward[0,1]=2.5")))
    assert gone == ["S.."]
    assert new == ["Sa.", 'a = { kind = "floor", reward = 2.5 }']


def test_a_legend_that_was_not_there_comes_below_its_world() -> None:
    text = GRIDS["block"]
    gone, new = changed_lines(text, saved_text(text, drawn(text, "world.reward[0,1]=2.5")))
    assert gone == ["S.."]
    assert new == ["Sa.", "[grid.legend]", 'a = { kind = "floor", reward = 2.5 }', ""]


@pytest.mark.parametrize(
    ("edits", "gone", "new"),
    [
        ('world.transition[A,stay]={"to":"A","reward":3}', ["reward = 0.0"], ["reward = 3.0"]),
        (
            'world.transition[A,go]={"to":{"B":0.25,"the end":0.75},"reward":1}',
            ['to = { B = 0.5, "the end" = 0.5 }'],
            ['to = { B = 0.25, "the end" = 0.75 }'],
        ),
        (
            'world.transition[B,go]={"to":{"A":0.5,"the end":0.5},"reward":2}',
            ["A = 0.25", '"the end" = 0.75 # enough'],
            ["A = 0.5", '"the end" = 0.5 # enough'],
        ),
        (
            "world.transition[A,stay]=null",
            ["[[mdp.transition]]", 'state = "A"', 'action = "stay"', "reward = 0.0", 'to = "A"', ""],
            [],
        ),
        (
            'world.transition[A,jump]={"to":"B","reward":0.5}',
            [],
            ["[[mdp.transition]]", 'state = "A"', 'action = "jump"', 'to = "B"', "reward = 0.5", ""],
        ),
    ],
)
def test_of_a_graph_only_the_pair_changes_that_was_changed(
    edits: str, gone: list[str], new: list[str]
) -> None:
    draft = drawn(CHAIN, edits)
    text = saved_text(CHAIN, draft)
    before, after = changed_lines(CHAIN, text)
    assert sorted(before) == sorted(gone)
    assert sorted(after) == sorted(new)
    assert comments(text) == comments(CHAIN)
    assert is_same_world(text, draft)


@pytest.mark.parametrize(
    ("text", "edits", "gone", "new"),
    [
        (ARMS["means"], "world.arm[1]=0.25", ["  1,"], ["  0.25,"]),
        (ARMS["means"], "world.std=2", ["std = 1.0 # wide"], ["std = 2.0 # wide"]),
        (GRIDS["windy"], "world.wind[1]=2", ["  1,"], ["  2,"]),
    ],
)
def test_a_number_is_one_line(text: str, edits: str, gone: list[str], new: list[str]) -> None:
    assert changed_lines(text, saved_text(text, drawn(text, edits))) == (gone, new)


def test_drawn_arms_stand_where_their_chances_stood() -> None:
    text = ARMS["drawn"]
    draft = drawn(text)
    gone, new = changed_lines(text, saved_text(text, draft))
    assert gone == ["arms = 3 # few", "mean = { normal = [0.0, 1.0] }"]
    assert new == [f"means = {draft.table['means']} # few"]


def test_a_world_without_a_file_gets_one() -> None:
    draft = drawn(GRIDS["block"])
    assert is_same_world(saved_text('title = "New"\n', draft), draft)
    assert is_same_world(saved_text("", drawn(CHAIN)), drawn(CHAIN))


def test_what_is_no_world_yet_is_not_saved() -> None:
    with pytest.raises(UnfinishedError):
        saved_text(GRIDS["block"], drawn(GRIDS["block"], "world.cell[0,0]=."))


def test_characters_that_need_quotes_are_written_so_that_they_can_be_read() -> None:
    text = GRIDS["block"]
    edits = "".join(
        f'world.legend["{name}"]={{"kind":"floor","reward":{number}}};world.cell[0,{number}]={character};'
        for number, (name, character) in enumerate([("'", "'"), ('\\"', '"')], 1)
    )
    draft = drawn(text, edits[:-1])
    assert is_same_world(saved_text(text, draft), draft)


def test_a_file_that_does_not_end_with_a_line_end_goes_on_not_to() -> None:
    text = f"{GRIDS['literal']}\n[defaults]\nalpha = 1"
    assert changed_lines(text, saved_text(text, drawn(text, "world.cell[0,1]=H"))) == (
        ["map = 'S..G'"],
        ["map = 'SH.G'"],
    )


@settings(max_examples=40, deadline=None)
@given(data=st.data())
def test_of_a_shipped_map_of_which_only_cells_changed_only_their_lines_do(data: st.DataObject) -> None:
    scenario = data.draw(st.sampled_from([each for each in WRITTEN_OUT if each.kind == "grid"]))
    draft = first_draft(scenario, SEED)
    lines = draft.table["map"].strip("\n").split("\n")
    places = st.tuples(st.integers(0, len(lines) - 1), st.integers(0, len(lines[0]) - 1))
    for row, column in data.draw(st.lists(places, min_size=1, max_size=6)):
        (edit,) = read_edits(f"world.cell[{row},{column}]={data.draw(st.sampled_from('.#GH'))}")
        draft = draft.edited(edit)
    if draft.findings:
        return
    text = saved_text(scenario.text, draft)
    assert is_same_world(text, draft)
    assert saved_text(text, draft) == text
    after = draft.table["map"].strip("\n").split("\n")
    beside = zip(scenario.text.split("\n"), text.split("\n"), strict=True)
    assert [pair for pair in beside if pair[0] != pair[1]] == [
        pair for pair in zip(lines, after, strict=True) if pair[0] != pair[1]
    ]


ROWS, COLUMNS = st.integers(0, 1), st.integers(0, 2)
NUMBERS = st.sampled_from(["0.1", "-2", "7", "1e-7", "0.30000000000000004"])
GRID_EDITS = st.one_of(
    st.builds("world.cell[{},{}]={}".format, ROWS, COLUMNS, st.sampled_from(".#GHS' C")),
    st.builds("world.reward[{},{}]={}".format, ROWS, COLUMNS, NUMBERS),
    st.builds("world.rows={}1@{}".format, st.sampled_from("+-"), ROWS),
    st.builds("world.columns={}1@{}".format, st.sampled_from("+-"), COLUMNS),
    st.builds("world.wind[{}]={}".format, COLUMNS, st.integers(0, 2)),
    st.builds("world.{}={}".format, st.sampled_from(["noise", "step_reward", "time_limit"]), NUMBERS),
)
STATES = st.sampled_from(["A", "B", "the end", "C # d"])
OUTCOMES = st.one_of(
    st.builds('"{}"'.format, STATES),
    st.builds('{{"{}":0.25,"{}":{{"p":0.75,"reward":4}}}}'.format, STATES, STATES),
)
ACTIONS = st.sampled_from(["go", "stay", "jump"])
GRAPH_EDITS = st.one_of(
    st.builds('world.transition["{}",{}]={{"to":{},"reward":{}}}'.format, STATES, ACTIONS, OUTCOMES, NUMBERS),
    st.builds('world.transition["{}",{}]=null'.format, STATES, ACTIONS),
    st.builds('world.place["{}"]=[{},0]'.format, STATES, st.integers(2, 5)),
    st.builds('world.start="{}"'.format, STATES),
)
ARM_EDITS = st.one_of(
    st.builds("world.arm[{}]={}".format, COLUMNS, NUMBERS),
    st.builds("world.arms={}1@{}".format, st.sampled_from("+-"), COLUMNS),
    st.builds("world.drift={}".format, NUMBERS),
)


SHIPPED = {"grid": GRID_EDITS, "mdp": GRAPH_EDITS, "bandit": ARM_EDITS}


@st.composite
def shipped_cases(draw: st.DrawFn) -> tuple[str, list[str]]:
    scenario = draw(st.sampled_from(DRAWN))
    return scenario.text, draw(st.lists(SHIPPED[first_draft(scenario, SEED).kind], max_size=5))


@settings(max_examples=60, deadline=None)
@given(
    st.one_of(
        shipped_cases(),
        st.tuples(st.sampled_from([*GRIDS.values()]), st.lists(GRID_EDITS, max_size=8)),
        st.tuples(st.sampled_from([*GRAPHS.values()]), st.lists(GRAPH_EDITS, max_size=8)),
        st.tuples(st.sampled_from([*ARMS.values()]), st.lists(ARM_EDITS, max_size=8)),
    )
)
def test_whatever_was_drawn_reads_back_to_the_bit(case: tuple[str, list[str]]) -> None:
    text, edits = case
    draft = drawn(text)
    for each in edits:
        for edit in read_edits(each):
            try:
                draft = draft.edited(edit)
            except UserError:
                continue
        if not draft.findings:
            text = saved_text(text, draft)
            assert is_same_world(text, draft)
            assert saved_text(text, draft) == text
