"""The table of actions."""

from __future__ import annotations

import re
from collections import Counter
from pathlib import Path
from types import UnionType
from typing import get_args, get_origin, get_type_hints

import pytest

import rl_tui.screen
from rl_tui.screen.frame.menu_strip import LEADING_ON
from rl_tui.screen.keys.action import MENUS, Action, Place
from rl_tui.screen.keys.bindings import stopping_keys
from rl_tui.screen.keys.playground_keys import DRAW_PATH
from rl_tui.screen.keys.registry import ACTIONS, actions_of
from rl_tui.screen.kit.bindings import RowList
from rl_tui.screen.playground.actions.session import LEAVING_KEYS
from rl_tui.screen.playground.modes.editing import WorldEditing

PLACES = [Place.CATALOGUE, Place.LESSONS, Place.PLAYGROUND]
MOVING = {*("left", "right", "up", "down", "j", "k", "home", "end", "escape")}
SAME = {"equals_sign", "underscore", "ctrl+p"}  # other ways to press +, − and /
EMERGENCIES = {"ctrl+c", "ctrl+l", "ctrl+z"}
SINGLE_KEYS = {
    *("space", "s", "e", "b", "B", "plus", "minus", "u", "1", "2", "3", "4"),
    *("v", "d", "f", "y", *MENUS, "slash", "question_mark", "q"),
}
LESSON_KEYS = {"enter", "pagedown", "pageup", "h"}
ACTING_LETTERS = set("sebBvfy")
OF_ALL_LISTS = set("jkq?/")  # in a menu these move, close, show keys and find
LONGEST_HELP = 125
LONGEST_IN_MENU = 76  # characters that fit in a menu
PAIRS = {("b", "B")}


def usual(place: Place) -> list[Action]:
    return [each for each in actions_of(place) if not each.of_lesson and not each.of_program]


def single(actions: list[Action]) -> dict[str, Action]:
    return {key: action for action in actions if not action.menu for key in action.key.split(",")}


# Keys


def test_the_playground_has_25_single_keys_and_all_else_is_in_a_menu() -> None:
    assert single(usual(Place.PLAYGROUND)).keys() - MOVING - SAME - EMERGENCIES == SINGLE_KEYS
    assert len(SINGLE_KEYS) == 25
    of_lesson = [each for each in actions_of(Place.PLAYGROUND) if each.of_lesson]
    assert single(of_lesson).keys() == LESSON_KEYS
    assert {action.menu for action in ACTIONS if action.menu} == set(MENUS)


def test_every_action_is_within_two_strokes_and_no_row_has_the_letter_of_another() -> None:
    paths = Counter(action.key for action in ACTIONS if action.menu)
    assert len(paths) >= 40
    assert set(paths.values()) == {1}
    assert all(re.fullmatch(r"[awtcmr] .", path) for path in paths)


@pytest.mark.parametrize("place", PLACES)
def test_no_key_does_two_things(place: Place) -> None:
    keys = Counter(key for action in actions_of(place) for key in action.keys)
    assert [key for key, count in keys.items() if count > 1] == []


def test_seven_letters_act_at_once_and_all_others_open_something() -> None:
    opens = ("menus.open", "board.toggle", "view.enter_world")
    letters = {
        key
        for key, action in single(usual(Place.PLAYGROUND)).items()
        if len(key) == 1
        and key.isalpha()
        and not (action.command or action.id).startswith(opens)
        and not action.label.endswith("…")
    }
    assert letters - {"q"} == ACTING_LETTERS


def test_a_capital_letter_means_what_its_small_letter_means() -> None:
    keys = single(usual(Place.PLAYGROUND))
    assert {(key.lower(), key) for key in keys if len(key) == 1 and key.isupper()} == PAIRS


def test_drawing_takes_no_small_letter_that_means_something_else_but_its_menu() -> None:
    taken = {key for key in WorldEditing.keys if key.islower() and len(key) == 1}
    assert taken & single(usual(Place.PLAYGROUND)).keys() <= {"w"}


@pytest.mark.parametrize("place", PLACES)
def test_the_keys_that_people_expect_are_everywhere(place: Place) -> None:
    does = {key: action.id for key, action in single(usual(place)).items()}
    assert (does["question_mark"], does["q"]) == ("help", "quit")
    assert does["slash"] == ("filter" if place is Place.CATALOGUE else "find")
    assert not {"tab", "pageup", "pagedown"} & does.keys(), "these go through panels and pages"
    assert does.keys() >= EMERGENCIES


def test_j_and_k_move_in_lists_as_they_do_in_menus_and_into_the_world() -> None:
    of_lists = {key for binding in RowList.BINDINGS for key in binding.key.split(",")}  # type: ignore[union-attr]
    assert of_lists == {"j", "k"}
    does = {key: action.id for key, action in single(usual(Place.PLAYGROUND)).items()}
    assert {does[key] for key in ("j", "k", "up", "down")} == {"view.enter_world"}


# Menus and words


@pytest.mark.parametrize("menu", MENUS)
def test_a_menu_is_small_and_its_rows_are_short(menu: str) -> None:
    rows = [action for action in ACTIONS if action.menu == menu]
    assert len([row for row in rows if not row.of_program]) <= 10
    assert not OF_ALL_LISTS & {row.letter for row in rows}
    assert all(len(row.help) <= LONGEST_IN_MENU for row in rows)


def test_every_action_has_a_name_of_its_own_and_says_what_it_does() -> None:
    assert len({action.id for action in ACTIONS}) == len(ACTIONS)
    assert all(action.help.endswith((".", "…")) and action.shown for action in ACTIONS)
    assert all(len(action.help) <= LONGEST_HELP for action in ACTIONS)
    assert all(1 <= len(action.label.split()) <= 2 for action in ACTIONS)


def test_every_field_of_a_row_has_the_type_of_its_field() -> None:
    for name, hint in get_type_hints(Action).items():
        kinds = get_args(hint) if isinstance(hint, UnionType) else (hint,)
        types = tuple(get_origin(kind) or kind for kind in kinds)
        for action in ACTIONS:
            assert isinstance(getattr(action, name), types), (action.id, name)


def test_what_is_named_outside_of_the_table_is_in_it() -> None:
    known = {name for action in ACTIONS for name in (action.id, action.command)}
    targets = "|".join({name.partition(".")[0] for name in known if "." in name} - {"app"})
    command = re.compile(rf"""["']((?:{targets})\.[a-z_]+(?:\([^)]*\))?)["']""")
    lines = [
        line
        for path in Path(rl_tui.screen.__file__).parent.rglob("*.py")
        for line in path.read_text(encoding="utf-8").splitlines()
        if not re.search(r"inding\(|id=|\{", line)
    ]
    named = {name for line in lines for name in command.findall(line)}
    assert "run.reset" in named
    assert named <= known
    assert set(LEADING_ON.values()) <= known
    assert " ".join(DRAW_PATH) == next(each.key for each in ACTIONS if each.id == "editing.toggle")
    assert set(LEAVING_KEYS) <= stopping_keys()
