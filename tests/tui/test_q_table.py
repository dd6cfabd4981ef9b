from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from rich.segment import Segment
from rich.style import Style
from samples import bandit, big_lake, lake, look, snapshot, student
from textual import events
from textual.app import App, ComposeResult
from textual.geometry import Region, Size
from textual.pilot import Pilot
from textual.strip import Strip
from textual.widgets import Button

from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.lab.snapshot import Phase, Snapshot
from rl_tui.tui.widgets.q_table import COMPUTING, FOLLOW_HINT, FOLLOWS, QTable
from rl_tui.tui.widgets.q_table_layers import Figures, Layer
from rl_tui.worlds.drawing import Graph
from rl_tui.worlds.mdp import Outcome, Transition, tabular_mdp
from rl_tui.worlds.world import World

PALETTE = look().palette


class Drawn:
    """A table drawn without an app."""

    def __init__(
        self,
        state: Snapshot,
        width: int = 36,
        height: int = 17,
        layer: Layer = Layer.Q,
        *,
        revealed: bool = False,
        lights: bool = True,
        ascii_only: bool = False,
    ) -> None:
        self.table = QTable(look(ascii_only))
        self.table._size = Size(width, height)
        self.table.revealed = revealed
        self.table.lights = lights
        self.table.shown_layer = layer
        self.table.show(state)
        self.strips = self.table.picture(state, width, height)
        assert [strip.cell_length for strip in self.strips] == [width] * height

    @property
    def rows(self) -> list[str]:
        return [strip.text for strip in self.strips]

    @property
    def text(self) -> str:
        return "\n".join(self.rows)

    def row(self, start: str) -> str:
        return next(row for row in self.rows if row.replace("◉", " ").strip().startswith(start))

    def style_of(self, row: int, text: str) -> Style:
        style = next(segment.style for segment in self.strips[row] if text in segment.text)
        assert style is not None
        return style


def fresh(state: Snapshot, q: list[float], visits: list[int]) -> Snapshot:
    return replace(state, q=np.array(q), visits=np.array(visits, dtype=np.int64), last=None)


def lake_of(values: dict[int, float], **changes: Any) -> Snapshot:
    """The small lake before its first step, but for some pairs that were visited once."""
    start = lake(0)
    q, visits = np.zeros(44), np.zeros(44, dtype=np.int64)
    for pair, value in values.items():
        q[pair], visits[pair] = value, 1
    return replace(start, q=q, visits=visits, **changes)


def test_rows_are_live_states_and_columns_actions() -> None:
    drawn = Drawn(lake())
    assert drawn.rows[0].split() == ["←", "↓", "→", "↑"]
    states = [row.replace("◉", " ").split()[0] for row in drawn.rows[1:12]]
    assert states == ["0", "1", "2", "3", "4", "6", "8", "9", "10", "13", "14"]
    assert not "".join(drawn.rows[12:]).strip()
    assert drawn.table.heading == "Q · 11 states × 4"
    assert drawn.table.rows == 11
    assert drawn.row("6").startswith("◉ 6")
    assert drawn.text.count("◉") == 1


def test_every_number_is_printed_where_its_pair_stands() -> None:
    state = lake()
    rows = Drawn(state, 56, 12, Layer.OPTIMAL).rows
    assert state.exact is not None
    for row, live in zip(rows[1:], (0, 1, 2, 3, 4, 6, 8, 9, 10, 13, 14), strict=True):
        numbers = [
            float(word) for word in row.replace("▌", " ").replace("▐", " ").replace("◉", " ").split()[1:]
        ]
        first = int(state.world.space.first_pair[live])
        assert numbers == [round(value, 3) for value in state.exact.q[first : first + 4]]


def test_all_exact_ties_are_framed_and_none_where_nothing_is_known() -> None:
    assert "▌" not in Drawn(lake(0)).text
    drawn = Drawn(lake_of({0: 0.1, 1: 0.5, 2: 0.5, 3: 0.1 + 0.2 + 0.2}))
    assert drawn.row("0").count("▌") == drawn.row("0").count("▐") == 3
    nearly = Drawn(lake_of({0: 0.5, 1: math.nextafter(0.5, 0.0), 2: 0.1, 3: 0.1}))
    assert nearly.row("0").count("▌") == 1
    assert "▌" not in nearly.row("1")


