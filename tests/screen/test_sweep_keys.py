"""Evaluation and improvement apart, with real keys: what is done, what is drawn and what is said."""

from __future__ import annotations

import re

from conftest import MakeApp
from drawn_text import words_of
from seams import notes, on_screen, playground, press, screen_text, switch
from textual.widgets import OptionList

from rl_tui.live.snapshot import Phase
from rl_tui.screen.frame.key_line import KeyLine

SIZE = (80, 24)

ARROWS = re.compile("▐█████|█████▌|▟████▙")  # blocks, not those of rings and stars


async def test_a_key_for_a_sweep_of_each_kind_and_its_entry_in_the_journal(make_app: MakeApp) -> None:
    async with on_screen(make_app("frozenlake"), SIZE) as pilot:
        await switch(pilot, "policy-iteration")
        world = playground(pilot).board.world
        evaluated = await press(pilot, "E")
        assert not ARROWS.search(screen_text(pilot.app))  # each of its actions is as likely
        assert world.policy_shown == "policy"
        evaluated = await press(pilot, "E")
        assert (evaluated.counters.episodes, evaluated.agent.sweep) == (2, "evaluation")
        assert evaluated.agent.planning.startswith("policy 1, evaluation sweep 2: ")
        improved = await press(pilot, "I")
        assert ARROWS.search(screen_text(pilot.app))
        assert (improved.counters.episodes, improved.agent.sweep) == (3, "improvement")
        assert improved.agent.planning == "policy 1, improvement: 5 states changed"
        assert improved.playback.phase is Phase.PAUSED
        assert "π(14) ← argmax{" in screen_text(pilot.app)
        await press(pilot, "j")
        entries = pilot.app.screen.query_one("#entries", OptionList)
        listed = [str(entries.get_option_at_index(place).prompt) for place in range(entries.option_count)]
        assert listed[-1] == "step 22: next sweep: improvement"
        assert "step 0: next sweep: evaluation" in listed
        await press(pilot, "escape")
        back = await press(pilot, "B")
        assert back.agent.policy.tolist() == evaluated.agent.policy.tolist()
        assert back.agent.planning.endswith("; then improvement")


async def test_the_key_line_has_them_where_they_do_something_else_they_say_whose_they_are(
    make_app: MakeApp,
) -> None:
    async with on_screen(make_app("frozenlake"), SIZE) as pilot:
        line, world = pilot.app.screen.query_one(KeyLine), playground(pilot).board.world
        assert "E I" not in words_of(line)
        await press(pilot, "E")
        assert notes(pilot.app) == ["E evaluates the policy of policy iteration: a chooses that"]
        shown = await press(pilot, "I")
        assert notes(pilot.app)[-1] == "I improves the policy of policy iteration: a chooses that"
        assert (shown.counters.step, shown.agent.algorithm) == (0, "q-learning")
        await switch(pilot, "policy-iteration")
        assert "E I eval, improve" in words_of(line)
        await switch(pilot, "value-iteration")
        assert "E I" not in words_of(line)
        assert world.policy_shown == "greedy"


async def test_the_state_backed_up_last_is_the_one_marked(make_app: MakeApp) -> None:
    async with on_screen(make_app("student"), SIZE) as pilot:
        await switch(pilot, "value-iteration")
        for _ in range(5):
            shown = await press(pilot, "s")
            assert shown.counters.state == shown.counters.last_step.state
