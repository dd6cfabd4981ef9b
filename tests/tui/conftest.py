from __future__ import annotations

from collections.abc import Callable
from functools import partial

import pytest

from rl_tui.lab.library import recipe_for
from rl_tui.lab.player import Player
from rl_tui.tui.app import RlTuiApp
from rl_tui.tui.display import Display
from rl_tui.worlds.catalogue import find

MakeApp = Callable[..., RlTuiApp]


@pytest.fixture(autouse=True)
def _plain_environment(monkeypatch: pytest.MonkeyPatch, tmp_path_factory: pytest.TempPathFactory) -> None:
    for name in ("NO_COLOR", "COLORTERM", "TEXTUAL_THEME", "TEXTUAL_COLOR_SYSTEM"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(
        "rl_tui.worlds.catalogue.user_folder", lambda: tmp_path_factory.getbasetemp() / "no-scenarios"
    )


@pytest.fixture(autouse=True)
def _short_waits(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let a pilot see within 2 ms, not 20, that an app is at rest: every key waits for that twice or more."""
    monkeypatch.setattr("textual._wait.SLEEP_GRANULARITY", 0.002)
    monkeypatch.setattr("textual._wait.SLEEP_IDLE", 0.0001)


@pytest.fixture
def make_app() -> MakeApp:
    """An app whose steps pass only as it is told: the playground of a scenario, or the catalogue."""

    def make(scenario: str | None = None, *, seed: int = 0, **display: object) -> RlTuiApp:
        recipe = recipe_for(find(scenario), {}, seed) if scenario else None
        options = Display(**{"fps": 1000.0, **display})
        app = RlTuiApp(options, recipe, make_player=partial(Player, automatic=False), picture=True)
        app.NOTIFICATION_TIMEOUT = 3600.0  # while a loop is compiled, messages stay
        return app

    return make
