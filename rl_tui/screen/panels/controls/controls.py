"""The agent's sliders and settings."""

from __future__ import annotations

from typing import Final

from rich.cells import cell_len
from textual.app import ComposeResult
from textual.containers import Container

from rl_tui.agents.catalogue import parameters_of
from rl_tui.agents.hyperparameters import PARAMETERS, SAMPLE_AVERAGE, Hyperparameters, Parameter, why_idle
from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.answers.flip_answer import beyond
from rl_tui.runs.recipe import Recipe
from rl_tui.screen.kit.panel import BORDER_ENDS, BoardPanel
from rl_tui.screen.kit.snapshot_facts import is_secret, keeps_back
from rl_tui.screen.panels.controls.settings import AgentSettings
from rl_tui.screen.panels.controls.slider import Slider
from rl_tui.screen.panels.controls.slider_picture import SliderMark
from rl_tui.screen.theme.look import Look

_ROOMY: Final = 8  # rows from which a blank one separates the sliders
GAMMA: Final = "gamma"  # the parameter whose slider shows flip points

_MEANING: Final = (
    "Marks are flip points of the optimal path. While t g is open, flip "
    "points of other states are marked too."
)


def sliders_of(algorithm: str, values: Hyperparameters, *, is_bandit: bool = False) -> tuple[Parameter, ...]:
    """Return parameters with slider and effect."""
    rows = (
        PARAMETERS[name]
        for name in parameters_of(algorithm, values.policy)
        if not why_idle(name, algorithm, values, is_bandit=is_bandit)
    )
    return tuple(row for row in rows if row.slide is not None)


def in_force(values: Hyperparameters, parameter: Parameter) -> float | str:
    """Return a slider's value, for α maybe sample averages."""
    if SAMPLE_AVERAGE in parameter.words and values.sample_average:
        return SAMPLE_AVERAGE
    return values.value(parameter.name)


def flip_marks(snapshot: Snapshot, *, every: bool) -> tuple[SliderMark, ...]:
    """Return the slider's flip points, unless hidden."""
    known = snapshot.answers.flips
    return tuple(
        SliderMark(
            flip.gamma,
            below=beyond(known, flip, is_above=False),
            above=beyond(known, flip, is_above=True),
            stands_out=flip.turns_the_way,
        )
        for flip in known.flips
        if (flip.turns_the_way or every) and not (is_secret(snapshot) or keeps_back(snapshot, "flips"))
    )


class Controls(Container, BoardPanel):
    """Sliders and settings, with ``wanted`` values at once."""

    def __init__(self, look: Look, *, id: str | None = None, classes: str | None = None) -> None:  # noqa: A002
        super().__init__(id=id, classes=classes)
        self.look = look
        self.wanted = Hyperparameters()
        self.marks_all_flips = False
        """Whether γ has marks for every flip point, not only on the optimal path."""
        self._parameters: tuple[Parameter, ...] = ()
        self._sliders: dict[str, Slider] = {}  # by name: some are not mounted yet

    def has_slider(self, name: str) -> bool:
        """Return whether a parameter has a slider."""
        return any(parameter.name == name for parameter in self._parameters)

    def on_resize(self) -> None:
        """Refit heading and blank row."""
        self._write_border()
        margin = (self.size.height >= _ROOMY, 0, 0, 0)
        if self._sliders and self.query_one("#sliders").styles.margin != margin:
            self.query_one("#sliders").styles.margin = margin

    def _write_border(self) -> None:
        numbers = " ".join(str(number + 1) for number in range(len(self._parameters)))
        explained = f"Agent · {numbers} to adjust"
        has_room = self.is_explained and len(explained) <= self.size.width - BORDER_ENDS
        self.write_border(explained if has_room else "Agent", "", self.look)
        self._label_sliders()

    def _label_sliders(self) -> None:
        is_line = self.size.height == 1
        names = {each.name: "" if is_line else each.short_name for each in self._parameters}
        labels = (self.look.glyphs.spelled(f"{each.symbol} {names[each.name]}") for each in self._parameters)
        columns = 0 if is_line else max(map(cell_len, labels), default=0)
        for place, (name, slider) in enumerate(self._sliders.items()):
            slider.label(names[name], columns, is_pointed_at=self.is_spotlit and is_line and place == 0)

    def begin_with(self, recipe: Recipe) -> None:
        """Show sliders before the first snapshot."""
        self.wanted = recipe.hyperparameters
        is_bandit = recipe.scenario.is_bandit
        self._parameters = sliders_of(recipe.algorithm, recipe.hyperparameters, is_bandit=is_bandit)

    def compose(self) -> ComposeResult:
        """Yield sliders and settings."""
        self._sliders = self._new_sliders()
        yield Container(*self._sliders.values(), id="sliders")
        yield AgentSettings(self.look, id="settings")

    def depends_on(self, snapshot: Snapshot) -> object:
        """Return the contents, or None with a refused value."""
        if any(each.value != in_force(self.wanted, each.parameter) for each in self._sliders.values()):
            return None
        agent, playback, episode = snapshot.agent, snapshot.playback, snapshot.counters.episodes
        values = agent.hyperparameters
        return (
            *(agent.algorithm, values, self.wanted, snapshot.world.is_bandit),
            *(values.alpha_at(episode), values.epsilon_at(episode)),
            *(snapshot.recipe.seed, playback.phase, playback.speed),
            *(snapshot.run_group.shown, len(snapshot.run_group.lanes)),
            *(self.marks_all_flips, snapshot.answers.flips, snapshot.answers.is_hidden),
            snapshot.answers.kept_back,
        )

    def redraw(self) -> None:
        """Show current settings and wanted sliders."""
        self._write_border()
        snapshot = self.snapshot
        if snapshot is None:
            return
        self.query_one(AgentSettings).show(snapshot)
        agent, is_bandit = snapshot.agent, snapshot.world.is_bandit
        parameters = sliders_of(agent.algorithm, agent.hyperparameters, is_bandit=is_bandit)
        if parameters != self._parameters:
            self._parameters = parameters
            new = self._new_sliders()
            # keep a remaining slider, in which a person may be typing
            self._sliders = new | {name: slider for name, slider in self._sliders.items() if name in new}
            self._write_border()
            self.run_worker(self._mount_sliders(), exclusive=True)
        for slider in self._sliders.values():
            slider.set_value(in_force(self.wanted, slider.parameter))
            if slider.parameter.name == GAMMA:
                slider.set_marks(flip_marks(snapshot, every=self.marks_all_flips), _MEANING)

    def _new_sliders(self) -> dict[str, Slider]:
        return {
            parameter.name: Slider(self.look, parameter, in_force(self.wanted, parameter))
            for parameter in self._parameters
        }

    async def _mount_sliders(self) -> None:
        box, kept = self.query_one("#sliders"), set(self._sliders.values())
        leaving = [slider for slider in box.query(Slider) if slider not in kept]
        with self.app.batch_update():
            if any(slider.has_focus for slider in leaving):
                self.screen.set_focus(None)
                self.screen.post_message(Slider.Released())
            await box.remove_children(leaving)
            for place, slider in enumerate(self._sliders.values()):
                if slider.parent is None:
                    await box.mount(slider, before=place if place < len(box.children) else None)
