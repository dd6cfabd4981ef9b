"""Evaluation and improvement apart, with real keys."""

from __future__ import annotations

import re

from conftest import MakeApp
from seams import on_screen, playground, press, screen_text, switch
from textual.widgets import OptionList

from rl_tui.live.snapshot import Phase

SIZE = (80, 24)

ARROWS = re.compile("▐█████|█████▌|▟████▙")  # blocks without rings and stars


async def test_a_key_for_a_sweep_of_each_kind_and_its_entry_in_the_journal(make_app: MakeApp) -> None:
    async with on_screen(make_app("frozenlake"), SIZE) as pilot:
        await switch(pilot, "policy-iteration")
        world = playground(pilot).board.world
        evaluated = await press(pilot, "a", "e")
        assert not ARROWS.search(screen_text(pilot.app))  # each of its actions is as likely
        assert world.policy_shown == "policy"
        evaluated = await press(pilot, "a", "e")
        assert (evaluated.counters.episodes, evaluated.agent.sweep) == (2, "evaluation")
        assert evaluated.agent.planning.startswith("policy 1, evaluation sweep 2: ")
        improved = await press(pilot, "a", "i")
        assert ARROWS.search(screen_text(pilot.app))
        assert (improved.counters.episodes, improved.agent.sweep) == (3, "improvement")
        assert improved.agent.planning == "policy 1, improvement: 5 states changed"
        assert improved.playback.phase is Phase.PAUSED
        assert "π(14) ← argmax{" in screen_text(pilot.app)
        await press(pilot, "m", "b", "tab")
        listed = [str(option.prompt)[4:] for option in pilot.app.screen.query_one(OptionList).options]
        assert listed[-1] == "step 22: next sweep: improvement"
        assert "step 0: next sweep: evaluation" in listed
        await press(pilot, "escape", "escape")
        back = await press(pilot, "B")
        assert back.agent.policy.tolist() == evaluated.agent.policy.tolist()
        assert back.agent.planning.endswith("; then improvement")


async def test_agents_without_such_sweeps_say_whose_they_are(make_app: MakeApp) -> None:
    async with on_screen(make_app("frozenlake"), SIZE) as pilot:
        world = playground(pilot).board.world
        await press(pilot, "a")
        for letter in ("e", "i"):
            shown = await press(pilot, letter)
            assert "only policy iteration has such sweeps. a a: choose it." in screen_text(pilot.app)
            assert (shown.counters.step, shown.agent.algorithm) == (0, "q-learning")
        await press(pilot, "escape")
        await switch(pilot, "value-iteration")
        assert world.policy_shown == "greedy"


async def test_the_state_backed_up_last_is_the_one_marked(make_app: MakeApp) -> None:
    async with on_screen(make_app("student"), SIZE) as pilot:
        await switch(pilot, "value-iteration")
        for _ in range(5):
            shown = await press(pilot, "s")
            assert shown.counters.state == shown.counters.last_step.state
