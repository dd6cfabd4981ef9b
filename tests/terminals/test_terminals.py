"""The real program in terminals of every kind."""

from __future__ import annotations

import re
from contextlib import suppress
from typing import Final

import pytest

pytest.importorskip("pty", reason="there are no pseudo-terminals here")

from judging import check_playground, colour_kinds
from multiplexers import in_screen, in_tmux
from pseudo_terminal import RL_TUI, PseudoTerminal

PLAY: Final = (*RL_TUI, "play", "student")
EXACT: Final = r"optimal +7\.5"
FLIP: Final = r"γ discount +━+┃"  # its mark on the slider of γ, computed in the background after the optimum
SIZES: Final = ((80, 24), (100, 30), (120, 40), (200, 60))
ODD_SIZES: Final = ((60, 18), (61, 19), (79, 23), (81, 25), (300, 80))
STEPS: Final = 5
BEGIN: Final = "s" * STEPS + "wh"  # shows the exact values, which the student hides
REDRAW: Final = "\x0c"  # ctrl+l
ESCAPE: Final = "\x1b[27u"
DIALOGS: Final = {  # keys, then the expected text on the screen
    "?": "Words  Pages",
    "ao": "All settings",
    "u": "Run until",
    "mb": "Branches",
    "cs": "differs in",
    "mx": "Export",
    "wm": "Model",
    "\x10": "a few letters of anything",
    "\x10theme\r": "Colours",
}


def begin(terminal: PseudoTerminal) -> None:
    terminal.wait_for("paused")
    terminal.press(BEGIN)
    terminal.wait_for(rf"step +{STEPS}\b")


def resize_to(terminal: PseudoTerminal, *sizes: tuple[int, int]) -> None:
    for size in sizes:
        terminal.resize(*size)
        wait_for_playground(terminal)


def wait_for_playground(terminal: PseudoTerminal) -> None:
    size = (terminal.emulator.columns, terminal.emulator.lines)

    def is_there() -> bool:
        with suppress(AssertionError):
            check_playground(terminal.screen, size, STEPS)
            return True
        return False

    try:
        terminal.wait_until(is_there)
    except AssertionError:
        check_playground(terminal.screen, size, STEPS)  # reports an error in it
        raise


def is_underlined(terminal: PseudoTerminal, text: str) -> bool:
    for row, line in enumerate(terminal.screen.splitlines()):
        if text in line:
            return bool(terminal.emulator.cell(line.index(text), row).underscore)
    return False


def leave(terminal: PseudoTerminal) -> None:
    terminal.press("qq")
    assert terminal.wait_for_end() == 0
    assert terminal.modes_left_changed == set()
    assert terminal.attributes == terminal.attributes_before
    assert terminal.screen.strip().startswith("saved: ")
    assert "╭" not in terminal.screen


@pytest.fixture(scope="module")
def fresh(tmp_path_factory: pytest.TempPathFactory) -> dict[tuple[int, int], str]:
    screens = {}
    for size in ((80, 24), (120, 40)):
        kept = {"RL_TUI_SESSIONS_DIR": str(tmp_path_factory.mktemp("sessions"))}
        with PseudoTerminal(PLAY, {"COLORTERM": "truecolor", **kept}, size) as terminal:
            begin(terminal)
            terminal.wait_for(EXACT)
            terminal.wait_for(FLIP)
            terminal.blank()  # a screen of several frames is complete then
            terminal.press(REDRAW)
            terminal.wait_for(EXACT)
            terminal.wait_for(FLIP)
            wait_for_playground(terminal)
            screens[size] = terminal.screen
            assert colour_kinds(terminal.written) == {"truecolor"}
            leave(terminal)
    return screens


@pytest.mark.exhaustive("starts a terminal for each size")
def test_256_colours_at_every_size_look_as_if_started_there(fresh: dict[tuple[int, int], str]) -> None:
    with PseudoTerminal(PLAY, {}, ODD_SIZES[0]) as terminal:
        begin(terminal)
        resize_to(terminal, *SIZES, *ODD_SIZES)
        terminal.resize(59, 17)
        too_small = "terminal too small: is 59×17, needs 60×18"
        terminal.wait_until(lambda: too_small in terminal.screen and "World" not in terminal.screen)
        for size, screen in fresh.items():
            terminal.resize(*size)
            terminal.wait_for(re.escape(screen))
        assert colour_kinds(terminal.written) == {"256"}
        assert b"\x1b[?2026h" in terminal.written
        leave(terminal)


