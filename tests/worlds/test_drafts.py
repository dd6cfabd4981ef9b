"""Drafts of edited worlds."""

from __future__ import annotations

import tracemalloc

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rl_tui.common.errors import UserError
from rl_tui.common.streams import streams
from rl_tui.screen.playground.modes.brushes import paying_more
from rl_tui.worlds.editing.arms_draft import Draft
from rl_tui.worlds.editing.drafts import first_draft, refusal
from rl_tui.worlds.editing.edit import Edit, read_edits, written_edits
from rl_tui.worlds.editing.graph_draft import GraphDraft, chances_of, with_chance
from rl_tui.worlds.editing.grid_draft import GridDraft
from rl_tui.worlds.files.catalogue import find, scenarios
from rl_tui.worlds.files.scenario import Scenario, scenario_of
from rl_tui.worlds.mdp.digest import table_digest
from rl_tui.worlds.world import World

pytestmark = pytest.mark.unit

REFUSED = {"egg", "taxi", "blackjack", "blackjack-table", "cartpole", "mountain-car"}
SHIPPED = [each for each in scenarios() if each.id not in REFUSED]


def digest(world: World) -> str:
    assert world.mdp is not None
    return table_digest(world.mdp)


def edited(draft: Draft, text: str) -> Draft:
    for edit in read_edits(text):
        draft = draft.edited(edit)
    return draft


def map_of(draft: Draft) -> GridDraft:
    assert isinstance(draft, GridDraft)
    return draft


def lines(text: str) -> Draft:
    return first_draft(scenario_of(f"[grid]\nmap = '''\n{text}'''\n", find("maze").source), 0)


@pytest.mark.parametrize("scenario", SHIPPED, ids=lambda each: each.id)
def test_the_first_draft_is_the_world_bit_for_bit(scenario: Scenario) -> None:
    world, drawn = scenario.build(streams(3).world), first_draft(scenario, 3).build()
    assert digest(drawn) == digest(world)
    assert drawn.drawing == world.drawing


@pytest.mark.parametrize("name", sorted(REFUSED))
def test_what_cannot_be_drawn_says_why(name: str) -> None:
    assert "cannot be edited" in refusal(find(name), 0)


def test_a_reward_of_its_own_has_a_character_until_no_cell_has_it() -> None:
    draft = edited(lines("S.G\n...\n"), "world.reward[1,0:2]=-2")
    assert map_of(draft).lines == ("S.G", "aa.")
    assert map_of(draft).legend["a"].pays == -2.0
    assert "a" not in map_of(edited(draft, "world.cell[1,0:2]=.")).legend


def test_a_rectangle_that_pays_more_is_an_edit_for_each_stretch_of_a_row() -> None:
    draft = map_of(lines("S..\n.#.\n..G\n"))
    cells = [(row, column) for row in range(3) for column in range(3)]
    written = written_edits(paying_more(draft, cells, 1.0)).replace("world.reward", "").split(";")
    assert written == ["[0,0:3]=1.0", "[1,0]=1.0", "[1,2]=1.0", "[2,0:2]=1.0", "[2,2]=2.0"]


def test_lines_take_their_wind_with_them() -> None:
    draft = edited(first_draft(find("windy"), 0), "world.columns=+1@3;world.columns=-1@0")
    assert draft.table["wind"] == [0, 0, 0, 1, 1, 1, 2, 2, 1, 0]


def test_what_is_no_valid_mdp_says_why() -> None:
    draft = edited(lines("S.G\n"), "world.cell[0,0]=.")
    assert [each.found.partition(";")[0] for each in draft.findings] == ["the map has no start"]
    with pytest.raises(UserError, match="the map has no start"):
        draft.build()


@pytest.mark.parametrize(
    "text",
    [
        *("world.cell[9,0]=#", "world.cell[0]=#", "world.rows=+1@9", "world.rows=-2@0"),
        *("world.reward[0,0]=much", "world.depth=1", "world.wind=5", "world.wind=[1]"),
    ],
)
def test_an_edit_that_cannot_be_done_is_told_in_a_line(text: str) -> None:
    with pytest.raises(UserError) as told:
        edited(lines("S.G\n...\n"), text)
    assert "\n" not in str(told.value)


@pytest.mark.parametrize("place", ["5", "null", '"x"', "[1]", "[true,0]", "[0.5,0]"])
def test_a_state_stands_at_a_column_and_a_row(place: str) -> None:
    with pytest.raises(UserError, match="expected \\[column, row\\]"):
        edited(first_draft(find("student"), 0), f"world.place[Pass]={place}")


