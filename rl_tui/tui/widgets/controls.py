"""What the agent is told: a slider for each number between 0 and 1, and the settings in words."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

from textual.app import ComposeResult
from textual.containers import Container

from rl_tui.agents.catalogue import BY_ID
from rl_tui.agents.hyperparameters import PARAMETERS, Hyperparameters, Parameter
from rl_tui.lab.recipe import Recipe
from rl_tui.lab.snapshot import Snapshot
from rl_tui.tui.theme.look import Look
from rl_tui.tui.widgets.settings import Settings
from rl_tui.tui.widgets.slider import Slider

_SCHEDULES: Final = ("epsilon_min", "epsilon_decay")


def sliders_of(algorithm: str) -> tuple[Parameter, ...]:
    """Return the parameters of ``algorithm`` that are a number within [0, 1], schedules apart."""
    rows = (PARAMETERS[name] for name in BY_ID[algorithm].parameters if name not in _SCHEDULES)
    return tuple(
        row for row in rows if row.range is not None and row.range.low >= 0.0 and row.range.high <= 1.0
    )


class Controls(Container):
    """Sliders and settings; posts the sliders' own messages and follows what is in force.

    A value that was set here stays on its slider until a snapshot shows that it has arrived.
    """

    def __init__(
        self,
        look: Look,
        recipe: Recipe,
        *,
        id: str | None = None,  # noqa: A002
        classes: str | None = None,
    ) -> None:
        super().__init__(id=id, classes=classes)
        self.border_title = "Controls"
        self._look = look
        self._algorithm = recipe.algorithm
        self._values = recipe.hyperparameters
        self._under_way: dict[str, float | str] = {}

    def compose(self) -> ComposeResult:
        """Yield sliders and settings."""
        yield Container(*self._sliders(), id="sliders")
        yield Settings(self._look, id="settings")

    def show(self, snapshot: Snapshot) -> None:
        """Show what is in force."""
        self.query_one(Settings).show(snapshot)
        self._values = snapshot.hyperparameters
        if snapshot.algorithm != self._algorithm:
            self._algorithm = snapshot.algorithm
            self._under_way.clear()
            self.run_worker(self._replace_sliders(), exclusive=True)
            return
        for slider in self.query(Slider):
            self._follow(slider, snapshot.hyperparameters)

    def forget(self) -> None:
        """Follow the next snapshot whatever was set before: the run starts again."""
        self._under_way.clear()

    def on_slider_changed(self, event: Slider.Changed) -> None:
        """Keep the slider where the user put it until the run has followed."""
        self._under_way[event.name] = event.value

    def _follow(self, slider: Slider, values: Hyperparameters) -> None:
        name = slider.parameter.name
        in_force = getattr(values, name)
        if self._under_way.get(name, in_force) == in_force:
            self._under_way.pop(name, None)
            slider.set_value(in_force)

    def _sliders(self) -> Iterable[Slider]:
        for parameter in sliders_of(self._algorithm):
            yield Slider(self._look, parameter, getattr(self._values, parameter.name), id=parameter.name)

    async def _replace_sliders(self) -> None:
        box = self.query_one("#sliders")
        await box.remove_children()
        await box.mount_all(self._sliders())
