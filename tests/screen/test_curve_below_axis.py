"""What of the return curve lies below its axis."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from drawn_curves import WIDE, drawn
from rich.style import Style
from samples import bandit, lake, look, student
from snapshots import changed

from rl_tui.live.program_view import ProgramView
from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.results import Curve, Marks
from rl_tui.screen.draw.scale import Scale
from rl_tui.screen.panels.curve.curve import ReturnCurve
from rl_tui.screen.panels.curve.words import BELOW_AXIS
from rl_tui.screen.theme.glyphs import UNICODE
from rl_tui.screen.theme.look import Look


def drawn_with(snapshot: Snapshot, shown_with: Look) -> list[str]:
    return ["".join(character for character, _ in row) for row in cells(snapshot, shown_with)]


def cells(snapshot: Snapshot, shown_with: Look) -> list[list[tuple[str, Style]]]:
    """Every character with its style, row by row."""
    widget = ReturnCurve(shown_with)
    widget.snapshot = snapshot
    return [
        [(character, segment.style or Style()) for segment in row for character in segment.text]
        for row in widget.picture(snapshot, *WIDE)
    ]


def one_episode(value: float) -> Curve:
    values = np.array([value])
    return Curve(np.array([1]), values, values, values, values)


# Far below all the rest


def far_below() -> Snapshot:
    """A first episode and a first greedy policy that are worth far less than all that came after them."""
    returns = np.array([-1_379.0, *np.full(39, -40.0)])
    episodes = np.arange(1, 41)
    early = Marks(np.array([0, 800, 1_600]), np.array([0, 10, 20]), np.array([-65_375.0, -65_375.0, -15.0]))
    return student(
        episodes=40,
        curve=Curve(episodes, returns, returns, returns, returns),
        marks=early,
        greedy_return=-15.0,
        return_last_100=-70.0,
        expected_return=None,
    )


def test_the_axis_is_that_of_most_episodes_and_of_the_best() -> None:
    _, widget = drawn(far_below())
    assert widget.scale == Scale(-70.0, 0.0, 20.0)


def test_a_line_below_the_axis_is_marked_where_it_leaves_it() -> None:
    snapshot = far_below()
    rows, palette = cells(snapshot, look()), look().palette
    bottom = rows[-3]
    arrows = {style.color for character, style in bottom if character == "↓"}
    assert arrows == {palette.episodes.color, palette.greedy_line.color}
    assert not any(character == "↓" for row in rows[:-3] for character, _ in row)
    assert "↓ greedy, once −65,375" in drawn(snapshot)[0]
    assert "v greedy, once" in drawn(snapshot, ascii=True)[0]
    beside_program = drawn(replace(snapshot, program=ProgramView("student.py", "FrozenLake-v1")))[0]
    assert f"↓ {BELOW_AXIS}: greedy and episodes" in beside_program
    assert "65,375" not in beside_program


@pytest.mark.parametrize("height", range(1, 9))
def test_far_below_is_told_at_any_height(height: int) -> None:
    for snapshot in (far_below(), lake(), bandit()):
        for size in ((40, height), (60, height), (12, height)):
            drawn(snapshot, size)
    assert UNICODE.down in drawn(far_below(), (60, height))[1].footing


def test_a_first_episode_decides_on_the_axis_as_long_as_there_are_few() -> None:
    start = changed(far_below(), episodes=1, return_last_100=-1_379.0, curve=one_episode(-1_379.0))
    _, widget = drawn(start)
    assert widget.scale == Scale(-1_500.0, 0.0, 500.0)


def test_a_greedy_policy_below_the_axis_has_an_arrow_and_its_number_at_its_end() -> None:
    text, widget = drawn(changed(far_below(), greedy_return=-65_375.0))

    assert "↓ greedy, exact −65,375" in text
    assert widget.scale == Scale(-70.0, 0.0, 20.0)


def test_what_is_on_the_axis_has_no_arrows() -> None:
    assert "↓" not in drawn(lake())[0]
