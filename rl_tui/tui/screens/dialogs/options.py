"""Every hyper-parameter of the agent with its value, and what it may be."""

from __future__ import annotations

from collections.abc import Callable

from rich.text import Text
from textual.app import ComposeResult
from textual.widgets import OptionList, Static
from textual.widgets.option_list import Option

from rl_tui.agents.catalogue import parameters_of
from rl_tui.agents.hyperparameters import PARAMETERS
from rl_tui.agents.idle_parameters import why_idle
from rl_tui.lab.run.recipe import Recipe
from rl_tui.tui.draw.to_ascii import to_ascii
from rl_tui.tui.panels.controls.settings import called
from rl_tui.tui.screens.dialogs.dialog import Dialog
from rl_tui.tui.theme.look import Look

_LEAST_SYMBOL = 12
_VALUE = 15  # columns; a row fits into 51 even where symbols are spelled out


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
        note = f"no effect now: {idle}" if idle else parameter.expected
        text = f"{parameter.help}\n{note}{starts}"
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
        parameter, value = PARAMETERS[name], self._recipe().hyperparameters.value(name)
        glyphs = self._look.glyphs
        is_idle = bool(self._why_idle(name))
        text = Text(f"{to_ascii(parameter.symbol, glyphs):<{columns}} ", "dim" if is_idle else "")
        text.append(f"{to_ascii(called(name, value), glyphs):<{_VALUE}} ", "not bold" if is_idle else "bold")
        return text.append(name.replace("_", " "))
