"""Environments without a table."""

from __future__ import annotations

import io
import math
import sys
import threading
import warnings
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium import spaces

from rl_tui.worlds.environment import EnvironmentFailedError, StepResult
from rl_tui.worlds.gym import env_call
from rl_tui.worlds.gym.env_call import ENVIRONMENT_CALL, seconds_in_call
from rl_tui.worlds.gym.registered import SteppedEnvironment, stepped_world
from rl_tui.worlds.gym.section import GymnasiumSection
from rl_tui.worlds.sections.schema import WorldRefusedError


class Scripted(gymnasium.Env[Any, Any]):
    closed = 0

    def __init__(self, observation_space=None, action_space=None, start=0, answer=None, **attributes):
        self.observation_space = observation_space or spaces.Discrete(3)
        self.action_space = action_space or spaces.Discrete(2)
        self._start, self._answer = start, answer
        self.taken: list[Any] = []
        for name, value in attributes.items():
            setattr(self, name, value)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        answer = self.scripted(self._start)
        return answer if isinstance(answer, tuple) else (answer, {})

    def step(self, action):
        self.taken.append(action)
        return self.scripted(self._answer)

    def close(self):
        type(self).closed += 1

    def scripted(self, answer):
        if isinstance(answer, BaseException):
            raise answer
        return answer


class UnwritableError(Exception):
    def __str__(self):
        raise RuntimeError("no text")


class Printing(Scripted):
    def __init__(self, **kwargs):
        super().__init__(answer=(0, 0.0, True, False, {}), **kwargs)
        print("made")

    def reset(self, *, seed=None, options=None):
        print("reset")
        return 0, {}

    def step(self, action):
        print("stepped")
        return super().step(action)

    def close(self):
        print("closed")


@pytest.fixture(autouse=True)
def scripted_environment():
    gymnasium.register("Scripted-v0", Scripted)
    yield
    del gymnasium.registry["Scripted-v0"]


def environment(**kwargs: Any) -> SteppedEnvironment:
    world = stepped_world("Scripted-v0", kwargs)
    assert world.new_environment is not None
    return world.new_environment()


def test_a_blackjack_hand_is_told_in_words():
    world = GymnasiumSection(id="Blackjack-v1").build(np.random.default_rng(0))
    assert world.mdp is None
    assert (world.space.states, world.space.pairs, world.space.time_limit) == (704, 1408, 0)
    assert world.space.state_names[(12 * 11 + 7) * 2] == "12, 7, no"
    assert world.space.action_names == ("stick", "hit")


def test_hands_of_blackjack_that_come_up_have_a_cell_each_and_all_others_share_one():
    drawing = GymnasiumSection(id="Blackjack-v1").build(np.random.default_rng(0)).drawing
    assert (drawing.rows, drawing.columns) == (18, 21)
    of_cell = Counter(drawing.cell_of_state)
    assert sorted(of_cell.values()) == [1] * (18 * 10 + 10 * 10) + [704 - 280]
    assert drawing.cell_of_state[(21 * 11 + 1) * 2] == 0
    bust = drawing.cell_of_state[(23 * 11 + 7) * 2]
    assert of_cell[bust] > 1
    assert drawing.cell_of_state[(20 * 11 + 0) * 2] == bust


def test_the_seed_is_that_of_gymnasium():
    world = stepped_world("Blackjack-v1", {})
    plain = gymnasium.make("Blackjack-v1")
    ours = world.new_environment()
    names = world.space.state_names
    for seed in range(20):
        total, card, ace = plain.reset(seed=seed)[0]
        assert names[ours.reset(seed)] == f"{total}, {card}, {'yes' if ace else 'no'}"
        (total, card, ace), reward, terminated, _, _ = plain.step(1)
        answer = ours.step(1)
        assert names[answer.next_state] == f"{total}, {card}, {'yes' if ace else 'no'}"
        assert (answer.reward, answer.terminated) == (reward, terminated)


