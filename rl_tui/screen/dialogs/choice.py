"""Questions for a setting of the agent: pick from a list, or type a value.

Unavailable options stay in the list, greyed out, with the reason.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from rich.text import Text
from textual.app import ComposeResult
from textual.widgets import OptionList, Static
from textual.widgets.option_list import Option

from rl_tui.agents.catalogue import BY_ID, POLICY_BY_ID, Algorithm, Policy
from rl_tui.agents.compatibility import check_compatible
from rl_tui.agents.hyperparameters import PARAMETERS, SAMPLE_AVERAGE, Hyperparameters, Parameter
from rl_tui.common.errors import UserError
from rl_tui.runs.recipe import Recipe
from rl_tui.screen.dialogs.dialog import Dialog, Prompt
from rl_tui.screen.draw.to_ascii import to_ascii
from rl_tui.screen.panels.controls.settings import option_text
from rl_tui.screen.panels.controls.slider_picture import parsed
from rl_tui.screen.theme.glyphs import Glyphs
from rl_tui.worlds.mdp.space import FiniteSpace

# Choice from a list


@dataclass(frozen=True, slots=True)
class Candidate:
    """One that may be chosen: ``lines`` describe it; ``refused`` says why it cannot be, empty if it can."""

    id: str
    name: str
    lines: tuple[str, ...] = ()
    refused: str = ""


class Choice(Dialog[str]):
    """A list of candidates. Answers the id of the one chosen; escape answers None.

    ``current`` is the id of the one in force, empty where none is. ``question`` stands above the list.
    """

    def __init__(
        self, title: str, candidates: Iterable[Candidate], current: str, glyphs: Glyphs, question: str = ""
    ) -> None:
        super().__init__()
        self._title = title
        self._question = question
        self.candidates = tuple(candidates)
        self._current = current
        self._glyphs = glyphs

    def compose(self) -> ComposeResult:
        """Yield the list."""
        with self.box(to_ascii(self._title, self._glyphs), "enter: choose   esc: close"):
            if self._question:
                yield Static(to_ascii(self._question, self._glyphs), classes="hint", markup=False)
            yield OptionList(
                *(
                    Option(self.describe(each), id=each.id, disabled=bool(each.refused))
                    for each in self.candidates
                )
            )

    def on_mount(self) -> None:
        """Start on the one in force, else on the first."""
        choices = self.query_one(OptionList)
        choices.highlighted = choices.get_option_index(self._current) if self._current else 0
        choices.focus()

    def on_option_list_option_selected(self, event: OptionList.OptionSelected) -> None:
        """Answer the chosen one."""
        self.dismiss(event.option_id)

    def describe(self, candidate: Candidate) -> Text:
        """Return how the list writes ``candidate``."""
        in_force = "  (in force)" if candidate.id == self._current else ""
        text = Text(to_ascii(f"{candidate.name}{in_force}", self._glyphs), "bold")
        lines = (*candidate.lines, f"Not here: {candidate.refused}") if candidate.refused else candidate.lines
        for line in lines:
            text.append(to_ascii(f"\n{line}", self._glyphs), "not bold")
        return text


def algorithm_choice(space: FiniteSpace, recipe: Recipe, glyphs: Glyphs) -> Choice:
    """Return the choice among all algorithms; those that cannot work in ``space`` are marked."""
    candidates = (
        _candidate(each, _refused(space, each.id, recipe.hyperparameters)) for each in BY_ID.values()
    )
    return Choice("Algorithm", candidates, recipe.algorithm, glyphs)


def choice_beside_program(space: FiniteSpace, recipe: Recipe, glyphs: Glyphs) -> Choice:
    """Return the choice of an agent of ours, with the settings of ``recipe``, beside somebody's program."""
    candidates = (
        _candidate(each, _refused(space, each.id, recipe.hyperparameters)) for each in BY_ID.values()
    )
    return Choice("An agent of ours beside your program", candidates, "", glyphs)