HUGE = "1" + "0" * 400


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("student", "world.place[Pass]=5;world.place[Class]=[1,1]"),
        ("student", 'world.place[Pass]=[[1],[2]];world.transition[Pass,x]={"to":"New"}'),
        ("student", 'world.transition[Class,x]={"action":[1],"to":"Class","reward":0}'),
        ("student", 'world.transition[Class,x]={"state":"Pass","to":"Class","reward":0}'),
        ("student", f'world.transition[Class,x]={{"to":{{"Pass":{HUGE}}}}}'),
        ("student", 'world.transition["a\\u001b[31m","b\\n"]=null'),
        ("student", 'world.transition["a\\u001b[31m"]=null'),
        ("student", f"world.transition[Class,{'x' * 9_000}]=null"),
        ("windy", "world.wind=5;world.wind[0]=1"),
        ("windy", "world.wind=[1];world.wind[8]=1"),
        ("windy", "world.wind=true;world.columns=+1@0"),
        ("windy", f"world.reward[0,0]={HUGE}"),
        ("windy", 'world.legend["\\u001b"]={"kind":"goal"}'),
        ("windy", f"world.legend[x]={'[' * 500}{']' * 500}"),
        ("windy", f"world.time_limit={HUGE}"),
        ("bandit", f"world.arm[0]={HUGE}"),
    ],
)
def test_what_no_world_can_have_is_refused_in_a_short_line_that_is_safe_to_print(
    name: str, text: str
) -> None:
    with pytest.raises(UserError) as told:
        edited(first_draft(find(name), 0), text).build()
    assert str(told.value).isprintable()
    assert len(str(told.value)) < 400


@pytest.mark.parametrize("depth", [400, 5_000])
def test_json_of_any_depth_is_refused_in_words(depth: int) -> None:
    with pytest.raises((UserError, ValueError), match="expected"):
        edited(first_draft(find("student"), 0), f"world.start={'[' * depth}{']' * depth}").build()


@pytest.mark.exhaustive("draws on a large map")
def test_a_stroke_on_a_large_map_that_can_be_undone_is_small() -> None:
    side, strokes = 300, 30
    draft = lines(f"S{'.' * (side - 2)}G\n" + f"{'.' * side}\n" * (side - 1))
    done = [edited(draft, "world.cell[1,1]=#")]
    tracemalloc.start()
    try:
        for number in range(strokes):
            done.append(edited(done[-1], f"world.cell[{2 + number},1]=#"))
            assert done[-1].section is not None
        kept, _ = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert kept < strokes * side * side / 4, "a section holds the whole map"


def test_new_states_are_drawn_next_to_the_one_that_leads_there_each_at_a_place_of_its_own() -> None:
    to = ",".join(f'"{number}":0.125' for number in range(8))
    draft = edited(first_draft(find("student"), 0), f'world.transition[Class,x]={{"to":{{{to}}},"reward":0}}')
    places = [tuple(at) for at in draft.table["place"].values()]
    assert len(set(places)) == len(places) == len(draft.build().space.state_names)


@pytest.mark.parametrize("text", ["cell[1,2]=#", "world.cell[1,2]", "world.cell[1,2]=#x", "world.cell[,]=#"])
def test_what_is_no_edit_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match="world"):
        read_edits(text)


@given(
    st.lists(
        st.builds(
            Edit,
            st.just("cell"),
            st.tuples(
                st.from_regex(r"[0-9]{1,3}(:[0-9]{1,3})?", fullmatch=True), st.text(min_size=1, max_size=5)
            ),
            st.characters(codec="utf-8"),
        ),
        min_size=1,
        max_size=4,
    )
)
@settings(max_examples=50)
def test_what_was_written_is_read_again(edits: list[Edit]) -> None:
    assert list(read_edits(written_edits(edits))) == edits


def test_states_come_and_go_with_what_leads_to_them() -> None:
    draft = edited(first_draft(find("student"), 0), 'world.transition[Phone,call]={"to":"Friend","reward":1}')
    assert isinstance(draft, GraphDraft)
    assert "Friend" in draft.table["place"]
    assert "Friend" in draft.build().space.state_names
    without = edited(draft, "world.transition[Phone,call]=null")
    assert "Friend" not in without.table["place"]


def test_a_state_that_goes_is_no_start_any_more() -> None:
    draft = first_draft(find("student"), 0)
    both = edited(draft, 'world.start={"Class":0.25,"Phone":0.75}')
    assert edited(both, "world.state[Class]=null").table["start"] == {"Phone": 1.0}
    alone = edited(draft, "world.state[Class]=null")
    assert "start" not in alone.table
    assert [(each.location, each.found) for each in alone.findings] == [(("start",), "nothing")]


@given(st.floats(0, 1), st.lists(st.floats(0.01, 1), min_size=1, max_size=4))
def test_the_others_share_what_is_left_as_they_shared_it(chance: float, shares: list[float]) -> None:
    total = sum(shares)
    to = {str(number): share / total for number, share in enumerate(shares)}
    new = chances_of(with_chance({"to": {**to, "x": 0.0}}, "x", chance))
    assert new["x"] == chance
    assert sum(new.values()) == pytest.approx(1.0, abs=1e-12)
    for name, share in to.items():
        assert new[name] == pytest.approx(share * (1 - chance), abs=1e-12)