def test_a_visited_row_of_equal_values_is_framed_whole() -> None:
    assert Drawn(lake_of({0: 0.0})).row("0").count("▌") == 4


def test_the_frames_of_the_exact_layer_are_the_ties_of_the_solution() -> None:
    drawn = Drawn(lake(), layer=Layer.OPTIMAL)
    assert drawn.row("6").count("▌") == 2  # left and right are equally good there
    assert drawn.table.heading == "Q*, exact · 11 states × 4"


def test_unvisited_differs_from_zero() -> None:
    drawn = Drawn(lake_of({0: 0.0, 1: 0.7}))
    assert drawn.row("0").split() == ["◉", "0", "0.000", "▌0.700▐", "·", "·"]
    assert drawn.style_of(1, "·") == PALETTE.unvisited
    assert drawn.style_of(1, "0.000") == PALETTE.value(0.0)
    assert drawn.style_of(1, "0.700") == PALETTE.value(1.0)
    hopeful = Drawn(replace(lake(0), q=np.full(44, 2.0)))
    assert hopeful.row("1").split() == ["1", "2.000", "2.000", "2.000", "2.000"]
    assert hopeful.style_of(1, "2.000") == PALETTE.unvisited


def test_the_signed_layer_is_tinted_around_zero() -> None:
    state = lake_of({0: 0.2, 1: 0.9})
    exact = lake().exact
    assert exact is not None
    target = replace(exact, q=np.full(44, 0.5))
    drawn = Drawn(replace(state, exact=target), layer=Layer.ERROR)
    assert drawn.table.heading.startswith("Q − Q* · ")
    assert drawn.style_of(1, "−0.30") == PALETTE.signed_value(-0.3 / 0.5)
    assert drawn.style_of(1, "0.40") == PALETTE.signed_value(0.4 / 0.5)
    assert drawn.style_of(1, "−0.50") == PALETTE.unvisited


def test_visits_are_tinted_by_their_logarithm() -> None:
    visits = [0, 9, 99, 9_999, *([0] * 40)]
    drawn = Drawn(fresh(lake(0), [0.0] * 44, visits), layer=Layer.VISITS)
    assert drawn.row("0").replace("▌", " ").replace("▐", " ").split() == ["◉", "0", "·", "9", "99", "9,999"]
    assert drawn.style_of(1, "9,999") == PALETTE.value(1.0)
    assert drawn.style_of(1, "   99") == PALETTE.value(0.5)


@pytest.mark.parametrize("layer", [Layer.OPTIMAL, Layer.ERROR])
def test_without_an_exact_answer_the_panel_says_why(layer: Layer) -> None:
    assert COMPUTING in Drawn(lake(exact=None), layer=layer).text
    reason = "state 5 cannot reach an end"
    refused = Drawn(lake(exact=None, exact_refused=reason), 60, 5, layer)
    assert f"No exact answer: {reason}" in refused.text
    assert "0." in Drawn(lake(exact=None, exact_refused=reason)).text


def test_the_cell_just_updated_is_lit_while_steps_can_be_followed() -> None:
    state = big_lake()
    assert state.last is not None
    assert "▐.21▌" in Drawn(state, 56, 28).text
    drawn = Drawn(lake())
    assert drawn.style_of(6, "0.246") == PALETTE.updated
    for dark in (
        Drawn(lake(), lights=False),
        Drawn(lake(phase=Phase.RUNNING, speed=None)),
        Drawn(lake(phase=Phase.RUNNING, speed=100.0)),
        Drawn(lake(), layer=Layer.OPTIMAL),
    ):
        assert PALETTE.updated not in [segment.style for segment in dark.strips[6]]
    assert Drawn(lake(phase=Phase.RUNNING, speed=30.0)).style_of(6, "0.246") == PALETTE.updated


def test_a_long_table_scrolls_and_follows_the_agent() -> None:
    drawn = Drawn(big_lake())
    assert "◉28" in drawn.text
    assert drawn.table.footing.startswith(FOLLOWS)
    assert any(row.endswith("█") for row in drawn.rows)
    for state in (0, 62, 33):
        rows = [strip.text for strip in drawn.table.picture(replace(big_lake(), state=state), 36, 17)]
        assert any(row.startswith(f"◉{state:>2}") for row in rows)