def test_actions_count_from_their_own_start():
    taken = []
    ours = environment(
        action_space=spaces.Discrete(2, start=5), answer=(1, 2.0, False, False, {}), taken=taken
    )
    ours.reset(0)
    assert ours.step(1) == StepResult(1, 2.0, False, False)
    assert taken == [6]
    assert stepped_world("Scripted-v0", {"action_space": spaces.Discrete(2, start=5)}).space.action_names == (
        "5",
        "6",
    )


def test_terminated_wins_over_truncated():
    ours = environment(answer=(1, 0.0, True, True, {}))
    ours.reset(0)
    assert ours.step(0) == StepResult(1, 0.0, True, False)


def test_the_time_limit_is_the_environments_own():
    world = stepped_world("Scripted-v0", {"max_episode_steps": 2, "answer": (0, 0.0, False, False, {})})
    ours = world.new_environment()
    ours.reset(0)
    assert [ours.step(0).truncated for _ in range(2)] == [False, True]
    assert world.space.time_limit == 2


@pytest.mark.parametrize(
    ("answer", "message"),
    [
        (RuntimeError("no\x1b[2J\nroom"), "Scripted-v0 failed in a step: RuntimeError: no\\u001b[2J room"),
        (ValueError("x" * 5000), "Scripted-v0 failed in a step: ValueError: xxx"),
        ((0, math.nan, False, False, {}), "Scripted-v0 returned the reward nan"),
        ((0, math.inf, False, False, {}), "Scripted-v0 returned the reward inf"),
        ((0, None, False, False, {}), "Scripted-v0 returned the reward None instead of a finite number"),
        ((0, "3.5", False, False, {}), "Scripted-v0 returned the reward '3.5' instead of a finite number"),
        ((0, 10**400, False, False, {}), "Scripted-v0 returned the reward "),
        ((0, 1j, False, False, {}), "Scripted-v0 returned the reward 1j"),
        ((0, np.zeros(2), False, False, {}), "Scripted-v0 returned the reward [0. 0.]"),
        (
            (0, 0.0, None, False, {}),
            "Scripted-v0 returned terminated = None instead of true or false",
        ),
        ((0, 0.0, False, "False", {}), "Scripted-v0 returned truncated = 'False' instead of"),
        ((0, 0.0, math.nan, False, {}), "Scripted-v0 returned terminated = nan"),
        ((-1, 0.0, False, False, {}), "Scripted-v0 returned the observation -1, which is outside"),
        ((1.5, 0.0, False, False, {}), "Scripted-v0 returned the observation 1.5, which is outside"),
        (
            ("\x1b[2J", 0.0, False, False, {}),
            "Scripted-v0 returned the observation '\\x1b[2J', which is outside",
        ),
        (((0, 0), 0.0, False, False, {}), "Scripted-v0 returned the observation (0, 0), which is outside"),
        ((3, 0.0, False, False, {}), "Scripted-v0 returned the observation 3, which is outside"),
        ((None, 0.0, False, False, {}), "Scripted-v0 returned the observation None, which is outside"),
        (
            (UnwritableError(), 0.0, False, False, {}),
            "Scripted-v0 returned the observation a UnwritableError without readable text",
        ),
        ((0, 0.0, False, {}), "Scripted-v0 returned 4 values from step instead"),
        (None, "Scripted-v0 returned None from step"),
        (
            UnwritableError(),
            "Scripted-v0 failed in a step: UnwritableError: a UnwritableError without readable text",
        ),
        (SystemExit(3), "Scripted-v0 failed in a step: SystemExit: 3"),
        (MemoryError(), "Scripted-v0 failed in a step: MemoryError"),
        (GeneratorExit(), "Scripted-v0 failed in a step: GeneratorExit"),
    ],
)
def test_a_fault_in_a_step_is_one_clear_line(answer, message):
    ours = environment(answer=answer)
    ours.reset(0)
    with pytest.raises(EnvironmentFailedError) as failure:
        ours.step(0)
    text = str(failure.value)
    assert text.startswith(message)
    assert text.isprintable()
    assert len(text) < 300


