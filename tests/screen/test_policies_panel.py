"""The panel of policies."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from conftest import MakeApp
from samples import bandit, lake, look, student
from seams import click, on_screen, playground, press, screen_text, show, snapshot, train
from snapshots import changed
from textual.pilot import Pilot

from rl_tui.agents.exact.policy_figures import greedy_policy, softened, uniform_policy
from rl_tui.common.errors import UserError
from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.answers.policy_kind import PLANS, PolicyKind
from rl_tui.runs.answers.policy_values import NO_CHANCES, WHILE_RUNNING, DrawnPolicy, PolicyAnswer, worth_of
from rl_tui.runs.answers.view import AnswersView
from rl_tui.screen.app.screenshot import settle
from rl_tui.screen.frame.number_here import number_here
from rl_tui.screen.glossary.glossary import glossary, term_at
from rl_tui.screen.kit.layers import Layer
from rl_tui.screen.kit.row import CURVE, POLICIES, TABLE, WORLD
from rl_tui.screen.kit.snapshot_facts import shown_by
from rl_tui.screen.panels.catalogue import PANELS
from rl_tui.screen.panels.curve.text import amount as curve_amount
from rl_tui.screen.panels.curve.text import plot_columns
from rl_tui.screen.panels.policies import policies
from rl_tui.screen.panels.policies.studied import POLICY_NAMES, as_studied, policy_ink
from rl_tui.screen.panels.side_by_side import sides
from rl_tui.screen.theme.glyphs import UNICODE

KINDS = list(POLICY_NAMES)
SIZES = ((60, 40), (46, 16), (36, 19), (27, 13), (27, 5), (27, 3), (16, 10), (8, 4), (3, 2), (1, 1))


def studied(
    snapshot: Snapshot,
    kind: PolicyKind = PolicyKind.BEHAVIOUR,
    *,
    choices: DrawnPolicy | None = None,
    **other: PolicyAnswer,
) -> Snapshot:
    mdp = snapshot.world.mdp
    assert mdp is not None
    greedy = greedy_policy(mdp, snapshot.agent.q, "random")
    chances = {
        PolicyKind.UNIFORM: uniform_policy(mdp),
        PolicyKind.GREEDY: greedy,
        PolicyKind.BEHAVIOUR: softened(mdp, greedy, 0.1),
        PolicyKind.OPTIMAL: greedy,
        PolicyKind.DRAWN: (choices or DrawnPolicy()).chances(mdp),
    }
    gamma = snapshot.agent.hyperparameters.gamma
    found = {each: worth_of(mdp, policy, gamma) for each, policy in chances.items()}
    found |= {PolicyKind(each): answer for each, answer in other.items()}
    answers = replace(snapshot.answers, studied=kind, drawn=choices or DrawnPolicy(), policies=found)
    return replace(snapshot, answers=answers)


def drawn(
    shown: Snapshot | None,
    width: int = 46,
    height: int = 20,
    *,
    ascii: bool = False,  # noqa: A002
) -> str:
    panel = policies.Policies(look(ascii))
    panel.snapshot = shown
    rows = panel.picture(shown, width, height)
    assert [row.cell_length for row in rows] == [width] * height
    return "\n".join(row.text.rstrip() for row in rows)


def said(shown: Snapshot | None, width: int = 46, **how: bool) -> str:
    return " ".join(drawn(shown, width, **how).split())


# The panel


def test_each_policy_has_its_figures() -> None:
    shown = studied(lake())
    answers = shown.answers.policies
    rows = {line[1:9].strip(): line[9:].split() for line in drawn(shown).splitlines()[4:13]}
    for kind in KINDS[:4]:
        answer = answers[kind]
        figures = (answer.expected_return, answer.value_at_start, answer.steps)
        assert rows[POLICY_NAMES[kind]][:3] == [policies.amount(x, look()) for x in figures if x is not None]
    assert rows["drawn"] == rows["random"]  # no policy was drawn
    assert "drawn: random until you draw it (w p)" in said(studied(lake()))


def test_what_exploring_costs_is_the_difference() -> None:
    answers = studied(lake()).answers.policies
    greedy, acts = (answers[each].expected_return for each in (PolicyKind.GREEDY, PolicyKind.BEHAVIOUR))
    assert greedy is not None
    assert acts is not None
    assert acts > greedy  # this greedy policy goes in circles
    text = said(studied(lake()))
    assert f"exploring (ε .10) gains {policies.amount(acts - greedy, look())} an episode" in text
    assert "greedy earns as much as optimal" in text
    worse = replace(answers[PolicyKind.OPTIMAL], expected_return=greedy + 0.25)
    assert "greedy earns .250 less than optimal" in said(studied(lake(), optimal=worse))
    worst = replace(answers[PolicyKind.BEHAVIOUR], expected_return=greedy - 0.01)
    assert "exploring (ε .10) costs .010" in said(studied(lake(), behaviour=worst))


def test_the_limit_and_the_discount_are_told() -> None:
    text = said(studied(lake()), 60)
    assert "return: mean within 100 steps" in text
    assert "γ .99, no time limit" in text
    assert "ending: chance that an episode ends" in text


def test_a_policy_that_never_ends_has_no_return_and_says_so() -> None:
    endless = PolicyAnswer(np.zeros(5), np.zeros(4), np.zeros(5), -9.0, None, None, 0.0)
    text = said(studied(student(), greedy=endless), 60)
    assert "greedy: never ends, so it has no return" in text
    assert "0 %" in text
    assert "greedy – −9.00 – 0 %" in text
    assert "exploring" not in text


def test_how_likely_a_policy_ends_stands_where_that_is_not_certain_rather_than_its_length() -> None:
    endless = PolicyAnswer(np.zeros(5), np.zeros(4), np.zeros(5), 0.0, 0.0, 100.0, 0.0)
    text = drawn(studied(student(), greedy=endless), 36, 11).splitlines()
    head = next(y for y, line in enumerate(text) if line.split() == ["return", "at", "start", "ending"])
    assert text[head + 2].split()[-1] == "%"


def test_a_policy_has_one_colour_in_names_bars_and_curve() -> None:
    palette = look().palette
    inks = {kind: policy_ink(kind, palette) for kind in KINDS}
    assert len({ink.color for ink in inks.values()}) == len(KINDS)
    assert inks[PolicyKind.GREEDY] == palette.greedy_line
    panel = policies.Policies(look())
    shown = studied(lake(), PolicyKind.GREEDY)
    text = {
        (segment.text.strip(" ‹"), segment.style.color)
        for strip in panel.picture(shown, 70, 36)
        for segment in strip
        if segment.style is not None and segment.text.strip()
    }
    for kind in set(KINDS) - {PolicyKind.GREEDY}:  # the row of the cursor
        assert any(word.startswith(POLICY_NAMES[kind]) and ink == inks[kind].color for word, ink in text)
    colours = {colour for word, colour in text if word and set(word) <= set("█▏▎▍▌▋▊▉▐")}
    assert {ink.color for ink in inks.values()} >= colours
    assert len(colours) > 1


def test_bars_show_the_returns_on_one_scale() -> None:
    shown = studied(lake())
    for height in (20, 36):
        rows = {line[1:9].strip(): line for line in drawn(shown, 70, height).splitlines()}
        bars = {kind: rows[POLICY_NAMES[kind]].count("█") for kind in KINDS}
        returns = {kind: shown.answers.policies[kind].expected_return or 0.0 for kind in KINDS}
        assert sorted(KINDS, key=bars.__getitem__) == sorted(KINDS, key=returns.__getitem__)
    assert "█" not in drawn(shown, 70, 8)
    assert "█" not in drawn(changed(shown, is_hidden=True), 70, 36).split("optimal")[1].splitlines()[0]


def test_cells_without_a_value_are_explained_in_the_panel() -> None:
    shown = studied(lake(), PolicyKind.GREEDY)
    assert policies.NEVER_FROM_THERE not in said(shown)
    known = shown.answers.policies[PolicyKind.GREEDY]
    assert known.v is not None
    values = known.v.copy()
    values[0] = np.nan
    lost = replace(known, v=values)
    assert f"– or {policies.NEVER_FROM_THERE}" in said(studied(lake(), PolicyKind.GREEDY, greedy=lost))


def test_why_there_is_none_is_said_once() -> None:
    text = said(studied(lake(), behaviour=PolicyAnswer(refused=NO_CHANCES)))
    assert f"agent: {NO_CHANCES}" in text
    waiting = {kind.value: PolicyAnswer(refused=WHILE_RUNNING) for kind in KINDS}
    assert said(studied(lake(), **waiting)).count(WHILE_RUNNING) == 1
    assert PLANS in said(studied(lake(), behaviour=PolicyAnswer(refused=PLANS)))
    assert "…" in said(studied(lake(), optimal=PolicyAnswer()))


def test_what_a_bandits_policies_earn_is_secret_until_it_is_revealed() -> None:
    shown = changed(studied(bandit(400)), is_hidden=True)
    text = said(shown)
    assert not re.search(r"\d", text.replace(shown_by(shown, "them"), ""))
    assert "?" in text
    known = said(changed(shown, is_hidden=False))
    assert "a pull" in known
    assert "exploring (ε .10) costs" in known


def test_a_hidden_optimum_is_not_told() -> None:
    shown = studied(lake(), PolicyKind.OPTIMAL)
    hidden = changed(shown, is_hidden=True)
    rows = [line for line in drawn(hidden).splitlines() if "optimal" in line]
    assert rows[0].split()[-1] == "?"
    assert policies.THAN_OPTIMAL not in said(hidden)
    assert policies.AS_MUCH_AS_OPTIMAL not in said(hidden)


def test_it_fits_any_size_and_its_cursor_is_always_seen() -> None:
    choices = DrawnPolicy(((0, 1),))
    for shown in (studied(lake()), studied(bandit(400)), studied(student(), choices=choices)):
        for size in SIZES:
            drawn(shown, *size)
            assert drawn(shown, *size, ascii=True).isascii()
    for kind in PolicyKind:
        assert all("▸" in drawn(studied(lake(), kind), 27, height) for height in (3, 4, 5, 6)), kind


def test_its_figures_can_be_asked() -> None:
    terms = next(row.terms for row in PANELS if row.id == POLICIES)
    assert set(terms) <= set(glossary())
    for column in policies.FIGURES:
        ids = {term_at(column.head, place, UNICODE) for place in range(len(column.head))}
        assert any(glossary()[each].figure is not None for each in ids if each is not None), column.head
    line = "exploring (ε .10) costs .146 an episode"
    assert term_at(line, 0, UNICODE) in ("explore", "exploring-cost")
    for kind in (PolicyKind.UNIFORM, PolicyKind.BEHAVIOUR):
        assert term_at(POLICY_NAMES[kind], 0, UNICODE) is not None


# The curve next to it


def test_a_level_that_decimals_do_not_show_is_not_passed_off_as_zero() -> None:
    assert curve_amount(0.002, 2, UNICODE) == "<.01"
    assert curve_amount(-0.002, 2, UNICODE) == ">−.01"
    assert curve_amount(0.0, 2, UNICODE) == "0"


def test_the_curve_is_as_wide_whichever_policy_is_studied() -> None:
    for width in (40, 80):
        wide = {plot_columns(studied(lake(), kind), look(), width) for kind in (*KINDS[:3], PolicyKind.DRAWN)}
        assert len(wide) == 1


# With keys


def headings(pilot: Pilot[UserError]) -> list[str]:
    board = playground(pilot).board
    return [board.panel(each).head for each in (WORLD, TABLE, CURVE)]


@pytest.mark.exhaustive("plays at other sizes", but=["size1"])
@pytest.mark.parametrize("size", [(60, 18), (80, 24), (120, 40)])
async def test_p_opens_it_beside_the_world_and_its_cursor_says_what_that_shows(
    make_app: MakeApp, size: tuple[int, int]
) -> None:
    async with on_screen(make_app("student"), size) as pilot:
        board = playground(pilot).board
        assert snapshot(pilot).answers.studied is None
        assert (await press(pilot, "t", "p")).answers.studied is PolicyKind.GREEDY
        assert (await press(pilot, "up")).answers.studied is PolicyKind.UNIFORM
        assert board.panel(POLICIES).has_focus
        assert board.shows(WORLD) is (size != (60, 18))
        assert not board.shows(TABLE)
        assert "t p: policies" not in headings(pilot)[0]  # esc goes back there
        if board.shows(WORLD):
            assert "random" in headings(pilot)[0]
        if size != (60, 18):  # the graph is a list of its edges there
            assert "4.04" in screen_text(pilot.app)
            assert "2.40" in screen_text(pilot.app)
        assert (await press(pilot, "down")).answers.studied is PolicyKind.GREEDY
        if board.shows(WORLD):
            assert "greedy" in headings(pilot)[0]
        assert (await press(pilot, "end")).answers.studied is PolicyKind.DRAWN
        assert (await press(pilot, "down", "home", "up")).answers.studied is PolicyKind.UNIFORM
        assert (await press(pilot, "t", "p")).answers.studied is None
        assert board.shows(TABLE)
        assert "V of" not in headings(pilot)[0]
        assert "4.04" not in screen_text(pilot.app)
        assert (await press(pilot, "t", "p", "end", "escape")).answers.studied is None
        assert (await press(pilot, "t", "p")).answers.studied is PolicyKind.DRAWN  # the row of the cursor
        assert (await press(pilot, "d")).answers.studied is None


async def test_enter_keeps_it_on_world_table_and_curve_and_a_click_chooses_another(make_app: MakeApp) -> None:
    async with on_screen(make_app("student"), (120, 40)) as pilot:
        await train(pilot, 400)
        board = playground(pilot).board
        assert Layer.POLICY not in board.table.layer_choices
        kept = await press(pilot, "t", "p", "up", "enter")
        assert kept.answers.studied is PolicyKind.UNIFORM
        assert board.opened is None
        assert "V of the random policy · t p: policies" in headings(pilot)[0]
        assert Layer.POLICY in board.table.layer_choices
        await press(pilot, *["v"] * board.table.layer_choices.index(Layer.POLICY))
        assert board.table.shown_layer is Layer.POLICY
        assert headings(pilot)[1].strip().startswith("Q of the random policy")
        text = screen_text(pilot.app)
        assert "5.928" in text
        assert "random    6.2" in text
        assert "╌╌" in text
        assert (await press(pilot, "t", "p", "t", "p")).answers.studied is None
        assert board.table.shown_layer is Layer.Q
        assert "random    6.2" not in screen_text(pilot.app)
        await press(pilot, "t", "p")
        panel = board.panel(POLICIES)
        rows = [panel.render_line(y).text for y in range(panel.size.height)]
        y = next(y for y, row in enumerate(rows) if "agent" in row)
        await click(pilot, panel, offset=(4, y + 1))
        now = snapshot(pilot)
        assert now.answers.studied is PolicyKind.BEHAVIOUR
        waits = {kind: PolicyAnswer(refused=WHILE_RUNNING) for kind in PolicyKind}
        answers = AnswersView(studied=PolicyKind.GREEDY, policies=waits)
        show(playground(pilot), replace(now, answers=answers))
        await pilot.pause()
        assert "pause: V of the greedy policy" in headings(pilot)[0], "a dear world, while it runs"


async def test_a_state_that_a_policy_may_never_leave_has_a_dash_and_arrows_are_the_likeliest_actions(
    make_app: MakeApp,
) -> None:
    async with on_screen(make_app("cliff"), (120, 40)) as pilot:
        await train(pilot, 300)
        await press(pilot, "t", "p")
        assert "γ 1 " in screen_text(pilot.app)
        assert policies.WITHOUT_LIMIT not in screen_text(pilot.app)  # there is no limit
        shown = await press(pilot, "enter")
        board, values = playground(pilot).board, shown.answers.policies[PolicyKind.GREEDY].v
        assert values is not None
        state = int(np.flatnonzero(np.isnan(values))[0])
        await press(pilot, *["v"] * board.table.layer_choices.index(Layer.POLICY))
        for panel in (board.world, board.table):
            text = "\n".join(panel.render_line(y).text for y in range(panel.size.height))
            assert " – " in text
            assert "nan" not in text
        world = board.world
        assert "none" in [sign.meaning for sign in world.legend(shown)]
        assert "none" in [sign.meaning for sign in board.table.legend(shown)]
        world.put_cursor(state)
        told = number_here(world, look())
        assert told.name == f"Vπ({state}): none"
        await press(pilot, "t", "p", "end", "up")
        assert world.studied is PolicyKind.OPTIMAL
        rows = [world.render_line(y).text for y in range(14)]
        assert max(row.count("→") for row in rows) >= 11  # along the cliff
        world.put_cursor(36)
        told = number_here(world, look())
        assert told.name.startswith("Vπ(36) = −13")
        assert told.term == "policy-value"


def board_title(pilot: Pilot[UserError]) -> object:
    return playground(pilot).board.panel(POLICIES).head


async def test_two_lanes_show_the_same_policy_each_its_own(make_app: MakeApp) -> None:
    async with on_screen(make_app("student"), (120, 40)) as pilot:
        screen = playground(pilot)
        from rl_tui.live.commands import AddLane
        from rl_tui.runs.recipe import SetParameter

        screen.send(AddLane((SetParameter("epsilon", 0.5),)))
        await settle(pilot)
        await train(pilot, 500)
        both = await press(pilot, "t", "p", "down", "enter")
        assert both.beside.answers.studied is PolicyKind.BEHAVIOUR
        assert screen.board.is_paired
        text = screen_text(pilot.app)
        assert text.count("V of the agent") == 2
        world = screen.board.world
        left, right = (as_studied(each).agent.policy > 0.0 for each in sides(both))
        differs = {both.world.space.state_of(pair) for pair in np.flatnonzero(left != right).tolist()}
        assert world.differing == differs
        await press(pilot, "t", "p")
        assert str(board_title(pilot)).startswith("▸")
