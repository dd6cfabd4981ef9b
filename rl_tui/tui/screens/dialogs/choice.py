"""Choose one of several, with what each of them does, and why some cannot be chosen here."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from rich.text import Text
from textual.app import ComposeResult
from textual.widgets import OptionList, Static
from textual.widgets.option_list import Option

from rl_tui.agents.catalogue import BY_ID, POLICY_BY_ID, Algorithm, Policy
from rl_tui.agents.compatibility import check_compatible
from rl_tui.agents.hyperparameters import PARAMETERS, SAMPLE_AVERAGE, Hyperparameters
from rl_tui.common.errors import UserError
from rl_tui.lab.run.recipe import Recipe
from rl_tui.tui.draw.to_ascii import to_ascii
from rl_tui.tui.screens.dialogs.dialog import Dialog
from rl_tui.tui.theme.glyphs import Glyphs
from rl_tui.worlds.mdp.space import FiniteSpace


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