def test_a_fault_at_the_start_is_one_clear_line():
    with pytest.raises(EnvironmentFailedError, match=r"^Scripted-v0 failed to start: OSError: gone$"):
        environment(start=OSError("gone")).reset(0)
    with pytest.raises(EnvironmentFailedError, match=r"^Scripted-v0 returned the observation 9, which"):
        environment(start=9).reset(0)
    with pytest.raises(EnvironmentFailedError, match=r"^Scripted-v0 returned \(0, 1, 2\) from reset instead"):
        environment(start=(0, 1, 2)).reset(0)
    with pytest.raises(EnvironmentFailedError, match=r"^Scripted-v0 failed to start: SystemExit: 2$"):
        environment(start=SystemExit(2)).reset(0)


def test_ctrl_c_is_no_fault_of_the_environment():
    """Only the main thread receives ctrl+C. If another thread raises it, no key was pressed."""
    ours = environment(answer=KeyboardInterrupt())
    ours.reset(0)
    with pytest.raises(KeyboardInterrupt):
        ours.step(0)
    with ThreadPoolExecutor(1) as pool, pytest.raises(EnvironmentFailedError, match=r"KeyboardInterrupt$"):
        pool.submit(ours.step, 0).result()


@pytest.mark.parametrize(
    ("reward", "number"),
    [(2, 2.0), (True, 1.0), (np.float32(0.5), 0.5), (np.array([0.25]), 0.25), (np.array(-1), -1.0)],
)
def test_whatever_is_one_number_is_a_reward(reward, number):
    ours = environment(answer=(0, reward, np.bool_(False), 0, {}))
    ours.reset(0)
    assert ours.step(0) == StepResult(0, number, False, False)


def test_what_an_environment_prints_is_no_result(capsys):
    gymnasium.register("Printing-v0", Printing)
    try:
        world = stepped_world("Printing-v0", {})
        assert world.new_environment is not None
        ours = world.new_environment()
        ours.reset(0)
        ours.step(0)
        del ours
    finally:
        del gymnasium.registry["Printing-v0"]
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err.split() == ["made", "closed", "made", "reset", "stepped", "closed"]


def test_streams_that_were_exchanged_meanwhile_stay(monkeypatch):
    """The driver of the terminal may take it back while an environment is still at work."""
    monkeypatch.setattr("sys.stdout", io.StringIO())
    with ENVIRONMENT_CALL:
        assert sys.stdout is sys.stderr
        taken_back = sys.stdout = io.StringIO()
    assert sys.stdout is taken_back
    with ENVIRONMENT_CALL:
        pass
    assert sys.stdout is taken_back


def test_an_environment_may_be_closed_while_another_is_asked(monkeypatch):
    """Garbage collection may close an unused environment at any time, and no lock may wait for itself."""
    before = io.StringIO()
    monkeypatch.setattr("sys.stdout", before)
    for lock in (env_call._LOCK, ENVIRONMENT_CALL):
        with lock, ENVIRONMENT_CALL:
            assert sys.stdout is sys.stderr
    assert sys.stdout is before


def test_how_long_an_environment_has_not_answered():
    here, inside = threading.get_ident(), []
    ours = environment(
        answer=(0, 0.0, False, False, {}),
        scripted=lambda answer: inside.append(seconds_in_call(here)) or answer,
    )
    ours.reset(0)
    ours.step(0)
    assert len(inside) == 2
    assert min(inside) > 0.0
    assert seconds_in_call(here) == seconds_in_call(None) == 0.0


def test_other_spaces_than_the_time_before_are_refused():
    class Changing(Scripted):
        made = 0

        def __init__(self):
            type(self).made += 1
            super().__init__(spaces.Discrete(3 + type(self).made))

    gymnasium.register("Changing-v0", Changing)
    try:
        world = stepped_world("Changing-v0", {})
        with pytest.raises(EnvironmentFailedError, match="changed its spaces"):
            world.new_environment()
    finally:
        del gymnasium.registry["Changing-v0"]


