"""What can be changed about the agent: a slider for each number that has one, and the settings in words."""

from __future__ import annotations

from collections.abc import Iterable

from textual.app import ComposeResult
from textual.containers import Container

from rl_tui.agents.catalogue import parameters_of
from rl_tui.agents.hyperparameters import PARAMETERS, SAMPLE_AVERAGE, Hyperparameters, Parameter
from rl_tui.lab.live.snapshot import Snapshot
from rl_tui.lab.run.recipe import Recipe
from rl_tui.tui.panels.controls.settings import AgentSettings
from rl_tui.tui.panels.controls.slider import Slider
from rl_tui.tui.panels.panel import BoardPanel
from rl_tui.tui.theme.look import Look


def sliders_of(algorithm: str, policy: str) -> tuple[Parameter, ...]:
    """Return the parameters of ``algorithm`` with the ``policy`` that have a slider, in order."""
    rows = (PARAMETERS[name] for name in parameters_of(algorithm, policy))
    return tuple(row for row in rows if row.slide is not None)


def in_force(values: Hyperparameters, parameter: Parameter) -> float | str:
    """Return what the slider of ``parameter`` shows: α is the sample average by its schedule as well."""
    if SAMPLE_AVERAGE in parameter.words and values.sample_average:
        return SAMPLE_AVERAGE
    return values.value(parameter.name)


class Controls(Container, BoardPanel):
    """Sliders and settings; posts the sliders' own messages and follows what is in force.

    A value that was set here stays on its slider until a snapshot shows that it has arrived.
    """

    def __init__(self, look: Look, *, id: str | None = None, classes: str | None = None) -> None:  # noqa: A002
        super().__init__(id=id, classes=classes)
        self.border_title = "Controls"
        self._look = look
        self._values = Hyperparameters()
        self._parameters: tuple[Parameter, ...] = ()
        self._under_way: dict[str, float | str] = {}

    def begin_with(self, recipe: Recipe) -> None:
        """Show the sliders of ``recipe`` before the first snapshot."""
        self._values = recipe.hyperparameters
        self._parameters = sliders_of(recipe.algorithm, recipe.hyperparameters.policy)

    def compose(self) -> ComposeResult:
        """Yield sliders and settings."""
        yield Container(*self._sliders(), id="sliders")
        yield AgentSettings(self._look, id="settings")

    def show(self, snapshot: Snapshot) -> None:
        """Show what is in force."""
        self.query_one(AgentSettings).show(snapshot)
        self._values = snapshot.agent.hyperparameters
        parameters = sliders_of(snapshot.agent.algorithm, self._values.policy)
        if parameters != self._parameters:
            self._parameters = parameters
            self._under_way.clear()
            self.run_worker(self._replace_sliders(), exclusive=True)
            return
        for slider in self.query(Slider):
            self._follow(slider, self._values)

    def forget(self) -> None:
        """Follow the next snapshot whatever was set before: the run starts again."""
        self._under_way.clear()

    def on_slider_changed(self, event: Slider.Changed) -> None:
        """Keep the slider where the user put it until the run has followed."""
        self._under_way[event.name] = event.value

    def _follow(self, slider: Slider, values: Hyperparameters) -> None:
        name, value = slider.parameter.name, in_force(values, slider.parameter)
        if self._under_way.get(name, value) == value:
            self._under_way.pop(name, None)
            slider.set_value(value)

    def _sliders(self) -> Iterable[Slider]:
        for parameter in self._parameters:
            yield Slider(self._look, parameter, in_force(self._values, parameter), id=parameter.name)

    async def _replace_sliders(self) -> None:
        box = self.query_one("#sliders")
        with self.app.batch_update():
            await box.remove_children()
            await box.mount_all(self._sliders())
