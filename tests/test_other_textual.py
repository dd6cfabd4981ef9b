"""The program with other versions of Textual."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import Final

import pytest
from pseudo_terminal import PseudoTerminal, visible

from rl_tui.commands.serving.app_process import environment_of_app

OTHER_TEXTUAL: Final = (sys.executable, str(Path(__file__).parent / "other_textual.py"))


@pytest.mark.exhaustive("starts it without each name", but=["chops"])
@pytest.mark.parametrize(
    "names",
    [
        "XTermParser,ANSI_SEQUENCES_KEYS",  # the driver is Textual's
        "_run_input_thread,_writer_thread,_get_terminal_size,_sigtstp_application,_sigcont_application"
        ",_app,_debug,_loop,_skip,_awaiting,StylesCache",
        "_display,_driver",  # Textual draws
        "chops",  # Textual draws from the second frame on
        "_batch_count,_running,_post_message,_process_messages_loop"
        ",_build_driver,_handle_exception,_fatal_error,_exception,_exit,_bindings",
    ],
)
def test_it_works_without_a_private_name(names: str) -> None:
    with PseudoTerminal([*OTHER_TEXTUAL, names, "play", "student"], size=(100, 30)) as terminal:
        terminal.wait_for("paused")
        terminal.press("s")
        terminal.wait_for(r"step\s+1\b")
        terminal.press("?")
        terminal.wait_for("Words  Pages")
        terminal.press("\x1b")
        terminal.wait_until(lambda: "Words  Pages" not in terminal.screen)
        terminal.resize(130, 40)
        terminal.wait_until(lambda: max(map(len, terminal.screen.splitlines())) > 100)
        terminal.press("qq")
        assert terminal.wait_for_end() == 0
        assert terminal.modes_left_changed == set()
        assert terminal.attributes == terminal.attributes_before
        assert "Traceback" not in visible(terminal.written)


@pytest.mark.exhaustive("starts it without each name")
@pytest.mark.parametrize(
    "names", ["ByteStream", "_input_reader,_write,_on_meta,_mouse,_enable_mouse_support"]
)
def test_it_works_in_a_browser_without_a_private_name(names: str) -> None:
    with subprocess.Popen(
        [*OTHER_TEXTUAL, names, "play", "student"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        env=environment_of_app(os.environ, (100, 30), kiosk=True),
    ) as app:
        assert app.stdin is not None
        assert app.stdout is not None
        drawn = b""
        while b"paused" not in drawn and (more := os.read(app.stdout.fileno(), 65_536)):
            drawn += more
        rest, errors = app.communicate(b"D\0\0\0\1q", timeout=120)  # the browser sends q
    assert b"paused" in drawn
    assert (drawn + rest).endswith(b'{"type": "exit"}')
    assert app.returncode == 0
    assert b"Traceback" not in errors
