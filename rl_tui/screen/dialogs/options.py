"""Every hyper-parameter of the agent with its value, and what it may be."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Final

from rich.text import Text
from textual.app import ComposeResult
from textual.widgets import OptionList, Static
from textual.widgets.option_list import Option

from rl_tui.agents.catalogue import parameters_of
from rl_tui.agents.hyperparameters import PARAMETERS, SAMPLE_AVERAGE, Hyperparameters, why_idle
from rl_tui.runs.recipe import Recipe
from rl_tui.screen.dialogs.dialog import Dialog
from rl_tui.screen.draw.to_ascii import to_ascii
from rl_tui.screen.panels.controls.settings import alpha_moves, called, epsilon_moves, option_text
from rl_tui.screen.theme.look import Look

NO_EFFECT: Final = "no effect now"
_LEAST_SYMBOL = 12
_VALUE = 15  # columns; a row fits into 51 even where symbols are spelled out
_STEP_SIZE: Final = ("alpha", "step_size_schedule", "alpha_min", "alpha_decay")
_EXPLORATION: Final = ("epsilon", "epsilon_schedule", "epsilon_min", "epsilon_decay")
_MEANINGS: Final[Mapping[str, str]] = {
    "alpha": "step size",
    "step_size_schedule": "how it changes",
    "alpha_min": "where it ends",
    "alpha_decay": "per episode",
    "gamma": "discount",
    "policy": "chooses actions",
    "epsilon": "random actions",
    "epsilon_schedule": "how it changes",
    "epsilon_min": "where it ends",
    "epsilon_decay": "per episode",
    "temperature": "how random",
    "confidence": "bonus of the rare",
    "baseline": "of rewards",
    "lambda": "trace decay",
    "traces": "on another visit",
    "n": "steps an update",
    "planning_steps": "updates a step",
    "threshold": "changes left out",
    "accuracy": "where it stops",
    "initial_q": "first estimates",
    "ties": "of equal actions",
}
"""What each parameter is, in as few words as the last column has room for: 17 cells."""


class Options(Dialog[None]):
    """A list of what counts for the algorithm and the policy in force.

    ``recipe`` returns what is in force; ``change`` is asked to change the parameter of a name.
    """

    def __init__(self, look: Look, recipe: Callable[[], Recipe], change: Callable[[str], None]) -> None:
        super().__init__()
        self._look = look
        self._recipe = recipe
        self._change = change

    def compose(self) -> ComposeResult:
        """Yield the list and the sentence about the entry under the cursor."""
        with self.box("Options", "enter: change   esc: close"):
            yield OptionList()
            yield Static(classes="hint", markup=False)

    def on_mount(self) -> None:
        """Let the arrows choose."""
        self.query_one(OptionList).focus()

    def on_screen_resume(self) -> None:
        """Show the values in force, be it because one was changed."""
        self.refresh_values()

    def refresh_values(self) -> None:
        """Show the values in force; the cursor stays on its parameter."""
        choices = self.query_one(OptionList)
        at = choices.highlighted_option.id if choices.highlighted_option else None
        names = self._names
        symbols = [len(to_ascii(PARAMETERS[name].symbol, self._look.glyphs)) for name in names]
        columns = max(_LEAST_SYMBOL, *symbols)
        choices.set_options(Option(self._row(name, columns), id=name) for name in names)
        choices.highlighted = names.index(at) if at in names else 0

    def on_option_list_option_highlighted(self, event: OptionList.OptionHighlighted) -> None:
        """Describe the parameter under the cursor, and say what values it takes."""
        parameter = PARAMETERS[str(event.option_id)]
        starts = "; the run starts again" if parameter.name == "initial_q" else ""
        idle = self._why_idle(parameter.name)
        expected = parameter.expected_in_words if parameter.range else ", ".join(parameter.words)
        text = f"{parameter.help}\n{f'{NO_EFFECT}: {idle}' if idle else expected}{starts}"
        self.query_one(".hint", Static).update(to_ascii(text, self._look.glyphs))

    def on_option_list_option_selected(self, event: OptionList.OptionSelected) -> None:
        """Ask for another value of the parameter."""
        self._change(str(event.option_id))

    @property
    def _names(self) -> tuple[str, ...]:
        recipe = self._recipe()
        return parameters_of(recipe.algorithm, recipe.hyperparameters.policy)

    def _why_idle(self, name: str) -> str:
        recipe = self._recipe()
        is_bandit = recipe.scenario.kind == "bandit"
        return why_idle(name, recipe.algorithm, recipe.hyperparameters, is_bandit=is_bandit)

    def _row(self, name: str, columns: int) -> Text:
        value, meaning = in_force(name, self._recipe().hyperparameters)
        glyphs = self._look.glyphs
        is_idle = bool(self._why_idle(name))
        text = Text(f"{to_ascii(PARAMETERS[name].symbol, glyphs):<{columns}} ", "dim" if is_idle else "")
        text.append(f"{to_ascii(value, glyphs):<{_VALUE}} ", "not bold" if is_idle else "bold")
        return text.append(to_ascii(NO_EFFECT if is_idle else meaning, glyphs))


def in_force(name: str, values: Hyperparameters) -> tuple[str, str]:
    """Return what is in force of the parameter ``name``, and what that is.

    A schedule that changes nothing is called constant, whatever it would do with a decay.
    """
    for names, moves in ((_STEP_SIZE, alpha_moves(values)), (_EXPLORATION, epsilon_moves(values))):
        if name in names:
            return _scheduled(name, names, values, moves)
    return called(name, values.value(name)), _MEANINGS[name]


def _scheduled(name: str, names: Sequence[str], values: Hyperparameters, moves: bool) -> tuple[str, str]:
    """Return the same of one of ``names``: a start, its schedule, where that ends, and its decay."""
    start, schedule, least, _ = names
    value, meaning = option_text(values.value(name)), _MEANINGS[name]
    averages = start == "alpha" and values.sample_average
    if name == start:
        still = "1/N" if averages else f"constant {value}"
        return f"{value} to {option_text(values.value(least))}" if moves else still, meaning
    if name == schedule and not moves:
        return (SAMPLE_AVERAGE if averages else "constant"), meaning
    return value, meaning
