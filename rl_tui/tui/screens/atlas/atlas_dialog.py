"""The atlas over the playground: the map, what is said of it, and the process that works it out."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import ClassVar, Final

from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.widgets import Static

from rl_tui.lab.atlas.figures import Atlas, AtlasState
from rl_tui.lab.atlas.request import WORK, AtlasRequest
from rl_tui.lab.run.recipe import Recipe
from rl_tui.lab.sweeps.measures import JUDGED_BY, MEASURES
from rl_tui.lab.workers.answering_process import Background
from rl_tui.tui.draw.to_ascii import to_ascii
from rl_tui.tui.screens.atlas.atlas_map import AtlasMap
from rl_tui.tui.screens.atlas.picture import AtlasScene, setting_name
from rl_tui.tui.screens.atlas.words import cell_line, head, legend
from rl_tui.tui.screens.dialogs.dialog import Dialog
from rl_tui.tui.theme.look import Look

_KEYS: Final = "m: measure   n: next seed   enter: open the run   esc: close"
_NEWS_EVERY: Final = 0.1  # seconds


class AtlasDialog(Dialog[Recipe]):
    """The surroundings of the settings in force, as ``request`` asks for them. Answers the run to be opened.

    Where the request is awaited, it shows nothing before all is done.
    """

    CSS_PATH: ClassVar[list[str | Path]] = [  # type: ignore[assignment]
        Path(__file__).parents[1] / "dialogs" / "dialog.tcss",
        Path(__file__).with_name("atlas.tcss"),
    ]
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("S,q", "cancel", "back", id="close_atlas", tooltip="Close the atlas."),
        Binding("m", "measure", "measure", id="atlas.measure", tooltip="Show the next measure."),
        Binding("n", "seed", "next seed", id="atlas.seed", tooltip="Open another of the cell's runs."),
        Binding("enter", "open", "open", id="atlas.open", tooltip="Open this very run."),
    ]

    def __init__(self, look: Look, request: AtlasRequest) -> None:
        super().__init__()
        self._look = look
        self._request = request
        self._seed = 0
        self._how_long = ""
        self._background = Background[AtlasRequest, Atlas](WORK, lambda: None)
        measure = MEASURES[JUDGED_BY[0]]
        self._scene = AtlasScene(
            look, request.cells, request.nothing_yet, measure, request.in_force, request.in_force
        )

    def compose(self) -> ComposeResult:
        """Yield what is mapped, the map, and what the cell under the cursor says."""
        names = " × ".join(map(setting_name, self._request.variations))
        with self.box(to_ascii(f"Atlas of {names}", self._look.glyphs), _KEYS):
            yield Static(id="measure", markup=False)
            yield Static(id="head", classes="hint", markup=False)
            yield AtlasMap(self._scene)
            yield Static(id="legend", classes="hint", markup=False)
            yield Static(id="cell", markup=False)

    def on_mount(self) -> None:
        """Have it worked out, by a process of its own."""
        super().on_mount()
        self.query_one(AtlasMap).focus()
        try:
            process = self._background.begin(self._request, self._scene.atlas)
        except OSError as error:
            self.app.notify(f"no process can be started: {error.strerror or error}", severity="error")
            self.dismiss(None)
            return
        if process is not None and self._request.is_awaited:
            process.wait()
        else:
            self.set_interval(_NEWS_EVERY, self._take_news)
        self._take_news()
        self._show()

    def on_unmount(self) -> None:
        """End the process, whatever it is doing."""
        self._background.close()

    def _take_news(self) -> None:
        process = self._background.process
        if process is None:
            return
        atlas, how_long = process.known, process.how_long
        if process.failed and not atlas.is_over:
            atlas = replace(atlas, state=AtlasState.FAILED, message=process.failed)
        if atlas != self._scene.atlas or how_long != self._how_long:
            self._how_long = how_long
            self._change(atlas=atlas)

    def _change(self, **changes: object) -> None:
        self._scene = replace(self._scene, **changes)  # type: ignore[arg-type]
        self._show()

    def _show(self) -> None:
        scene, glyphs = self._scene, self._look.glyphs
        self.query_one(AtlasMap).show(scene)
        texts = {
            "#measure": scene.measure.title,
            "#head": head(scene, self._request.runs, self._how_long),
            "#legend": legend(scene),
            "#cell": cell_line(scene, self._request.seeds[self._seed]),
        }
        for name, text in texts.items():
            self.query_one(name, Static).update(to_ascii(text, glyphs))

    def on_atlas_map_cell_pointed(self, event: AtlasMap.CellPointed) -> None:
        """Let the cursor stand there."""
        self._change(cursor=event.cell)

    def action_measure(self) -> None:
        """Show the next measure that any cell has."""
        there = [
            each
            for each in MEASURES.values()
            if each is self._scene.measure
            or any(cell.value(each) is not None for cell in self._scene.atlas.cells.values())
        ]
        self._change(measure=there[(there.index(self._scene.measure) + 1) % len(there)])

    def action_seed(self) -> None:
        """Let enter open the run of the next seed."""
        self._seed = (self._seed + 1) % self._request.runs
        self._show()

    def action_open(self) -> None:
        """Answer the run of the cell under the cursor."""
        if self._scene.cursor in self._scene.atlas.impossible:
            self.app.bell()
            return
        self.dismiss(self._request.recipe_of(self._scene.cursor, self._request.seeds[self._seed]))