def policy_choice(space: FiniteSpace, recipe: Recipe, glyphs: Glyphs) -> Choice:
    """Return the choice among all policies; those that cannot work in ``space`` are marked."""
    values = recipe.hyperparameters.without_average()
    candidates = (
        _candidate(each, _refused(space, recipe.algorithm, values.changed("policy", each.id)))
        for each in POLICY_BY_ID.values()
    )
    return Choice("Policy: how actions are chosen", candidates, recipe.hyperparameters.policy, glyphs)


def word_choice(name: str, value: float | str, glyphs: Glyphs) -> Choice:
    """Return the choice among the words that the parameter ``name`` takes."""
    parameter = PARAMETERS[name]
    candidates = (
        Candidate(word, word.replace("-", " "), _MEANINGS.get(word, ())) for word in parameter.words
    )
    return Choice(f"{parameter.symbol}: {parameter.help}", candidates, str(value), glyphs)


_MEANINGS = {
    "constant": ("the same in every episode",),
    "linear": ("less by the decay in every episode, down to the least",),
    "exponential": (
        "down to the least, each episode by a share: least + (start − least) · exp(−decay · episode)",
    ),
    SAMPLE_AVERAGE: ("1/N: the mean of all targets so far",),
}


def _candidate(row: Algorithm | Policy, refused: str) -> Candidate:
    lines = (row.summary, row.equation, f"Sutton & Barto, 2nd ed., {row.source}")
    return Candidate(row.id, row.name, lines, refused)


def _refused(space: FiniteSpace, algorithm: str, values: Hyperparameters) -> str:
    try:
        check_compatible(space, algorithm, values)
    except UserError as fault:
        return str(fault)
    return ""


# Prompts for numbers and the seed


_EXAMPLES = {"initial_q": "0 or 2.5"}


def ask_value(name: str, value: float | str, glyphs: Glyphs, *, another_run: bool = False) -> Dialog[Any]:
    """Return what asks for a number or a word for ``name``; in all else as :func:`ask_number`."""
    if PARAMETERS[name].range is None:
        return word_choice(name, value, glyphs)
    return ask_number(name, value, glyphs, another_run=another_run)


def ask_number(name: str, value: float | str, glyphs: Glyphs, *, another_run: bool = False) -> Prompt:
    """Return the prompt for the hyper-parameter ``name``, whose ``value`` is in force.

    ``another_run`` tells that the value is for one beside this one.
    """
    parameter = PARAMETERS[name]
    starts = "; the run starts again" if name == "initial_q" and not another_run else ""
    word = "; 1/N is the sample average" if SAMPLE_AVERAGE in parameter.words else ""

    def read(text: str) -> float | str:
        try:
            return parsed(text, parameter)
        except ValueError:
            raise ValueError(to_ascii(_expected(parameter), glyphs)) from None

    title = "Initial Q" if name == "initial_q" else parameter.symbol
    hint = f"{parameter.help}{word}{starts}"
    return Prompt(to_ascii(title, glyphs), to_ascii(hint, glyphs), option_text(value), read)


def ask_seed(seed: int) -> Prompt:
    """Return the prompt for the seed; ``seed`` is the one in force."""
    hint = "the same seed gives the same run; the run starts again"
    return Prompt("Seed", hint, str(seed), _read_seed)


def _expected(parameter: Parameter) -> str:
    """Return what to type, naming the range."""
    if parameter.name in _EXAMPLES and parameter.range is not None:
        ends = f"from {parameter.range.low:g} to {parameter.range.high:g}".replace("e+", "e")
        return f"type a number {ends}, such as {_EXAMPLES[parameter.name]}"
    return f"type {parameter.expected_in_words}"


def _read_seed(text: str) -> int:
    """Return the whole number in ``text``; raises ValueError saying what it may be."""
    if not (text.isascii() and text.isdigit()):
        raise ValueError("type a whole number, 0 or more")
    return int(text)