def test_an_environment_that_cannot_even_be_read_is_refused():
    class Secret(Scripted):
        @property
        def observation_space(self):
            raise RuntimeError("not for you")

        @observation_space.setter
        def observation_space(self, space):
            pass

    gymnasium.register("Secret-v0", Secret)
    try:
        with pytest.raises(WorldRefusedError, match=r"does not declare .* \(RuntimeError: not for you\)"):
            stepped_world("Secret-v0", {})
        with pytest.raises(WorldRefusedError, match="not for you"):
            GymnasiumSection(id="Secret-v0").build(None)
    finally:
        del gymnasium.registry["Secret-v0"]


def test_nothing_is_warned_about():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        ours = environment(answer=(0, 0.0, True, False, {}))
        ours.reset(0)
        ours.step(0)
        ours.step(0)
        assert gymnasium.logger.min_level > gymnasium.logger.ERROR


def test_it_is_closed_when_nobody_holds_it():
    ours, before = environment(), Scripted.closed
    del ours
    assert Scripted.closed == before + 1


@pytest.mark.parametrize(
    ("kwargs", "key", "found"),
    [
        ({"observation_space": spaces.Discrete(1_000_001)}, "id", "1,000,001 states of Scripted-v0"),
        ({"observation_space": spaces.MultiBinary(20_000)}, "id", "more than 10\\^15 states of Scripted-v0"),
        ({"action_space": spaces.Discrete(10_001)}, "id", "10,001 actions of Scripted-v0"),
        (
            {"observation_space": spaces.Discrete(10_001), "action_space": spaces.Discrete(1_000)},
            "id",
            "10,001,000 pairs of a state and an action of Scripted-v0",
        ),
        (
            {"action_space": spaces.Box(0.0, 1.0)},
            "id",
            "the actions of Scripted-v0 are Box; choose one with discrete actions",
        ),
        (
            {"observation_space": spaces.Text(3)},
            "id",
            "the states of Scripted-v0 are Text; choose one with discrete states",
        ),
        (
            {"observation_space": spaces.Box(0.0, 1.0, (2, 2))},
            "id",
            "Scripted-v0 returns 4 real numbers .a Box., not numbered states; "
            "write a scenario file with .gymnasium.bins., which turns them into states",
        ),
    ],
)
def test_refuses(kwargs, key, found):
    with pytest.raises(WorldRefusedError) as refusal:
        stepped_world("Scripted-v0", kwargs)
    assert refusal.value.finding.location == (key,)
    assert refusal.match(found)


UNSOUND = {s: {a: [(0.5, 0, 0.0, False)] for a in (0, 1)} for s in range(3)}


def test_by_its_table_where_it_has_one_and_stepped_where_not():
    sound = {s: {a: [(1.0, 0, 0.0, True)] for a in (0, 1)} for s in range(3)}
    start = np.array([1.0, 0.0, 0.0])

    def tabled(table: object, use_table: bool | None = None) -> bool:
        kwargs = {"P": table, "initial_state_distrib": start}
        return GymnasiumSection(id="Scripted-v0", kwargs=kwargs, table=use_table).build(None).mdp is not None

    assert tabled(sound)
    assert not tabled(sound, False)
    assert not tabled(None)
    assert not tabled({s: {a: [(1.0, 0, 0.0)] for a in (0, 1)} for s in range(3)})
    with pytest.raises(WorldRefusedError, match=r"sum to 0\.5"):
        tabled(UNSOUND, True)
    with pytest.raises(WorldRefusedError, match=r"sum to 0\.5"):
        tabled(UNSOUND)
    assert not tabled(UNSOUND, False)
    with pytest.raises(WorldRefusedError, match="Scripted-v0 has no transition table"):
        GymnasiumSection(id="Scripted-v0", table=True).build(None)


def test_a_failing_start_is_found_when_the_file_is_checked():
    (finding,) = GymnasiumSection(id="Scripted-v0", kwargs={"start": OSError("gone")}).environment_findings()
    assert finding.found == "Scripted-v0 failed to start: OSError: gone; choose another environment"
