"""What a person can change about the agent at any step: the dialogs, and the check that it can work."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from rl_tui.agents.catalogue import BY_ID, POLICY_BY_ID, parameters_of
from rl_tui.agents.compatibility import check_compatible
from rl_tui.agents.hyperparameters import PARAMETERS, SAMPLE_AVERAGE, Hyperparameters
from rl_tui.common.errors import UserError
from rl_tui.lab.live.commands import Apply, Command
from rl_tui.lab.live.snapshot import Snapshot
from rl_tui.lab.run.recipe import Recipe, SetParameter, SwitchAlgorithm, changed_recipe
from rl_tui.tui.panels.catalogue import PanelRow
from rl_tui.tui.screens.action_screen import ActionScreen
from rl_tui.tui.screens.dialogs.choice import algorithm_choice, policy_choice, word_choice
from rl_tui.tui.screens.dialogs.options import Options
from rl_tui.tui.screens.dialogs.prompt import Prompt
from rl_tui.tui.screens.dialogs.questions import ask_number, ask_seed
from rl_tui.tui.screens.playground.board import Board
from rl_tui.tui.theme.look import Look

ParameterValue = tuple[str, float | str]
"""The name of a hyper-parameter and the value it gets."""


class AgentActions(ActionScreen):
    """A screen on which an agent learns. ``recipe`` is what a restart starts from: with every change made."""

    def __init__(self, look: Look, recipe: Recipe, panels: Sequence[PanelRow]) -> None:
        super().__init__(look, panels)
        self.recipe = recipe
        self.snapshot: Snapshot | None = None

    @property
    def board(self) -> Board:
        """The panels."""
        return self.query_one(Board)

    def send(self, command: Command) -> None:
        """Ask the player for something."""
        raise NotImplementedError

    def restart(self, recipe: Recipe) -> None:
        """Start again with ``recipe``."""
        raise NotImplementedError

    def show_in_force(self) -> None:
        """Let every control show what is in force, whatever was tried."""
        raise NotImplementedError

    def bring_into_view(self, panel: str) -> None:
        """Show ``panel``, whatever stands in its place."""
        raise NotImplementedError

    def action_algorithm(self) -> None:
        """Choose the algorithm."""
        if self.snapshot is not None:
            choice = algorithm_choice(self.snapshot.world.space, self.recipe, self.look.glyphs)
            self.app.push_screen(choice, self._switch)

    def action_policy(self) -> None:
        """Choose the policy."""
        if not self._counts("policy"):
            self.notify(f"{BY_ID[self.recipe.algorithm].name} tries every action: it follows no policy")
        elif self.snapshot is not None:
            choice = policy_choice(self.snapshot.world.space, self.recipe, self.look.glyphs)
            self.app.push_screen(choice, self._setter("policy"))

    def action_ties(self) -> None:
        """Go to the other way to break ties."""
        if not self._counts("ties"):
            self.notify("ties are not broken here: no one action is taken for the best")
            return
        ties = self.recipe.hyperparameters.ties
        self.set_parameter("ties", "first" if ties == "random" else "random")

    def action_initial_q(self) -> None:
        """Ask what every estimate starts from, and start again."""
        self.ask_parameter("initial_q")

    def action_seed(self) -> None:
        """Ask for the seed, and start again."""

        def restart(seed: float | str | None) -> None:
            if seed is not None:
                self.restart(replace(self.recipe, seed=int(seed)))

        self.app.push_screen(ask_seed(self.recipe.seed), restart)

    def action_options(self) -> None:
        """Show every hyper-parameter."""
        self.app.push_screen(Options(self.look, lambda: self.recipe, self.ask_parameter))

    def ask_parameter(self, name: str) -> None:
        """Ask for a value of the hyper-parameter ``name``, then set it."""
        parameter, value = PARAMETERS[name], self.recipe.hyperparameters.value(name)
        if name == "policy":
            self.action_policy()
        elif parameter.range is None:
            self.app.push_screen(word_choice(name, value, self.look.glyphs), self._setter(name))
        else:
            prompt: Prompt = ask_number(name, value, self.look.glyphs)
            self.app.push_screen(prompt, self._setter(name))

    def set_parameter(self, name: str, value: float | str) -> None:
        """Set ``name`` of the running learner; say why not where it cannot work. Initial Q starts again."""
        values = self.recipe.hyperparameters
        if name == "initial_q":
            self.restart(changed_recipe(self.recipe, SetParameter(name, value)))
            return
        params = params_together(values, name, value, self._fault)
        if name == "policy" and len(params) > 1:
            alpha = Hyperparameters().alpha
            self.notify(f"{POLICY_BY_ID[str(value)].name} needs a step size: α is {alpha:g} from here on")
        if params != [(name, values.value(name))]:
            self._apply(params)

    def _apply(self, params: list[ParameterValue]) -> None:
        fault = self._fault(params)
        if fault:
            self.notify(fault, severity="warning", markup=False)
            self.show_in_force()
            return
        self.recipe = replace(self.recipe, hyperparameters=with_values(self.recipe.hyperparameters, params))
        for name, value in params:
            self.send(Apply(SetParameter(name, value)))

    def _fault(self, params: list[ParameterValue]) -> str:
        """Return why these values cannot work here; empty if they can."""
        if self.snapshot is None:
            return "the world is being built"
        try:
            values = with_values(self.recipe.hyperparameters, params)
            check_compatible(self.snapshot.world.space, self.recipe.algorithm, values)
        except (UserError, ValueError) as fault:
            return str(fault)
        return ""

    def _switch(self, algorithm: str | None) -> None:
        if algorithm is not None and algorithm != self.recipe.algorithm:
            self.recipe = replace(self.recipe, algorithm=algorithm)
            self.send(Apply(SwitchAlgorithm(algorithm)))

    def _setter(self, name: str) -> Callable[[float | str | None], None]:
        def set_value(value: float | str | None) -> None:
            if value is not None:
                self.set_parameter(name, value)

        return set_value

    def _counts(self, name: str) -> bool:
        return name in parameters_of(self.recipe.algorithm, self.recipe.hyperparameters.policy)


def without_average(values: Hyperparameters) -> list[ParameterValue]:
    """Return what makes the step size a number where it is the sample average."""
    usual = Hyperparameters()
    return [
        (name, usual.value(name))
        for name in ("step_size_schedule", "alpha")
        if values.value(name) == SAMPLE_AVERAGE
    ]


def params_together(
    values: Hyperparameters, name: str, value: float | str, fault: Callable[[list[ParameterValue]], str]
) -> list[ParameterValue]:
    """Return what to set for ``name`` to be ``value``: with it a step size, where that needs a number.

    ``fault`` says why values cannot work, empty if they can.
    """
    params: list[ParameterValue] = [(name, value)]
    if not values.sample_average:
        return params
    number = without_average(values)
    if name in ("alpha", "step_size_schedule") and value != SAMPLE_AVERAGE:
        return [*(each for each in number if each[0] != name), *params]
    if name == "policy" and fault(params) and not fault([*number, *params]):
        return [*number, *params]
    return params


def with_values(values: Hyperparameters, params: list[ParameterValue]) -> Hyperparameters:
    """Return ``values`` with ``params`` set; raises ValueError naming the range of what does not fit."""
    for name, value in params:
        values = values.changed(name, value)
    return values
