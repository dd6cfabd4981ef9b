"""Questions for a setting of the agent."""

from __future__ import annotations

import re
from typing import Final

from rl_tui.agents.catalogue import BY_ID, POLICY_BY_ID, Algorithm, Policy
from rl_tui.agents.compatibility import check_compatible
from rl_tui.agents.hyperparameters import PARAMETERS, SAMPLE_AVERAGE, Hyperparameters, Parameter
from rl_tui.common.errors import UserError
from rl_tui.runs.recipe import Recipe
from rl_tui.screen.dialogs.form import Candidate, Choice, Form, Prompt, TypedLine
from rl_tui.screen.kit.bindings import as_sentence
from rl_tui.screen.panels.controls.settings import option_text
from rl_tui.screen.panels.controls.slider_picture import parsed
from rl_tui.screen.theme.glyphs import Glyphs
from rl_tui.worlds.mdp.space import FiniteSpace

# Algorithm and policy


_TAKEN: Final = "used by this run"


def algorithm_choice(
    space: FiniteSpace, recipe: Recipe, glyphs: Glyphs, title: str = "", *, taken: str = ""
) -> Choice:
    """Return the algorithms, other than ``taken`` for another run."""
    candidates = [
        _candidate(each, _TAKEN if each.id == taken else _refused(space, each.id, recipe.hyperparameters))
        for each in BY_ID.values()
    ]
    if not title:
        return Choice("Algorithm", candidates, recipe.algorithm, glyphs)
    start = next((each.id for each in candidates if not each.refused), "")
    return Choice(title, candidates, "", glyphs, start=start)


def policy_choice(space: FiniteSpace, recipe: Recipe, glyphs: Glyphs) -> Choice:
    """Return the policies, with reasons against some."""
    values = recipe.hyperparameters.without_average()
    candidates = (
        _candidate(each, _refused(space, recipe.algorithm, values.changed("policy", each.id)))
        for each in POLICY_BY_ID.values()
    )
    return Choice("Policy: how actions are chosen", candidates, recipe.hyperparameters.policy, glyphs)


def _candidate(row: Algorithm | Policy, refused: str) -> Candidate:
    lines = (as_sentence(row.summary), row.equation, f"Sutton & Barto, 2nd ed., {row.source}")
    words = re.split(r"[:,;]", row.summary, maxsplit=1)[0]
    return Candidate(row.id, row.name, lines, refused, words=words)


def _refused(space: FiniteSpace, algorithm: str, values: Hyperparameters) -> str:
    try:
        check_compatible(space, algorithm, values)
    except UserError as fault:
        return str(fault)
    return ""


# Numbers, words and the seed


_EXAMPLES = {"initial_q": "0 or 2.5"}
_MEANINGS = {
    "constant": ("The same in every episode.",),
    "linear": ("Each episode subtracts the decay, down to the minimum.",),
    "exponential": ("Exponential decay to the minimum: min + (start − min) · exp(−decay · episode)",),
    SAMPLE_AVERAGE: ("1/N: the mean of all targets so far.",),
}


def ask_value(name: str, value: float | str, glyphs: Glyphs, *, another_run: bool = False) -> Form:
    """Ask for a number or a word, maybe of ``another_run``."""
    parameter = PARAMETERS[name]
    if parameter.range is None:
        candidates = (
            Candidate(word, word.replace("-", " "), _MEANINGS.get(word, ())) for word in parameter.words
        )
        return Choice(f"{parameter.symbol}: {parameter.help}", candidates, str(value), glyphs)
    starts = "; the run starts again" if name == "initial_q" and not another_run else ""
    word = "; 1/N is the sample average" if SAMPLE_AVERAGE in parameter.words else ""

    def read(text: str) -> float | str:
        try:
            return parsed(text, parameter)
        except ValueError:
            raise ValueError(glyphs.spelled(_expected(parameter))) from None

    title = "Initial Q" if name == "initial_q" else parameter.symbol
    hint = f"{parameter.help}{word}{starts}"
    return Prompt(glyphs.spelled(title), glyphs.spelled(hint), option_text(value), read)


def ask_seed(seed: int, glyphs: Glyphs) -> Form:
    """Ask for the seed, now ``seed``."""
    candidates = (
        Candidate(str(seed), "the same seed", ("The same run again.",), value=str(seed)),
        Candidate(
            str(seed + 1), "the next seed", ("Another run with the same settings.",), value=str(seed + 1)
        ),
    )
    hint = "The same seed gives the same run. The run starts again."
    return Form(
        "Seed", candidates, "", glyphs, entry=TypedLine(str(seed), hint, _read_seed), does="start again"
    )


def _expected(parameter: Parameter) -> str:
    if parameter.name in _EXAMPLES and parameter.range is not None:
        ends = f"from {parameter.range.low:g} to {parameter.range.high:g}".replace("e+", "e")
        return f"type a number {ends}, such as {_EXAMPLES[parameter.name]}"
    return f"type {parameter.expected_in_words}"


def _read_seed(text: str) -> int:
    if not (text.isascii() and text.isdigit()):
        raise ValueError("type a whole number, 0 or more")
    return int(text)