def test_two_blocks_stand_side_by_side_where_that_saves_scrolling() -> None:
    drawn = Drawn(big_lake(), 56, 28)
    assert drawn.rows[0].split() == ["←", "↓", "→", "↑"] * 2
    assert "◉28" in drawn.rows[1]
    assert not drawn.table.footing.startswith(FOLLOWS)
    numbers = [
        word for row in drawn.rows[1:] for word in (row[:3].strip("◉ "), row[28:31].strip("◉ ")) if word
    ]
    assert sorted(map(int, numbers)) == [state for state in range(63) if str(state) in numbers]
    assert len(numbers) == 53


def test_signs_are_worth_more_than_a_second_block() -> None:
    assert "−0.169" in Drawn(big_lake(), 56, 28, Layer.ERROR).text


def test_few_pairs_are_listed_a_row_each() -> None:
    drawn = Drawn(student())
    assert drawn.table.heading == "Q · 5 pairs"
    assert drawn.table.rows == 7
    assert drawn.rows[0].split() == ["state", "action", "Q", "N"]
    assert drawn.rows[1].split() == ["Class", "study", "▐", "6.370▌", "1,204"]
    assert drawn.rows[2].split() == ["check", "phone", "5.137", "133"]
    assert drawn.rows[5].split() == ["◉Pass", "sleep", "▌10.000▐", "963"]
    assert "greedy: study · quit · sleep" in drawn.rows[7]


def test_a_wide_list_shows_all_layers_at_once() -> None:
    drawn = Drawn(student(), 56, 10)
    assert drawn.rows[0].split() == ["state", "action", "Q", "Q*", "Q−Q*", "N"]
    assert drawn.rows[1].split() == ["Class", "study", "▐", "6.370▌", "6.341", "0.029", "1,204"]
    assert Drawn(student(exact=None), 56, 10).rows[0].split() == ["state", "action", "Q", "N"]


def test_a_very_narrow_list_keeps_the_number_of_the_layer_in_force() -> None:
    assert "6.370" in Drawn(student(), 16, 10).text
    assert "1,204" not in Drawn(student(), 16, 10).text
    drawn = Drawn(student(), 16, 10, Layer.VISITS)
    assert drawn.rows[0].split()[-1] == "N"
    assert "1,204" in drawn.text
    assert "6.370" not in drawn.text


def test_a_narrow_list_shows_the_layer_in_force() -> None:
    drawn = Drawn(student(), layer=Layer.OPTIMAL)
    assert drawn.rows[0].split() == ["state", "action", "Q*", "N"]
    assert "▌ 6.341▐" in drawn.rows[1]


def test_ties_are_joined_in_the_greedy_line() -> None:
    tied = fresh(student(), [1.0, 1.0, 0.0, 2.0, 0.0], [1, 1, 1, 1, 0])
    assert "greedy: study=check phone · quit · ?" in Drawn(tied, 56, 10).text


def test_a_bandit_keeps_its_means_until_they_are_revealed() -> None:
    hidden = Drawn(bandit(), 36, 13)
    assert hidden.rows[0].split() == ["arm", "Q", "q*", "N", "share"]
    assert hidden.text.count("···") == 10
    assert "1.500" not in hidden.text
    assert hidden.table.layer_choices == (Layer.Q, Layer.VISITS)
    assert "show the true means" in hidden.rows[12]
    assert hidden.row("▸").split()[:3] == ["▸", "5", "▐"]
    shown = Drawn(bandit(), 36, 13, revealed=True)
    assert "1.500" in shown.rows[6]
    assert "···" not in shown.text
    assert shown.table.layer_choices == tuple(layer for layer in Layer if layer is not Layer.LANES)


def test_a_hidden_layer_falls_back_to_q() -> None:
    drawn = Drawn(bandit(), layer=Layer.ERROR, revealed=True)
    assert drawn.table.heading.startswith("Q − Q*")
    drawn.table.revealed = False
    assert drawn.table.shown_layer is Layer.Q


def test_the_bar_of_an_arm_is_its_share_of_the_pulls() -> None:
    rows = Drawn(bandit(), 56, 13, revealed=False).rows
    lengths = [row.count("█") for row in rows[1:11]]
    assert lengths[5] == max(lengths)
    assert lengths[5] / 20 == pytest.approx(0.842, abs=0.05)


