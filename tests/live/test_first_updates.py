"""The wait for the first update in snapshots."""

from __future__ import annotations

import pytest
from open_grids import open_grid_recipe
from playing import begin, do

from rl_tui.agents.exact.first_update import Cause, FirstUpdate, Wait, first_update
from rl_tui.agents.hyperparameters import Hyperparameters, Ties
from rl_tui.live.commands import Apply, AskWhy, EpisodeBack, RunEpisode, Train
from rl_tui.live.playback import Playback
from rl_tui.runs.answers.first_update_words import cause_in_words, episodes_in_words, wait_in_words
from rl_tui.runs.answers.view import MANY_EPISODES, TOO_LARGE
from rl_tui.runs.exact_answers import NO_TABLE
from rl_tui.runs.library import recipe_for
from rl_tui.runs.recipe import SetParameter
from rl_tui.worlds.files.catalogue import find

TIES: tuple[Ties, ...] = ("first", "random")


def playback(scenario: str = "frozenlake", **values: object) -> Playback:
    return begin(recipe_for(find(scenario), values, 0))


def test_nothing_is_said_before_many_episodes_unless_it_is_asked() -> None:
    run = playback(ties="first")
    few = do(run, *[RunEpisode()] * (MANY_EPISODES - 1))
    assert few.answers.first_update is None
    many = do(run, RunEpisode()).answers.first_update
    assert (many.is_long, many.has_moved) == (True, False)
    assert many.answer.wait.median_episodes == 127_966
    assert do(run, EpisodeBack()).answers.first_update is None
    asked = do(run, AskWhy(is_asked=True)).answers.first_update
    assert not asked.is_long
    assert do(run, AskWhy(is_asked=False)).answers.first_update is None


def test_it_is_that_of_the_settings_in_force_and_of_the_q_it_began_with() -> None:
    run = playback(ties="first", initial_q=1.0, gamma=1.0)
    changed = do(run, AskWhy(is_asked=True), Apply(SetParameter("ties", "random")))
    view, world = changed.answers.first_update, changed.world
    assert world.mdp is not None
    settings = run.group.current.run.recipe.hyperparameters.changed("ties", "random")
    assert view.answer == first_update(world.mdp, "q-learning", settings)


def test_once_an_estimate_has_moved_nothing_is_said_unless_it_is_asked() -> None:
    run = playback("cliff")
    assert do(run, Train(2_000)).answers.first_update is None
    asked = do(run, AskWhy(is_asked=True)).answers.first_update
    assert (asked.has_moved, asked.is_long) == (True, False)


def test_where_there_is_no_answer_it_is_said_why() -> None:
    refused = []
    for scenario, values in (("frozenlake", {"policy": "softmax"}), ("discount", {}), ("blackjack", {})):
        view = do(playback(scenario, **values), AskWhy(is_asked=True)).answers.first_update
        assert view.answer is None
        refused.append(view.refused)
    assert "softmax" in refused[0]
    assert "plans with the model" in refused[1]
    assert refused[2] == NO_TABLE


def test_a_large_world_is_left_to_the_command() -> None:
    view = do(begin(open_grid_recipe(80)), AskWhy(is_asked=True)).answers.first_update
    assert view.refused == TOO_LARGE


def test_every_cause_is_said_in_words_of_its_own() -> None:
    wait = Wait(0.001, 1_000.0, 693)
    said = {
        cause_in_words(FirstUpdate(wait, cause, 6, ()), Hyperparameters(ties=ties), 100)
        for cause in (None, *Cause)
        for ties in TIES
    }
    assert len(said) == len(Cause) + 2  # random ties are mentioned without a cause
    assert not any("\n" in words or words.endswith(".") for words in said)
    assert cause_in_words(FirstUpdate(Wait(1.0, 1.0, 1), None, 1, ()), Hyperparameters(), 0) == ""


@pytest.mark.parametrize(
    ("number", "text"),
    [(1, "1"), (71.737, "71.7"), (526, "526"), (184_615.95, "184,616"), (6.235e15, "6.24e15")],
)
def test_numbers_of_episodes(number: float, text: str) -> None:
    assert episodes_in_words(number) == text


def test_a_wait_without_a_mean_says_so() -> None:
    assert "no mean" in wait_in_words(Wait(0.25, None, None))
    assert "3 or fewer" in wait_in_words(Wait(0.25, 4.0, 3))
