"""A stranger at a kiosk."""

from __future__ import annotations

import os
from pathlib import Path

from pseudo_terminal import RL_TUI, PseudoTerminal


def tree(folder: Path) -> dict[str, tuple[int, int]]:
    return {
        str(path.relative_to(folder)): (path.stat().st_size, path.stat().st_mtime_ns)
        for path in sorted(folder.rglob("*"))
    }


def test_nothing_is_written_whatever_is_typed(tmp_path: Path) -> None:
    for name in ("home", "config/rl-tui/scenarios", "state", "cache", "work", "tmp"):
        (tmp_path / name).mkdir(parents=True)
    (tmp_path / "config/rl-tui/scenarios/mine.toml").write_text('title = "Mine"\n[bandit]\narms = 2\n')
    environment = {
        "RL_TUI_KIOSK": "1",
        "HOME": str(tmp_path / "home"),
        "XDG_CONFIG_HOME": str(tmp_path / "config"),
        "XDG_STATE_HOME": str(tmp_path / "state"),
        "XDG_CACHE_HOME": str(tmp_path / "cache"),
        "TMPDIR": str(tmp_path / "tmp"),
        "RL_TUI_SESSIONS_DIR": str(tmp_path / "state" / "sessions"),
        "TEXTUAL_LOG": str(tmp_path / "work" / "log"),
        "PYTHONPATH": os.environ.get("PYTHONPATH") or str(Path(__file__).parent.parent),
    }
    before = tree(tmp_path)
    with PseudoTerminal(
        ["env", "-C", str(tmp_path / "work"), *RL_TUI], environment, size=(100, 30)
    ) as terminal:
        terminal.wait_for(r"See how\. +kiosk")
        terminal.wait_for("bandit")
        assert "Mine" not in terminal.written.decode(errors="replace")
        terminal.press("\x1b[3~")
        terminal.wait_for("Not here: a kiosk keeps no sessions")
        terminal.press("\x1b[B\x1b[B\r")
        terminal.wait_for("paused|preparing")
        terminal.press("m")
        terminal.wait_for("go to…")
        assert "save…" not in terminal.screen
        assert "export…" not in terminal.screen
        terminal.press("sx\x1b[27u")  # the menu has no command that writes
        terminal.wait_until(lambda: "go to…" not in terminal.screen)
        terminal.press("\x1a")  # ctrl+z
        terminal.press("\x10")  # ctrl+p
        terminal.wait_for("a few letters of anything")
        terminal.press("export")
        terminal.wait_for(r"More +m ")  # its menu, without that row here
        assert "m x" not in terminal.screen
        terminal.press("\x11")  # ctrl+q quits from everywhere
        assert terminal.wait_for_end() == 0
    assert tree(tmp_path) == before