def test_an_action_that_is_not_legal_leaves_its_cell_empty() -> None:
    def goes(state: int) -> tuple[Outcome, ...]:
        return (Outcome(1.0, state, 1.0, False),)

    mdp = tabular_mdp(
        ("high", "low"),
        ("search", "wait", "recharge"),
        [
            Transition(0, 0, goes(1)),
            Transition(0, 1, goes(0)),
            Transition(1, 0, goes(0)),
            Transition(1, 1, goes(1)),
            Transition(1, 2, goes(0)),
        ],
        {0: 1.0},
    )
    base = student(0)
    world = World(mdp, Graph(((0, 0), (1, 0))))
    state = snapshot(
        world, base.recipe.scenario, Hyperparameters(), q=np.arange(5.0), visits=np.ones(5, dtype=np.int64)
    )
    rows = Drawn(state, 50, 4).rows
    assert rows[0].split() == ["search", "wait", "recharge"]
    assert rows[1].replace("▌", " ").replace("▐", " ").split() == ["◉high", "0.000", "1.000"]
    assert rows[2].replace("▌", " ").replace("▐", " ").split() == ["low", "2.000", "3.000", "4.000"]
    assert rows[1].index("1.000") == rows[2].index("3.000")


def test_numbers_that_left_all_bounds_are_still_drawn() -> None:
    q = [math.nan, math.inf, -1e12, 5.0, *([0.0] * 40)]
    text = Drawn(fresh(lake(0), q, [1] * 44)).row("0")
    assert "nan" in text
    assert "inf" in text


@pytest.mark.parametrize("state", [lake(), lake(0), big_lake(), student(), student(0), bandit(), bandit(0)])
def test_it_fits_every_size(state: Snapshot) -> None:
    for width in (1, 2, 3, 5, 8, 13, 21, 30, 36, 47, 56, 80, 120, 200):
        for height in (1, 2, 3, 7, 17, 40):
            for layer in (Layer.Q, Layer.ERROR):
                Drawn(state, width, height, layer, revealed=True)


@pytest.mark.parametrize("state", [big_lake(), student(), bandit()])
def test_ascii_needs_no_other_characters(state: Snapshot) -> None:
    for layer in Layer:
        drawn = Drawn(state, 44, 12, layer, revealed=True, ascii_only=True)
        drawn.text.encode("ascii")
        drawn.table._write_border()
        assert drawn.table._border_subtitle is not None
        drawn.table._border_subtitle.plain.encode("ascii")


def test_every_segment_has_a_style() -> None:
    for state in (lake(), big_lake(), student(), bandit()):
        for strip in Drawn(state).strips:
            assert all(isinstance(segment, Segment) and segment.style for segment in strip)


def test_only_rows_in_view_are_looked_at(monkeypatch: pytest.MonkeyPatch) -> None:
    seen: set[int] = set()
    text = Figures.text

    def counted(self: Figures, pair: int, width: int) -> str:
        seen.add(pair)
        return text(self, pair, width)

    monkeypatch.setattr(Figures, "text", counted)
    Drawn(big_lake(), 36, 6)
    assert len(seen) == 5 * 4


def test_the_footing_names_the_layers_and_frames_the_one_in_force() -> None:
    drawn = Drawn(lake())
    assert drawn.table.footing == "v:▌Q▐ Q*  Q−Q*  visits"
    drawn.table.next_layer()
    drawn.table.picture(lake(), 36, 17)
    assert drawn.table.footing == "v: Q ▌Q*▐ Q−Q*  visits"
    assert Drawn(student(), 20, 10, Layer.VISITS).table.footing == "v: visits"
    assert Drawn(bandit(), 30, 12).table.footing == "v:▌Q▐ visits"


class Bench(App[None]):
    CSS = "QTable { width: 38; height: 19; border: round white; } Button { height: 3; }"

    def __init__(self, state: Snapshot) -> None:
        super().__init__()
        self.state = state
        self.table = QTable(look())
        self.moves: list[int | None] = []
        self.refreshed: list[Region] = []

    def compose(self) -> ComposeResult:
        yield self.table
        yield Button("elsewhere")

    def on_mount(self) -> None:
        self.table.show(self.state)
        self.table.focus()

    def on_qtable_cursor_moved(self, event: QTable.CursorMoved) -> None:
        self.moves.append(event.pair)

    def strip(self, y: int) -> Strip:
        return self.table.render_line(y)

    @property
    def text(self) -> str:
        return "\n".join(self.strip(y).text for y in range(self.table.size.height))


def pair_of(state: Snapshot, cell: int, action: int) -> int:
    return int(state.world.space.first_pair[cell]) + action


