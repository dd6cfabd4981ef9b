from __future__ import annotations

from dataclasses import replace

import numpy as np
from conftest import MakeApp
from samples import answered, bandit, lake, look, stepped_lake, student
from seams import on_screen, playground, press, screen_text
from snapshots import changed
from textual.app import App, ComposeResult

from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.app.screenshot import settle
from rl_tui.screen.draw import names
from rl_tui.screen.panels.model import ModelPanel
from rl_tui.worlds.files.catalogue import find


def panel(snapshot: Snapshot | None, pair: int | None = None, *, ascii: bool = False) -> ModelPanel:  # noqa: A002
    made = ModelPanel(look(ascii))
    made.has_focus = True
    made.show_pair(pair)
    if snapshot is not None:
        made.show(snapshot)
    return made


def drawn(made: ModelPanel, width: int = 90, height: int = 40) -> str:
    rows = made.picture(made.snapshot, width, height)
    assert [row.cell_length for row in rows] == [width] * height
    return "\n".join(row.text.rstrip() for row in rows)


def test_the_five_parts_of_a_grid() -> None:
    made = panel(lake())
    text = drawn(made)
    assert "S     16 states: 0, 1, 2" in text
    assert "14, 15; 11 with actions" in text
    assert "A     4 actions: ↑ up, → right, ↓ down, ← left" in text
    assert "P     44 state–action pairs, 132 outcomes" in text
    assert "R     from 0 to 1" in text
    assert "γ     .99" in text
    assert "start 0 (row 0, column 0, counted from 0)" in text
    assert "terminal 5, 7, 11, 12, 15" in text
    assert "truncated after 100 steps" in text
    assert made.heading == "Model"


def test_the_place_in_the_drawing_is_told_of_plain_numbers_only() -> None:
    taxi = find("taxi").build(np.random.default_rng(0))
    state = taxi.space.state_names.index("2,3 R→B")
    assert names.place(taxi, state) == ""
    assert names.place(lake().world, 6) == "row 1, column 2, counted from 0"


def test_the_outcomes_of_a_pair_and_where_it_slips() -> None:
    snapshot = lake()
    down = int(snapshot.world.space.first_pair[4]) + 1
    lines = [" ".join(line.split()) for line in drawn(panel(snapshot, down)).splitlines()]
    assert f"state 4 action ↓ down row 1, column 0, counted from 0 pair {down + 2} of 44" in lines
    table = lines[lines.index("p went r s′") + 1 :]
    assert table[:3] == ["1/3 → 0 5: hole ends", "1/3 ↓ 0 8", "1/3 ← 0 4"]


def test_the_bellman_equation_of_the_student_is_the_one_worked_out_by_hand() -> None:
    text = drawn(panel(student(), 0))
    assert "Q*(Class,study) = Σ p · [r + γ · max Q*(s′,·)]" in text
    assert "= .8·[−2 + .90·10.0000] + .2·[−2 + .90·6.3415]" in text
    assert f"= {5.2 / 0.82:.4f}" in text
    assert "learned Q(Class,study) = 6.3700, taken 1,204 times" in text
    once = changed(student(), visits=np.ones(5, dtype=np.int64))
    assert drawn(panel(once, 0)).count(", taken 1 time\n") == 1


def test_the_border_names_the_keys_that_do_something() -> None:
    made = panel(lake())
    drawn(made)
    assert made.footing == "↑ ↓: state   ← →: action   esc: close"
    drawn(made, height=10)
    assert made.footing == "↑ ↓: state   ← →: action   pgup pgdn: scroll   esc: close"
    drawn(made, width=40, height=10)
    assert made.footing == "pgup pgdn: scroll   esc: close"
    drawn(made, width=14, height=10)
    assert made.footing == "esc: close"


def test_where_every_state_has_actions_that_is_not_said() -> None:
    assert "S     1 state: bandit" in drawn(panel(bandit(400)))


