"""All settings of the agent."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Final

from rl_tui.agents.catalogue import parameters_of
from rl_tui.agents.hyperparameters import PARAMETERS, SAMPLE_AVERAGE, Hyperparameters, why_idle
from rl_tui.runs.recipe import Recipe
from rl_tui.screen.dialogs.form import Candidate, Form
from rl_tui.screen.kit.bindings import as_sentence
from rl_tui.screen.panels.controls.settings import alpha_moves, called, epsilon_moves, option_text
from rl_tui.screen.theme.glyphs import Glyphs
from rl_tui.screen.theme.look import Look

NO_EFFECT: Final = "no effect now"
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
    "confidence": "exploration bonus",
    "baseline": "of rewards",
    "lambda": "trace decay",
    "traces": "on another visit",
    "n": "steps an update",
    "planning_steps": "updates a step",
    "threshold": "changes left out",
    "accuracy": "where it stops",
    "initial_q": "initial Q",
    "ties": "among equals",
}
"""The meaning of each parameter in the 17 cells of the last column."""


class SettingChoice(Form):
    """The settings ``names``, schedules folded. The answer is a name."""

    def __init__(
        self,
        title: str,
        names: Callable[[], Sequence[str]],
        recipe: Callable[[], Recipe],
        glyphs: Glyphs,
        *,
        another_run: bool = False,
    ) -> None:
        self._recipe = recipe
        self._names = names
        self._is_open = False
        self._another_run = another_run
        super().__init__(title, self._rows(), "", glyphs)

    def choose(self, id: str) -> None:  # noqa: A002
        """Answer the setting, or unfold the schedules."""
        if id == SCHEDULES:
            self._is_open = True
            rows = self._rows()
            self.set_rows(rows, at=next(each.id for each in rows if PARAMETERS[each.id].schedule))
        else:
            self.chosen(id)

    def chosen(self, name: str) -> None:
        """Answer the setting ``name``."""
        self.dismiss(name)

    def _rows(self) -> list[Candidate]:
        recipe = self._recipe()
        names = sorted(
            self._names(), key=lambda name: (PARAMETERS[name].schedule, PARAMETERS[name].slide is None)
        )
        folded = [name for name in names if PARAMETERS[name].schedule and not self._is_open]
        rows = [_row(name, recipe, another_run=self._another_run) for name in names if name not in folded]
        about = ("How step size and exploration change with the episodes.",)
        return [*rows, *([Candidate(SCHEDULES, f"schedules ({len(folded)})", about)] if folded else [])]


class Options(SettingChoice):
    """The settings that count for algorithm and policy."""

    def __init__(self, look: Look, recipe: Callable[[], Recipe], change: Callable[[str], None]) -> None:
        def names() -> Sequence[str]:
            now = recipe()
            return parameters_of(now.algorithm, now.hyperparameters.policy)

        self._change = change
        super().__init__("All settings", names, recipe, look.glyphs)

    def on_screen_resume(self) -> None:
        """Show values, which may have changed."""
        self.set_rows(self._rows())

    def chosen(self, name: str) -> None:
        """Ask for another value, without closing."""
        self._change(name)


SCHEDULES: Final = "schedules"


def _row(name: str, recipe: Recipe, *, another_run: bool) -> Candidate:
    parameter = PARAMETERS[name]
    idle = why_idle(name, recipe.algorithm, recipe.hyperparameters, is_bandit=recipe.scenario.is_bandit)
    value, meaning = in_force(name, recipe.hyperparameters)
    starts = "; the run starts again" if name == "initial_q" and not another_run else ""
    expected = parameter.expected_in_words if parameter.range else ", ".join(parameter.words)
    about = (parameter.help, f"{f'{NO_EFFECT}: {idle}' if idle else expected}{starts}")
    return Candidate(
        name, parameter.symbol, tuple(map(as_sentence, about)), "", value, NO_EFFECT if idle else meaning
    )


def in_force(name: str, values: Hyperparameters) -> tuple[str, str]:
    """Return a parameter's value and its meaning."""
    for names, moves in ((_STEP_SIZE, alpha_moves(values)), (_EXPLORATION, epsilon_moves(values))):
        if name in names:
            return _scheduled(name, names, values, moves)
    return called(name, values.value(name)), _MEANINGS[name]


def _scheduled(name: str, names: Sequence[str], values: Hyperparameters, moves: bool) -> tuple[str, str]:
    start, schedule, least, _ = names
    value, meaning = option_text(values.value(name)), _MEANINGS[name]
    averages = start == "alpha" and values.sample_average
    if name == start:
        still = "1/N" if averages else f"constant {value}"
        return f"{value} to {option_text(values.value(least))}" if moves else still, meaning
    if name == schedule and not moves:
        return (SAMPLE_AVERAGE if averages else "constant"), meaning
    return value, meaning