@pytest.mark.exhaustive("one more kind of colours")
def test_16_colours_on_a_light_background_in_ascii() -> None:
    environment = {"TERM": "xterm", "LC_ALL": None, "LC_CTYPE": None, "LANG": "C"}
    with PseudoTerminal([*PLAY, "--theme", "light"], environment, (80, 24), synchronises=False) as terminal:
        begin(terminal)
        resize_to(terminal, *SIZES[1:], ODD_SIZES[0])
        terminal.resize(100, 30)
        for keys, title in DIALOGS.items():
            assert title not in terminal.screen
            terminal.press(keys)
            terminal.wait_for(title)
            terminal.press(ESCAPE)
            terminal.wait_until(lambda title=title: title not in terminal.screen)
            wait_for_playground(terminal)
        assert colour_kinds(terminal.written) == {"16"}
        assert terminal.written.isascii()
        assert b"\x1b[?2026h" not in terminal.written
        leave(terminal)


@pytest.mark.exhaustive("one more kind of colours")
def test_no_colours_where_none_are_wanted_but_one_sees_where_one_is() -> None:
    with PseudoTerminal(PLAY, {"NO_COLOR": "1", "COLORTERM": "truecolor"}, (100, 30)) as terminal:
        begin(terminal)
        resize_to(terminal, *SIZES[:2])
        terminal.press("ao")
        terminal.wait_until(lambda: is_underlined(terminal, "constant 0.1"))
        assert "All settings" in terminal.screen
        assert not is_underlined(terminal, "discount")
        assert colour_kinds(terminal.written) == set()
        terminal.press(ESCAPE)
        leave(terminal)


@pytest.mark.exhaustive("one more kind of colours")
def test_a_light_background_in_truecolor_where_the_terminal_does_not_say_what_it_shows() -> None:
    light = [*PLAY, "--theme", "light"]
    with PseudoTerminal(light, {"COLORTERM": "truecolor"}, (120, 40), tells_position=False) as terminal:
        begin(terminal)
        wait_for_playground(terminal)
        cell = terminal.emulator.cell(1, 0)
        assert int(cell.bg, 16) > int("f00000", 16)
        assert int(cell.fg[:2], 16) < int("50", 16)
        terminal.press(" " + "+" * 9)
        terminal.wait_for(r"▶ max .* step +(\d{1,3}(,\d{3}){2,}|[\d.]+ ?[MG])")
        terminal.press(" ")
        terminal.wait_for("paused")
        leave(terminal)


@pytest.mark.exhaustive("a multiplexer, with two more terminals to compare it with")
def test_inside_tmux(fresh: dict[tuple[int, int], str]) -> None:
    in_shell = ["sh", "-c", f"{' '.join(PLAY)}; echo it ended with $?; exec cat"]
    with in_tmux(in_shell, (80, 24)) as tmux:
        tmux.wait_for("paused")
        tmux.press(BEGIN)
        tmux.wait_for(rf"step +{STEPS}\b")
        tmux.wait_for(re.escape(fresh[80, 24]))
        tmux.resize(120, 40)
        tmux.wait_for(re.escape(fresh[120, 40]))
        tmux.resize(59, 17)
        tmux.wait_for("too small")
        tmux.resize(80, 24)
        tmux.wait_for(re.escape(fresh[80, 24]))
        coloured = tmux.coloured
        backgrounds = {coloured.cell(x, y).bg for x in range(80) for y in range(24)}
        assert len(backgrounds) > 2
        tmux.press("qq")
        tmux.wait_for("it ended with 0")
        assert tmux.modes == "alternate 0, cursor 1, mouse 0"


@pytest.mark.exhaustive("a second multiplexer")
def test_inside_gnu_screen(fresh: dict[tuple[int, int], str]) -> None:
    with in_screen(PLAY, (80, 24)) as terminal:
        begin(terminal)
        terminal.wait_for(re.escape(fresh[80, 24]))
        terminal.resize(120, 40)
        terminal.wait_for(re.escape(fresh[120, 40]))
        assert colour_kinds(terminal.written) <= {"256", "16"}
        terminal.press("qq")
        assert terminal.wait_for_end() == 0