def test_nothing_follows_a_terminal_outcome() -> None:
    text = drawn(panel(student(), 4))
    assert "= 1·[10]" in text
    assert "ends" in text


def test_without_slipping_nothing_is_said_of_it() -> None:
    assert "went" not in drawn(panel(student(), 0))
    assert "went" not in drawn(panel(lake(slippery=False), 0))


def test_an_unvisited_pair_has_learned_nothing() -> None:
    assert "learned Q(0,←) = not yet visited" in drawn(panel(lake(0), 0))


def test_without_an_exact_answer_it_says_why() -> None:
    assert "the exact values are being computed" in drawn(panel(lake(0), 0))
    refused = changed(lake(0), refused="state 3 cannot reach an end")
    assert "state 3 cannot reach an end" in drawn(panel(refused, 0))


def test_a_bandit_keeps_its_means() -> None:
    made = panel(bandit(400), 3)
    text = drawn(made)
    assert "R     hidden until w h or the end of the budget" in text
    assert "··· hidden until w h or the end of the budget" in text
    assert ".7" not in text.replace("learned Q(3) = 0.700", "")
    text = drawn(panel(answered(bandit(400)), 3))
    assert "Q*(3) = Σ p" in text
    assert "= 1·[.7]" in text
    assert "r ± 1 (normal)" in text
    assert ".7" in drawn(panel(bandit(), 3))


def test_several_starts_are_told_with_their_chances() -> None:
    snapshot = student()
    mdp = replace(
        snapshot.world.space,
        start_state=snapshot.world.space.next_state[[2, 1]],
        start_cumulative=snapshot.world.space.cumulative[[1, 1]] * [0.25, 1.0],
    )
    many = changed(snapshot, world=replace(snapshot.world, space=mdp))
    assert "with .25" in drawn(panel(many))


def test_ascii_has_no_other_characters() -> None:
    for snapshot in (lake(), student(), bandit(400)):
        text = drawn(panel(snapshot, 0, ascii=True))
        assert text.isascii()
        assert "?" not in text


class ModelApp(App[None]):
    def compose(self) -> ComposeResult:
        yield ModelPanel(look())


async def test_arrows_go_through_the_pairs() -> None:
    app = ModelApp()
    async with app.run_test(size=(60, 12)) as pilot:
        made = app.query_one(ModelPanel)
        assert made.pair is None
        await pilot.press("down", "right", "pagedown")
        made.show(lake())
        made.focus()
        first = lake().world.space.first_pair
        assert made.pair == 20, "that of the last step"
        made.show_pair(3)  # up
        await pilot.press("left", "up")
        assert made.pair == 3
        await pilot.press("right", "down")
        assert made.pair == first[1] + 2
        await pilot.press(*["down"] * 4)
        assert made.pair == first[6] + 2  # state 5 is a hole
        await pilot.press(*["down"] * 20)
        assert made.pair == first[14] + 2
        made.show_pair(int(first[8]))
        await pilot.press("up")
        assert made.pair == first[6]


async def test_what_does_not_fit_scrolls() -> None:
    app = ModelApp()
    async with app.run_test(size=(60, 8)) as pilot:
        made = app.query_one(ModelPanel)
        made.show(lake())
        made.focus()
        await pilot.press("pageup")
        top = made.render_line(0).text
        assert top.startswith(" state 6")
        await pilot.press("pagedown")
        assert made.render_line(0).text != top
        await pilot.press(*["pagedown"] * 10)
        bottom = made.render_line(7).text
        assert "bootstraps" in bottom
        await pilot.press(*["pageup"] * 10)
        assert made.render_line(0).text == top


def test_where_rows_are_few_states_and_actions_are_counted_only() -> None:
    made = panel(lake(), 5)
    text = drawn(made, 44, 20)
    assert "S     16 states; 11 with actions\n A     4 actions\n P     44 pairs, 132 outcomes" in text
    assert "start 0 (row 0, column 0, counted from 0)\n" in text
    assert "start 0\n" in drawn(made, 40, 22)
    assert text.rstrip("\n").endswith("bootstraps")
    assert made.footing.startswith("↑ ↓: state   ← →: action")


