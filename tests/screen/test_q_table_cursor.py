"""The cursor of the Q-table."""

from __future__ import annotations

import pytest
from samples import big_lake, lake, look
from seams import sized
from snapshots import changed
from textual import events
from textual.app import App, ComposeResult
from textual.geometry import Region
from textual.pilot import Pilot
from textual.strip import Strip
from textual.widgets import Button

from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.panels.q_table.q_table import QTable
from rl_tui.screen.panels.q_table.sheet import FOLLOW_HINT


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


class NarrowBench(Bench):
    """Too narrow for columns: the table is a list of pairs."""

    CSS = "QTable { width: 22; height: 19; border: round white; } Button { height: 3; }"


def pair_of(state: Snapshot, cell: int, action: int) -> int:
    return int(state.world.space.first_pair[cell]) + action


def test_before_the_first_snapshot_it_says_what_comes() -> None:
    table = sized(QTable(look()), 60, 5)
    assert "come with the first step" in table.picture(None, 60, 5)[0].text


async def test_the_arrows_move_the_cursor_from_where_the_agent_is() -> None:
    state = lake()
    app = Bench(state)
    async with app.run_test(size=(80, 30)) as pilot:
        assert app.table.cursor_pair is None
        await pilot.press("right", "right", "right", "right", "down", "left")
        steps = [(6, 2), (6, 1), (6, 0), (6, 0), (8, 0), (8, 1)]  # ↑ → ↓ ←
        assert app.moves == [pair_of(state, *step) for step in steps]
        await pilot.press("end", "down", "home", "up", "pagedown", "pageup")
        assert app.table.cursor_pair == pair_of(state, 0, 1)
        assert "▸" in app.strip(1).text
        await pilot.press("tab")
        assert "▸" not in app.text
        assert app.table.cursor_pair == pair_of(state, 0, 1)


async def test_a_moved_cursor_stops_the_following_until_escape() -> None:
    state = big_lake()
    app = Bench(state)
    async with app.run_test(size=(80, 30)) as pilot:
        await pilot.press("end")
        assert app.table.cursor_pair == pair_of(state, 62, 3)
        assert " 62 " in app.text
        assert FOLLOW_HINT in app.table.footing
        app.table.show(changed(state, state=0))
        assert " 62 " in app.text
        await pilot.press("full_stop")
        assert "◉ 0" in app.text
        assert FOLLOW_HINT not in app.table.footing
        assert app.moves[-1] is None
        assert app.table.cursor_pair is None
        await pilot.press("pagedown")
        assert app.table.check_action("follow", ()) is True
        await pilot.press("escape")
        assert "◉ 0" in app.text
        assert app.table.check_action("follow", ()) is False, "escape is left to the screen"
        await pilot.press("end")
        app.table.show(lake(0))
        assert app.table.cursor_pair is None, "another world starts at the top"
        assert "◉ 0" in app.strip(1).text


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
        q = state.agent.q.copy()
        q[pair_of(state, 9, 1)] -= 0.1
        app.table.show(changed(state, q=q))
        assert regions == [Region(0, 8, 36, 1)]
        regions.clear()
        app.table.show(changed(state, q=q.copy(), step=state.counters.step + 1))
        assert regions == []


async def test_a_list_of_pairs_has_the_order_of_the_columns() -> None:
    state = lake()
    app = NarrowBench(state)
    async with app.run_test(size=(80, 30)) as pilot:
        await pilot.press("home")
        listed = [app.strip(y).text.split() for y in range(1, 5)]
        assert [row[0] for row in listed[1:]] == ["→", "↓", "←"]
        assert "↑" in listed[0]
        assert app.table.cursor_pair == pair_of(state, 0, 3)
        await pilot.press("down", "down", "down", "down")
        assert app.moves[1:] == [pair_of(state, *each) for each in ((0, 2), (0, 1), (0, 0), (1, 3))]
        await pilot.click(app.table, offset=(5, 1 + 3))
        assert app.table.cursor_pair == pair_of(state, 0, 1)
