"""Changes to the agent."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import partial
from typing import Final

from rl_tui.agents.catalogue import BY_ID, POLICY_BY_ID, parameters_of
from rl_tui.agents.exact.first_update import Remedy
from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.common.errors import UserError
from rl_tui.live.commands import Apply, AskWhy, Restart
from rl_tui.runs.recipe import Recipe, SetParameter, SwitchAlgorithm, changed_recipe
from rl_tui.runs.settings import settings_for
from rl_tui.screen.board.subject import Subject
from rl_tui.screen.dialogs.choice import algorithm_choice, ask_seed, ask_value, policy_choice
from rl_tui.screen.dialogs.options import Options
from rl_tui.screen.dialogs.why import Why
from rl_tui.screen.draw.action_order import shown_order
from rl_tui.screen.draw.names import action_name
from rl_tui.screen.keys.playground_keys import ORDINALS
from rl_tui.screen.kit.row import CONTROLS
from rl_tui.screen.panels.controls.slider import Slider
from rl_tui.screen.theme.glyphs import Glyphs
from rl_tui.worlds.world import World

# Settings of the agent


_TIES: Final = {
    "random": "ties random: one of the best actions is drawn",
    "first": "ties first: the first of the best actions is taken",
}


def _first_in_words(world: World, glyphs: Glyphs) -> str:
    order = range(len(world.space.action_names))
    if shown_order(world) == tuple(order):
        return ""
    signs = [action_name(world, action, glyphs) for action in order]
    return f", in the world's own order: {' '.join(signs)}"


@dataclass(eq=False)
class AgentActions(Subject):
    """Algorithm, policy, settings and seed."""

    _waiting: list[SetParameter] = field(default_factory=list)

    @property
    def recipe(self) -> Recipe:
        """The recipe of a restart."""
        return self.link.wanted.recipe

    def why_not(self, deed: str) -> str:
        """Explain why there is nothing to set."""
        if deed.startswith("focus_slider("):
            number = int(deed[-2])
            if self.link.wanted.lesson and CONTROLS not in (self.board.shown or {CONTROLS}):
                return "this page has no sliders"
            has_one = len(self.board.controls.query(Slider)) >= number
            return "" if has_one else f"there is no {ORDINALS[number - 1]} slider here"
        if deed == "choose_policy" and not self._counts("policy"):
            return f"{BY_ID[self.recipe.algorithm].name} tries every action and follows no policy"
        if deed == "next_ties" and not self._counts("ties"):
            return "this policy has no ties to break"
        return ""

    def value(self, deed: str) -> str:
        """Return the setting's value."""
        recipe, values = self.recipe, self.recipe.hyperparameters
        if recipe.algorithm not in BY_ID or self.why_not(deed):  # a watched program has unknown settings
            return ""
        current = {
            "choose_algorithm": BY_ID[recipe.algorithm].name,
            "choose_policy": POLICY_BY_ID[values.policy].name,
            "next_ties": values.ties,
            "next_seed": str(recipe.seed + 1),
            "ask_seed": str(recipe.seed),
            "ask_initial_q": f"{values.initial_q:g}",
        }
        return current.get(deed, "")

    def choose_algorithm(self) -> None:
        """Ask for the algorithm."""
        if self.snapshot is not None:
            self.ask(algorithm_choice(self.snapshot.world.space, self.recipe, self.glyphs), self.switch)

    def choose_policy(self) -> None:
        """Ask for the policy."""
        if self.snapshot is not None:
            choice = policy_choice(self.snapshot.world.space, self.recipe, self.glyphs)
            self.ask(choice, partial(self.set_parameter, "policy"))

    def next_ties(self) -> None:
        """Break ties the other way."""
        ties = "first" if self.recipe.hyperparameters.ties == "random" else "random"
        self.set_parameter("ties", ties)
        snapshot = self.snapshot
        order = "" if snapshot is None or ties != "first" else _first_in_words(snapshot.world, self.glyphs)
        self.screen.tell(f"{_TIES[ties]}{order}")

    def ask_initial_q(self) -> None:
        """Ask for the initial Q, and restart."""
        self.ask_parameter("initial_q")

    def ask_seed(self) -> None:
        """Ask for the seed, and restart."""
        self.ask(ask_seed(self.recipe.seed, self.glyphs), lambda seed: self._restart_with(int(seed)))

    def next_seed(self) -> None:
        """Restart with the next seed."""
        self._restart_with(self.recipe.seed + 1)

    def _restart_with(self, seed: int) -> None:
        self.link.send(Restart(replace(self.recipe, seed=seed)))

    def show_options(self) -> None:
        """Show every setting."""
        self.screen.app.push_screen(Options(self.screen.look, lambda: self.recipe, self.ask_parameter))

    def ask_parameter(self, name: str) -> None:
        """Ask for a setting's value, then set it."""
        if name == "policy":
            self.choose_policy()
        else:
            value = self.recipe.hyperparameters.value(name)
            self.ask(ask_value(name, value, self.glyphs), partial(self.set_parameter, name))

    def set_parameter(self, name: str, value: float | str) -> None:
        """Set a value. Initial Q restarts the run."""
        setting = SetParameter(name, value)
        if name == "initial_q":
            self.link.send(Restart(changed_recipe(self.recipe, setting)))
            return
        if self.snapshot is None:
            self._waiting.append(setting)
            return
        try:
            settings = settings_for(self.snapshot.world.space, self.recipe, setting)
        except UserError as fault:
            self.screen.tell(str(fault), severity="warning")
            self.board.controls.redraw()  # moves the sliders back
            return
        if name == "policy" and len(settings) > 1:
            alpha = Hyperparameters().alpha
            text = f"{POLICY_BY_ID[str(value)].name} needs a step size: α is {alpha:g} from here on"
            self.screen.tell(text)
        if changed_recipe(self.recipe, *settings) != self.recipe:
            for each in settings:
                self.link.send(Apply(each))

    def set_what_waits(self) -> None:
        """Apply what was asked for before the first snapshot."""
        waiting, self._waiting = self._waiting, []
        for setting in waiting:
            self.set_parameter(setting.name, setting.value)

    def focus_slider(self, number: int) -> None:
        """Focus a slider, counted from 1."""
        self.board.bring_into_view(CONTROLS)
        self.board.controls.query(Slider)[number - 1].focus()

    def switch(self, algorithm: str) -> None:
        """Continue with ``algorithm`` and the current estimates."""
        if algorithm != self.recipe.algorithm:
            self.link.send(Apply(SwitchAlgorithm(algorithm)))

    def _counts(self, name: str) -> bool:
        return name in parameters_of(self.recipe.algorithm, self.recipe.hyperparameters.policy)


# Why nothing is learned yet


@dataclass(eq=False)
class WhyActions(Subject):
    """The wait for the first update."""

    agent: AgentActions

    def explain(self) -> None:
        """Show the wait's cause and remedies."""
        if self.snapshot is None:
            return
        self.link.send(AskWhy(is_asked=True))
        self.screen.app.push_screen(Why(self.screen.look, self.snapshot), self._closed)

    def _closed(self, remedy: Remedy | None) -> None:
        self.link.send(AskWhy(is_asked=False))
        if remedy is not None:
            self.agent.set_parameter(remedy.setting, remedy.value)