def test_of_a_stepped_environment_it_says_what_is_known() -> None:
    made = panel(stepped_lake(), 0)
    text = drawn(made)
    assert "15; 11 with actions" in text
    assert "P     no transition table (simulated only); 44 state–action pairs" in text
    assert "R     no transition table" in text
    assert "where the environment says so; truncated after 100 steps" in text
    assert "no transition table" in text
    assert "learned Q(0,←)" in text
    assert panel(stepped_lake()).pair is not None
    for width, height in ((20, 4), (60, 10), (100, 30)):
        drawn(panel(stepped_lake(), 3, ascii=True), width, height)


def egg() -> Snapshot:
    """An agent before the Pot, with equal observations in each minute."""
    return changed(
        student(),
        world=find("egg").build(np.random.default_rng(0)),
        q=np.zeros(8),
        visits=np.zeros(8, np.int64),
    )


def test_where_states_look_alike_it_says_that_there_is_no_p() -> None:
    text = " ".join(drawn(panel(egg(), 7)).split())
    assert "P none: the agent cannot tell some states apart" in text
    assert "p r s′ 1 −10 or 10 ? Plate ends ? depends on how you got here" in text
    waiting = " ".join(drawn(panel(egg(), 6)).split())
    assert "p r s′ ? −1 Pot ? −10 Plate ends ?" in waiting
    certain = " ".join(drawn(panel(egg(), 0)).split())
    assert "p r s′ 1 −1 Clock 2 learned" in certain
    for width, height in ((20, 4), (60, 10)):
        drawn(panel(egg(), 7, ascii=True), width, height)


def test_means_that_drift_are_those_of_the_start_and_said_to_drift() -> None:
    known = bandit()
    mdp = known.world.mdp
    assert mdp is not None
    drifting = changed(known, world=replace(known.world, space=replace(mdp, drift_std=0.01)))
    text = drawn(panel(drifting, 3), 100)
    assert "each mean moves by a random step of standard deviation 0.01" in text
    assert "r at the start" in text
    assert "the current means" in text


def test_names_with_commas_are_kept_apart() -> None:
    snapshot = lake()
    names = [f"{state}, no" for state in range(16)]
    world = replace(snapshot.world, space=replace(snapshot.world.space, state_names=names))
    assert "0, no; 1, no; " in drawn(panel(changed(snapshot, world=world)))


# In the playground


async def test_the_world_marks_the_state_its_action_and_all_next_states(make_app: MakeApp) -> None:
    async with on_screen(make_app("frozenlake-slippery"), (120, 40)) as pilot:
        board = playground(pilot).board
        view, model = board.world, board.model
        assert view is not None
        await press(pilot, "w", "m")
        first = view.world.space.first_pair
        model.show_pair(int(first[4]) + 1)  # down, which may slip to both sides
        await settle(pilot)
        assert view.shown_cursor == 4
        assert view.subject_next == {4, 5, 8}
        assert board.table.pointed == range(int(first[4]) + 1, int(first[4]) + 2)
        assert "possible s′" in screen_text(pilot.app)
        await press(pilot, "down")
        assert view.shown_cursor == 6
        view.focus()
        await press(pilot, "right")
        assert model.pair in view.world.space.pairs_of(view.cursor or 0), "a cursor chooses a pair too"
        await press(pilot, "escape", "escape")
        assert board.opened is None
        assert not view.subject
        assert "possible s′" not in screen_text(pilot.app)


async def test_below_a_map_that_a_panel_moves_no_key_leads_back(make_app: MakeApp) -> None:
    async with on_screen(make_app("taxi"), (80, 24)) as pilot:
        await press(pilot, "w", "m", "down")
        view = playground(pilot).board.world
        assert view is not None
        assert view.footing.startswith("rows ")
        assert "follow" not in screen_text(pilot.app)