async def test_before_the_first_snapshot_it_says_what_comes() -> None:
    table = QTable(look())
    table._size = Size(60, 5)
    assert "come with the first step" in table.picture(None, 60, 5)[0].text
    assert table.rows == 1


async def test_the_arrows_move_the_cursor_from_where_the_agent_is() -> None:
    state = lake()
    app = Bench(state)
    async with app.run_test(size=(80, 30)) as pilot:
        assert app.table.cursor_pair is None
        await pilot.press("right", "right", "right", "right", "down", "left")
        steps = [(6, 1), (6, 2), (6, 3), (6, 3), (8, 3), (8, 2)]
        assert app.moves == [pair_of(state, *step) for step in steps]
        await pilot.press("end", "down", "home", "up", "pagedown", "pageup")
        assert app.table.cursor_pair == pair_of(state, 0, 2)
        assert "▸" in app.strip(1).text
        await pilot.press("tab")
        assert "▸" not in app.text
        assert app.table.cursor_pair == pair_of(state, 0, 2)


async def test_a_moved_cursor_stops_the_following_until_escape() -> None:
    state = big_lake()
    app = Bench(state)
    async with app.run_test(size=(80, 30)) as pilot:
        await pilot.press("end")
        assert app.table.cursor_pair == pair_of(state, 62, 0)
        assert " 62 " in app.text
        assert FOLLOW_HINT in app.table.footing
        app.table.show(replace(state, state=0))
        assert " 62 " in app.text
        await pilot.press("full_stop")
        assert "◉ 0" in app.text
        assert app.table.footing.startswith(FOLLOWS)
        assert app.moves[-1] is None
        assert app.table.cursor_pair is None
        await pilot.press("pagedown", "escape")
        assert "◉ 0" in app.text


async def test_escape_is_left_to_the_screen_while_it_follows() -> None:
    app = Bench(lake())
    async with app.run_test(size=(80, 30)):
        assert app.table.check_action("follow", ()) is False
        app.table.action_move(1, 0)
        assert app.table.check_action("follow", ()) is True


async def test_a_click_puts_the_cursor_on_the_cell() -> None:
    state = lake()
    app = Bench(state)
    async with app.run_test(size=(80, 30)) as pilot:
        x = app.strip(1).text.index("0.354") + 2
        await pilot.click(app.table, offset=(x + 1, 1 + 2))
        assert app.moves == [pair_of(state, 1, 1)]
        await pilot.click(app.table, offset=(2, 2))
        await pilot.click(app.table, offset=(x + 1, 16))
        assert len(app.moves) == 1


async def test_the_wheel_scrolls_and_keeps_the_cursor() -> None:
    app = Bench(big_lake(state=0))
    async with app.run_test(size=(80, 30)) as pilot:
        await wheel(pilot, app.table, events.MouseScrollDown)
        assert app.strip(1).text.startswith("  3")
        assert app.table.cursor_pair is None
        for _ in range(30):
            await wheel(pilot, app.table, events.MouseScrollDown)
        assert " 62 " in app.strip(16).text
        await wheel(pilot, app.table, events.MouseScrollUp)
        assert " 62 " not in app.text


async def wheel(pilot: Pilot[None], table: QTable, kind: type[events.MouseEvent]) -> None:
    table.post_message(
        kind(table, x=9, y=5, delta_x=0, delta_y=0, button=0, shift=False, meta=False, ctrl=False)
    )
    await pilot.pause()


async def test_only_rows_that_changed_are_refreshed(monkeypatch: pytest.MonkeyPatch) -> None:
    state = lake()
    app = Bench(state)
    async with app.run_test(size=(80, 30)) as pilot:
        await pilot.pause()
        regions: list[Region] = []
        monkeypatch.setattr(app.table, "refresh", lambda *changed: regions.extend(changed))
        q = state.q.copy()
        q[pair_of(state, 9, 1)] -= 0.1
        app.table.show(replace(state, q=q))
        assert regions == [Region(0, 8, 36, 1)]
        regions.clear()
        app.table.show(replace(state, q=q.copy(), step=state.step + 1))
        assert regions == []


async def test_another_world_starts_at_the_top() -> None:
    app = Bench(big_lake())
    async with app.run_test(size=(80, 30)) as pilot:
        await pilot.press("end")
        app.table.show(lake(0))
        assert app.table.cursor_pair is None
        assert "◉ 0" in app.strip(1).text
