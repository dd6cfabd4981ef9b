from __future__ import annotations

import pytest
from conftest import MakeApp
from seams import on_screen
from textual.actions import parse

from rl_tui.screen.frame.key_line import fitting
from rl_tui.screen.keys.action import Action, Place
from rl_tui.screen.keys.bindings import bindings_of
from rl_tui.screen.keys.registry import ACTIONS, actions_of
from rl_tui.screen.panels.catalogue import PANELS

PLAYGROUND_KEYS = {
    *("C", "R", "A", "full_stop", "comma", "H", "N", "space", "z", "T", "W", "Y", "S", "s", "e", "E"),
    *("I", "plus", "equals_sign", "minus", "underscore", "r", "v", "V", "a", "t", "i", "n", "1", "2"),
    *("3", "4", "p", "o", "f", "L", "number_sign", "m", "h", "b", "B", "g", "j", "u", "k", "K", "y", "D"),
    *("c", "l", "w", "x", "left_square_bracket", "right_square_bracket", "question_mark", "slash"),
    *("ctrl+p", "ctrl+c", "ctrl+l", "ctrl+z", "escape", "q"),
}


def usual(place: Place) -> list[Action]:
    """What can be done without a lesson."""
    return [each for each in actions_of(place) if not each.of_lesson]


def hints(place: Place, width: int, *without: str) -> list[str]:
    shown, _ = fitting([each for each in usual(place) if each.id not in without], width)
    return [" ".join(action.key_hint) for action in shown]


def line_width(place: Place, width: int) -> int:
    shown, gap = fitting(usual(place), width)
    return 1 + sum(len(" ".join(action.key_hint)) for action in shown) + gap * (len(shown) - 1)


def test_the_playground_has_exactly_its_keys() -> None:
    opening = {row.opened_by.key for row in PANELS if row.opened_by is not None}
    assert {
        key for action in actions_of(Place.PLAYGROUND) for key in action.keys
    } == PLAYGROUND_KEYS | opening


@pytest.mark.parametrize("place", [Place.CATALOGUE, Place.LESSONS, Place.PLAYGROUND])
def test_no_key_does_two_things(place: Place) -> None:
    keys = [key for action in actions_of(place) for key in action.keys]
    assert len(keys) == len(set(keys))


def test_every_action_has_a_name_of_its_own_and_says_what_it_does() -> None:
    assert len({action.id for action in ACTIONS}) == len(ACTIONS)
    assert all(action.help.endswith(".") and action.shown and action.label for action in ACTIONS)


@pytest.mark.parametrize("place", [Place.CATALOGUE, Place.LESSONS, Place.PLAYGROUND])
async def test_every_action_can_be_done_on_its_screen(make_app: MakeApp, place: Place) -> None:
    app = make_app("student" if place is Place.PLAYGROUND else None)
    async with on_screen(app) as pilot:
        if place is Place.LESSONS:
            await pilot.press("enter")
        for action in actions_of(place):
            target, method, _ = parse(action.command or action.id)
            if target == "app":
                assert hasattr(app, f"action_{method}"), action.id
            elif target:
                assert callable(getattr(getattr(app.screen, target), method)), action.id
            else:
                assert hasattr(app.screen, f"action_{method}"), action.id


def test_bindings_carry_id_description_and_tooltip() -> None:
    for binding in bindings_of(actions_of(Place.PLAYGROUND)):
        assert binding.id
        assert binding.description
        assert binding.tooltip


def test_the_key_line_drops_whole_entries_and_keeps_help() -> None:
    assert hints(Place.PLAYGROUND, 80, "run.evaluate", "lanes.next_lane", "lanes.one_lane") == [
        "space run",
        "s step",
        "e episode",
        "+ − speed",
        "b B back",
        "v layer",
        "d dissect",
        "? help",
    ]
    assert hints(Place.PLAYGROUND, 80) == [
        "space run",
        "s step",
        "e episode",
        "E I eval, improve",
        "+ − speed",
        "b B back",
        "? help",
    ]
    assert hints(Place.PLAYGROUND, 22) == ["space run", "? help"]
    assert hints(Place.PLAYGROUND, 1) == ["? help"]


@pytest.mark.parametrize("width", range(7, 200))
def test_the_key_line_fits(width: int) -> None:
    assert line_width(Place.PLAYGROUND, width) <= width
