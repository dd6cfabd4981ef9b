"""The program on screen: screens compose, verbs are commands, and nothing else grows here."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from typing import TYPE_CHECKING, ClassVar

from textual.app import App
from textual.command import CommandPalette, Provider
from textual.theme import Theme

from rl_tui.lab.library import recipe_for
from rl_tui.lab.recipe import Recipe
from rl_tui.tui.actions import ActionProvider
from rl_tui.tui.display import Display
from rl_tui.tui.theme.depth import choose_look, depth_of, environment_for, is_native
from rl_tui.tui.theme.glyphs import ASCII
from rl_tui.tui.theme.limited_themes import PICTURE_DARK, PICTURE_LIGHT, themes_for
from rl_tui.tui.theme.look import Look
from rl_tui.tui.theme.palette import Depth
from rl_tui.tui.theme.scroll_bars import use_scroll_bars
from rl_tui.worlds.catalogue import scenarios
from rl_tui.worlds.errors import UserError

if TYPE_CHECKING:
    from rl_tui.lab.player import Player
    from rl_tui.tui.screens.catalogue import Catalogue
    from rl_tui.tui.screens.playground import Playground

MakePlayer = Callable[[Recipe], "Player"]


def _live_player(recipe: Recipe) -> Player:
    from rl_tui.lab.player import Player

    return Player(recipe)


class RlTuiApp(App[UserError]):
    """Catalogue and playground; started with a recipe, it goes straight to that playground.

    ``make_player`` makes the thread behind a playground. A ``picture`` asks no terminal what it can do. The
    app's result is the fault that ended it, None if none did. Raises UserError where the theme is not known.
    """

    TITLE = "rl-tui"
    CSS_PATH = "app.tcss"
    NOTIFICATION_TIMEOUT: ClassVar[float] = 3
    COMMANDS: ClassVar[set[type[Provider] | Callable[[], type[Provider]]]] = {ActionProvider}

    def __init__(
        self,
        display: Display | None = None,
        recipe: Recipe | None = None,
        make_player: MakePlayer = _live_player,
        *,
        picture: bool = False,
    ) -> None:
        options = display or Display()
        depth = "truecolor" if picture and options.colors == "auto" else depth_of(options.colors, os.environ)
        with environment_for(depth):
            super().__init__(ansi_color=is_native(depth) and not picture)
        if picture:
            self.ansi_theme_dark, self.ansi_theme_light = PICTURE_DARK, PICTURE_LIGHT
        for theme in themes_for(depth, picture=picture):
            self.register_theme(theme)
        if options.theme not in self.available_themes:
            known = ", ".join(sorted(self.available_themes))
            raise UserError(f"theme {options.theme!r} is not known; choose one of {known}")
        self.theme = options.theme
        self.options = options
        self._depth: Depth = depth
        self._encoding = "utf-8" if picture else sys.stdout.encoding
        self._recipe = recipe
        self._make_player = make_player
        has_ascii_only = self.look.glyphs is ASCII
        self.set_class(has_ascii_only, "-ascii")
        use_scroll_bars(ascii_only=has_ascii_only)

    @property
    def look(self) -> Look:
        """The characters and colours in force."""
        return choose_look(
            self._depth, self.options.ascii, self.current_theme.dark, os.environ, self._encoding
        )

    def on_mount(self) -> None:
        """Open the first screen."""
        self.theme_changed_signal.subscribe(self, self._follow_theme)
        self.push_screen(self._playground(self._recipe) if self._recipe else self._catalogue())

    # Each screen is imported when it is first wanted: the first paint waits for one of them only, that of the
    # catalogue not for numpy and a dozen widgets

    def _catalogue(self, start_at: str = "", fault: UserError | None = None) -> Catalogue:
        from rl_tui.tui.screens.catalogue import Catalogue

        return Catalogue(self.look, start_at, fault)

    def _playground(self, recipe: Recipe) -> Playground:
        from rl_tui.tui.screens.playground import Playground

        return Playground(self.look, recipe, self._make_player(recipe), self.options.fps)

    def on_catalogue_opened(self, event: Catalogue.Opened) -> None:
        """Go to the playground."""
        self._recipe = None  # from here on a fault leads back to the catalogue
        self.switch_screen(self._playground(event.recipe))

    def on_playground_left(self, event: Playground.Left) -> None:
        """Go back to the catalogue; end where a fault meets the only run that was asked for."""
        if event.fault is not None and self._recipe is not None:
            self.exit(event.fault, return_code=1)
            return
        self._recipe = None
        self.switch_screen(self._catalogue(event.recipe.scenario.id, event.fault))

    def on_playground_neighbour_wanted(self, event: Playground.NeighbourWanted) -> None:
        """Go to the scenario before or after; from a file that is not listed, to the first or last."""
        known = scenarios()
        ids = [scenario.id for scenario in known]
        unlisted = min(0, -event.offset)
        here = ids.index(event.recipe.scenario.id) if event.recipe.scenario.id in ids else unlisted
        try:
            recipe = recipe_for(known[(here + event.offset) % len(known)], {}, event.recipe.seed)
        except UserError as fault:
            self.notify(str(fault), severity="error", markup=False)
            return
        self._recipe = None
        self.switch_screen(self._playground(recipe))

    def action_command_palette(self) -> None:
        """Open the palette."""
        if not isinstance(self.screen, CommandPalette):
            self.push_screen(CommandPalette(placeholder="find an action"))

    def _follow_theme(self, _: Theme) -> None:
        look = self.look
        for screen in self.screen_stack:
            for widget in screen.walk_children(with_self=True):
                if hasattr(widget, "look"):
                    widget.look = look
                    widget.refresh()
