from __future__ import annotations

from dataclasses import replace

from sample_worlds import LEFT, RIGHT, UP, bandit_world
from samples import bandit, lake, look, student
from snapshots import changed

from rl_tui.live.last_step.step_report import story_of
from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.panels.last_step.last_step import last_step_lines
from rl_tui.screen.panels.last_step.words import words_of
from rl_tui.screen.playground.modes import action_keys
from rl_tui.screen.playground.modes.action_keys import acts_in, has_directions
from rl_tui.screen.playground.modes.manual import prompts, title

GLYPHS = look().glyphs
STUDY, PHONE, SCROLL, QUIT, SLEEP = range(5)


def ended(snapshot: Snapshot, state: int, start: int = 0) -> Snapshot:
    return changed(snapshot, state=state, episode_step=0, step_from=start)


def digit_keys(snapshot: Snapshot) -> dict[str, int]:
    return action_keys.digit_keys(snapshot.world, acts_in(snapshot))


def legal_actions(snapshot: Snapshot) -> tuple[int, ...]:
    return action_keys.legal_actions(snapshot.world, acts_in(snapshot))


def action_towards(snapshot: Snapshot, step: tuple[int, int]) -> int | None:
    return action_keys.action_towards(snapshot.world, acts_in(snapshot), step)


def acting_keys(snapshot: Snapshot) -> str:
    return action_keys.acting_keys(snapshot.world, acts_in(snapshot))


def test_digits_take_the_legal_actions_in_the_order_in_which_they_are_shown() -> None:
    assert digit_keys(lake()) == {"1": UP, "2": RIGHT, "3": 1, "4": LEFT}
    assert digit_keys(student(state=0)) == {"1": STUDY, "2": PHONE}
    assert digit_keys(student(state=1)) == {"1": SCROLL, "2": QUIT}
    assert digit_keys(student(state=2)) == {"1": SLEEP}


def test_arms_that_are_called_by_digits_have_those_keys() -> None:
    assert digit_keys(bandit(5)) == {str(arm): arm for arm in range(10)}
    few = changed(bandit(5), world=bandit_world(means=(0.0, 1.0, 2.0)), state=0)
    assert digit_keys(few) == {"0": 0, "1": 1, "2": 2}
    many = changed(bandit(5), world=bandit_world(means=tuple(map(float, range(12)))))
    assert digit_keys(many) == {**{str(arm + 1): arm for arm in range(9)}, "0": 9}


def test_after_an_episode_the_start_counts() -> None:
    assert legal_actions(ended(student(), 3)) == (STUDY, PHONE)
    assert legal_actions(ended(lake(), 5)) == (3, 2, 1, 0)
    assert legal_actions(ended(student(), 3, start=1)) == (SCROLL, QUIT)


def test_arrows_are_directions_on_a_grid_only() -> None:
    assert action_towards(lake(), (0, 1)) == RIGHT
    assert action_towards(lake(), (-1, 0)) == UP
    assert action_towards(lake(), (-1, 1)) is None
    assert action_towards(student(), (0, 1)) is None
    assert [has_directions(each.world) for each in (lake(), student(), bandit(5))] == [True, False, False]


def test_the_keys_are_told() -> None:
    assert acting_keys(lake()) == "arrows or 1…4"
    assert acting_keys(student(state=0)) == "1 or 2"
    assert acting_keys(student(state=2)) == "1"
    assert acting_keys(bandit(5)) == "0…9"
    assert prompts(student(state=0), GLYPHS)[0] == "1 study  2 check phone · y: hand back"
    assert prompts(lake(), GLYPHS)[:3] == (
        "1 ↑  2 →  3 ↓  4 ← · y: hand back",
        "1↑ 2→ 3↓ 4← · y: hand back",
        "1 ↑  2 →  3 ↓  4 ←",
    )
    assert "1 study 2 chec…" in prompts(student(state=0), GLYPHS)
    assert prompts(bandit(5), GLYPHS)[0] == "0…9: act · y: hand back"


def test_after_an_episode_the_title_says_where_the_next_one_starts() -> None:
    assert title(lake(), GLYPHS) == ("You are the agent",)
    assert title(ended(student(), 3), GLYPHS)[0] == "You are the agent · starts at Class"
    assert title(bandit(5), GLYPHS) == ("You are the agent",)


def test_a_step_by_hand_says_who_chose_it() -> None:
    snapshot = lake()
    assert snapshot.counters.last_step is not None
    by_hand = replace(snapshot.counters.last_step, by_hand=True)
    shown = changed(snapshot, last_step=by_hand)
    story = story_of(shown)
    assert story is not None
    assert words_of(story, GLYPHS).choices == ("you chose it", "by you")
    (line,) = last_step_lines(shown, look(), 120, 1)
    text = "".join(piece.text for piece in line)
    assert "by you" in text
    assert "greedy" not in text
