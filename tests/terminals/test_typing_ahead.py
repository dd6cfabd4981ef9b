"""Keys that arrive all at once."""

from __future__ import annotations

import pytest

pytest.importorskip("pty", reason="there are no pseudo-terminals here")

from pseudo_terminal import RL_TUI, PseudoTerminal

ESCAPE = "\x1b[27u"  # in the form of terminals that report the start of a sequence
PALETTE = "\x10"  # ctrl+p


@pytest.mark.exhaustive("opens every dialog in a terminal")
def test_no_key_is_lost_while_a_dialog_or_a_screen_opens() -> None:
    with PseudoTerminal([*RL_TUI, "play", "student"]) as terminal:
        terminal.wait_for("paused")
        terminal.press("s" * 20)
        terminal.wait_for(r"step +20\b")
        terminal.press("mg12\r")
        terminal.wait_for(r"end 20 .* step +12\b")
        terminal.press(PALETTE + "reset\r")
        terminal.wait_for(r"step +0\b")
        terminal.press("?" + ESCAPE + "s")
        terminal.wait_for(r"step +1\b")
        terminal.press("?\x1bs")  # an old terminal sends the same for alt+s
        terminal.wait_for(r"step +2\b")
        terminal.press("?\x1bb")
        terminal.wait_for(r"step +1\b")
        terminal.press("\x1b\x1b")
        terminal.wait_for("Begin here")
        terminal.press("\r")
        terminal.wait_for("A student's evening .* paused")
        terminal.press("w]w]w]")
        terminal.wait_for(r"Bernoulli bandit  .* paused")
        terminal.press("w[w[")
        terminal.wait_for(r"FrozenLake 4×4 slippery  .* paused")
        terminal.press("rsq\x7f7\r")  # q goes into the prompt and does not quit
        terminal.wait_for("seed 7")
        terminal.press("?\x1b[200~\x1brs\x1b[201~\x1bq")  # pasted text is not a key
        assert terminal.wait_for_end() == 0
