"""The microscope's explanation of a step."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from samples import answered, bandit, lake, look, planning, stepped_lake
from snapshots import changed

from rl_tui.agents.catalogue import BY_ID
from rl_tui.agents.last_step import NOTHING
from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.runs.timeline.table_samples import CellHistory
from rl_tui.screen.panels.microscope.microscope import Microscope, lit_sources
from rl_tui.screen.panels.q_table.q_table import QTable
from rl_tui.worlds.drawing import Graph
from rl_tui.worlds.mdp.tabular_mdp import Outcome, Transition, tabular_mdp
from rl_tui.worlds.world import World

NARROW, WIDE = 40, 118


def with_episode(snapshot: Snapshot, rewards: list[float], **changes: Any) -> Snapshot:
    gamma = snapshot.counters.last_step.gamma
    told: dict[str, Any] = {
        "rewards": np.array(rewards),
        "discounted_return": sum(reward * gamma**place for place, reward in enumerate(rewards)),
        "last_step": replace(snapshot.counters.last_step, episode_step=len(rewards)),
        "cell": CellHistory(
            snapshot.counters.last_step.updated_pair,
            np.array([0, 60, 120, 240]),
            np.array([0.0, 0.1, 0.2, 0.25]),
        ),
    }
    return changed(snapshot, **(told | changes))


def shown(
    snapshot: Snapshot | None,
    width: int = NARROW,
    height: int = 60,
    *,
    ascii: bool = False,  # noqa: A002
    revealed: bool = False,
    scrolled: int = 0,
) -> list[str]:
    widget = Microscope(look(ascii))
    snapshot = answered(snapshot, revealed)
    widget.pair = (
        snapshot.counters.last_step.updated_pair
        if snapshot is not None and snapshot.counters.last_step is not None
        else None
    )
    widget.snapshot = snapshot
    rows = widget.picture(snapshot, width, height)
    if scrolled:
        widget.action_scroll_rows(scrolled)
        rows = widget.picture(snapshot, width, height)
    assert [row.cell_length for row in rows] == [width] * height
    text = [row.text.rstrip() for row in rows]
    assert not ascii or all(line.isascii() for line in text)
    return text


LAKE = with_episode(lake(), [0.0] * 7 + [1.0])


def part(lines: list[str], heading: str, until: str) -> list[str]:
    first = next(number for number, line in enumerate(lines) if line.startswith(f" {heading}"))
    last = next(
        number for number, line in enumerate(lines) if number > first and line.startswith(f" {until}")
    )
    return [line for line in lines[first + 1 : last] if line]


def test_the_loop_in_five_parts() -> None:
    lines = part(shown(LAKE), "The step", "The update")
    assert lines == [
        " state   s = 6   row 1, column 2",
        " action  a = ←   the greedy action",
        " reward  r = 0",
        " next    s′ = 2   slipped ↑, p = 1/3",
        " update  Q(6,←) .239 → .246   Q-learning",
    ]


def test_an_action_of_a_person_is_told_as_such() -> None:
    assert LAKE.counters.last_step is not None
    by_hand = changed(LAKE, last_step=replace(LAKE.counters.last_step, by_hand=True))
    assert " action  a = ←   you chose it" in shown(by_hand)


def test_every_number_of_the_update_says_where_it_comes_from() -> None:
    lines = part(shown(LAKE), "The update", "The backup")
    text = " ".join(" ".join(lines).split())
    assert "now = was + α ·(r + γ ·best − was ) .246 = .239 + .10·(0 + .99·.313 − .239)" in text
    assert "δ = +.070 .313 is max Q(2,·): ↑" in text
    wide = "\n".join(shown(LAKE, 60))
    assert " now  = was  + α  ·(r + γ  ·best − was )\n .246 = .239 + .10·(0 + .99·.313 − .239)" in wide


def test_a_mean_over_the_policy_lists_its_cells() -> None:
    q = LAKE.agent.q.copy()
    q[8:12] = 0.4, -0.2, 0.0, 0.1  # .925·.4 + .025·(−.2 + 0 + .1)
    mean = replace(
        LAKE.counters.last_step,
        bootstrap=0.3675,
        after=LAKE.counters.last_step.before + 0.1 * (0.99 * 0.3675 - LAKE.counters.last_step.before),
    )
    text = " ".join(shown(changed(LAKE, algorithm="expected-sarsa", last_step=mean, q=q), 90))
    text = " ".join(text.split())
    assert "= .025·.100 + .025·0 + .025·(−.200) + .925·.400" in text


def test_several_rewards_of_one_target_are_listed() -> None:
    ended = with_episode(lake(), [0.0, -1.0, 1.0])
    assert ended.counters.last_step is not None
    last = replace(
        ended.counters.last_step, terminated=True, gathered=-0.99 + 0.9801, discount=0.99**3, bootstrap=0.0
    )
    lines = shown(changed(ended, algorithm="monte-carlo", last_step=last), 60)
    assert any(line.endswith("= 0 + .99·(−1) + .99²·1") and "G₀" not in line for line in lines)


def test_numbers_of_cells_look_as_their_cells_do() -> None:
    widget, palette = Microscope(look()), look().palette
    widget.pair = 0
    styles: dict[Any, list[str]] = {}
    for row in widget.picture(LAKE, NARROW, 60):
        for segment in row:
            styles.setdefault(segment.style, []).append(segment.text)
    assert styles[palette.updated] == [".246", ".239", ".239"]
    assert styles[palette.source] == [".313", ".313"]


def test_the_table_lights_up_what_was_looked_up() -> None:
    table, palette = QTable(look()), look().palette
    table.sources = lit_sources(LAKE)
    best = LAKE.world.space.pairs_of(2)
    (source,) = table.sources
    assert source in best
    assert LAKE.agent.q[source] == LAKE.counters.last_step.bootstrap
    rows = table.picture(LAKE, 50, 14)
    lit = [segment.text.strip() for row in rows for segment in row if segment.style == palette.source]
    assert lit == [f"{LAKE.agent.q[source]:.3f}"]
    assert not lit_sources(changed(LAKE, phase=Phase.RUNNING, speed=None))


def test_the_backup_is_a_tree_over_all_outcomes() -> None:
    lines = part(shown(LAKE), "The backup", "Discounted return")
    assert lines[:6] == [
        " ○ 6",
        " └● ←",
        "  │  went    p  r  s′       max Q(s′,·)",
        " ▸├○ ↑     1/3  0  2               .313",
        "  ├○ ↓     1/3  0  10              .419",
        "  └○ ←     1/3  0  5: hole            0",
    ]
    # (0 + .99·.3126) and a third of (.99·.3126 + 0 + .99·.4190)
    assert lines[6:] == [
        " sampled    r + γ·max Q(2,·) = .3099",
        " expected   Σ p (r + γ V(s′)) = .2415",
        " difference +.0684   luck of this sample",
    ]


def test_where_there_is_room_each_outcome_shows_its_share() -> None:
    lines = shown(LAKE, WIDE, 22)
    text = "\n".join(lines)
    assert "max Q(s′,·)  p·(r + γV)" in text
    assert any(line.endswith("5: hole            0           0") for line in lines)


def test_without_chance_there_is_no_luck() -> None:
    text = "\n".join(shown(with_episode(lake(slippery=False), [0.0]), WIDE, 22))
    assert "difference 0   only one possible outcome" in text


def test_many_outcomes_are_cut_down_to_the_likely_ones_and_what_happened() -> None:
    weights = [1 / 55 * weight for weight in range(1, 11)]
    outcomes = [Outcome(p, state, float(state), True) for state, p in enumerate(weights, start=1)]
    mdp = tabular_mdp([f"s{n}" for n in range(11)], ("go",), [Transition(0, 0, outcomes)], {0: 1.0})
    assert LAKE.counters.last_step is not None
    last = replace(
        LAKE.counters.last_step,
        state=0,
        pair=0,
        updated_pair=0,
        outcome=0,
        next_state=1,
        terminated=True,
        reward=1.0,
        gathered=1.0,
        bootstrap=0.0,
    )
    many = changed(
        LAKE,
        world=World(mdp, Graph(((0, 0),) * 11)),
        q=np.zeros(1),
        visits=np.ones(1, dtype=np.int64),
        last_step=last,
        cell=None,
        solution=None,
    )
    lines = part(shown(many), "The backup", "Discounted return")
    assert len([line for line in lines if "○" in line]) == 8
    assert lines[3].startswith(" ▸├○ .018   1  s1: ends"), lines
    assert "  └… 3 more, together p .164" in lines
    # Σ n²/55 of n = 1 .. 10 is 7
    assert " expected   Σ p (r + γ V(s′)) = 7.00" in lines


def test_of_a_stepped_world_only_the_sample_is_known() -> None:
    lines = shown(with_episode(stepped_lake(), [0.0]))
    text = " ".join(" ".join(lines).split())
    assert "▸└○ ? 0 2" in text
    assert "no expected target: the world has no transition table" in text
    assert "difference" not in text


def test_a_bandit_keeps_its_means_until_they_are_revealed() -> None:
    hidden = with_episode(bandit(400), [2.11])
    text = " ".join(" ".join(shown(hidden)).split())
    assert "expected hidden until w h" in text
    assert "1.5 " not in text.replace("1.5┤", "")
    open_text = " ".join(" ".join(shown(hidden, revealed=True)).split())
    assert "expected mean reward = 1.50" in open_text
    assert "difference +.61" in open_text
    assert "exact 1.500" in open_text


def test_a_planner_takes_the_expectation_itself() -> None:
    known = planning()
    pair, mdp = known.counters.last_step.pair, known.world.mdp
    assert mdp is not None
    values = np.zeros(16)
    values[[2, 10]] = 0.3, 0.42
    last = replace(
        known.counters.last_step, pair=NOTHING, updated_pair=pair, outcome=-1, gathered=0.0, bootstrap=0.24
    )
    lines = shown(changed(known, last_step=last, values=values), WIDE, 30)
    text = " ".join(" ".join(lines).split())
    assert "none: every action is tried" in text
    assert "target Σ p r + γ·Σ p max Q(s′,·) = .238" in text
    assert "a planner uses the expected target" in text
    assert "a planner takes no steps" in text


def test_the_terms_of_the_return() -> None:
    lines = part(shown(LAKE, 60), "Discounted return", "History")
    assert lines == [
        " G₀ = 0 + .99·0 + .99²·0 + … + .99⁵·0 + .99⁶·0 + .99⁷·1",
        "    = .9321   undiscounted 1",
        " Gₜ = Rₜ₊₁ + γ Rₜ₊₂ + γ² Rₜ₊₃ + …",
    ]
    assert part(shown(LAKE, 60, ascii=True), "Discounted return", "History") == [
        " G0 = 0 + .99*0 + ... + .99^5*0 + .99^6*0 + .99^7*1",
        "    = .9321   undiscounted 1",
        " Gt = Rt+1 + gamma Rt+2 + gamma^2 Rt+3 + ...",
    ]
    short = with_episode(lake(), [0.0, -1.0, 1.0])
    assert " G₀ = 0 + .99·(−1) + .99²·1" in shown(short, 60)
    assert " G0 = 0 + .99*(-1) + .99^2*1" in shown(short, 60, ascii=True)


def test_of_a_long_episode_the_last_rewards_are_known() -> None:
    assert LAKE.counters.last_step is not None
    long = changed(
        LAKE,
        rewards=np.zeros(256),
        discounted_return=0.5,
        last_step=replace(LAKE.counters.last_step, episode_step=300),
    )
    lines = part(shown(long, 60), "Discounted return", "History")
    assert lines[0] == " G₀ = … + .99²⁹⁶·0 + .99²⁹⁷·0 + .99²⁹⁸·0 + .99²⁹⁹·0"
    assert lines[1] == "    = .5"


def test_a_discount_changed_on_the_way_is_told() -> None:
    other = changed(LAKE, discounted_return=0.5)
    assert "γ changed in this episode" in "\n".join(shown(other, 60))


def test_without_a_discount_rewards_are_added_up() -> None:
    assert LAKE.counters.last_step is not None
    plain = changed(
        LAKE,
        last_step=replace(LAKE.counters.last_step, gamma=1.0, episode_step=3),
        rewards=np.array([-1.0, -1.0, 2.0]),
    )
    assert " G₀ = −1 + (−1) + 2" in shown(plain, 60) or " G₀ = (−1) + (−1) + 2" in shown(plain, 60)


def test_the_history_of_the_cell_has_its_value_and_the_exact_one() -> None:
    lines = shown(LAKE, 60)
    heading = next(line for line in lines if line.startswith(" History of Q(6,←)"))
    assert "now 0.246, exact 0.358" in heading
    curve = lines[lines.index(heading) + 1 :]
    assert any("┈" in line for line in curve)
    assert any(chr(0x2800) < character <= chr(0x28FF) for line in curve for character in line)
    assert any(line.strip().startswith("└0") and line.endswith(" step") for line in curve)


def test_a_history_that_is_not_there_yet_comes_with_the_next_picture() -> None:
    assert " loading …" in shown(changed(LAKE, cell=None))


def test_before_the_first_step_it_says_what_to_press() -> None:
    for nothing in (None, lake(0)):
        assert shown(nothing)[0].strip() == "no step yet: s takes one"


def test_steps_that_pass_too_fast_leave_the_history_only() -> None:
    fast = changed(LAKE, phase=Phase.RUNNING, speed=None)
    lines = shown(fast, 80)
    assert " steps pass too fast to show one: space pauses, − slows down" in lines
    still = shown(LAKE, 80)
    headings = [" The step", " The update", " The backup", " Discounted return so far", " History of Q(6,←)"]
    for heading in headings:
        assert [line.startswith(heading) for line in lines].index(True) == [
            line.startswith(heading) for line in still
        ].index(True)
    assert not any("Q(6,←) ←" in line for line in lines)


def test_what_does_not_fit_is_scrolled_with_a_bar_and_a_hint() -> None:
    widget = Microscope(look())
    for height in (17, 60):
        widget.picture(LAKE, NARROW, height)
        assert widget.footing == "tab here for its keys · esc: close"
    widget.has_focus = True
    rows = widget.picture(LAKE, NARROW, 17)
    assert widget.footing == "↑ ↓: more · esc: close"
    assert all(row.text[-1] in "█│" for row in rows)
    top, end = shown(LAKE, NARROW, 17), shown(LAKE, NARROW, 17, scrolled=999)
    assert "The step" in top[0]
    assert " step" in end[-1]
    widget.picture(LAKE, NARROW, 60)
    assert widget.footing == "tab: another cell · esc: close"


@pytest.mark.exhaustive("every algorithm at every size", but=["q-learning", "n-step-sarsa"])
@pytest.mark.parametrize("algorithm", [each.id for each in BY_ID.values() if not each.planner])
def test_every_algorithm_is_told_at_any_size(algorithm: str) -> None:
    told = with_episode(changed(lake(), algorithm=algorithm), [0.0, 1e-9, -3.25])
    last = told.counters.last_step
    assert last is not None
    others = changed(told, last_step=replace(last, others=7))
    waiting = changed(told, last_step=replace(last, updated_pair=NOTHING, before=0.0, bootstrap=0.0))
    for snapshot in (others, waiting):
        for width in (1, 8, 20, 39, 58, 96, 140):
            for height in (1, 4, 17, 50):
                shown(snapshot, width, height, ascii=height == 17)
