"""``rl-tui serve``, without a browser."""

from __future__ import annotations

import socket
import sys
from functools import partial

import pytest
from called import called
from click.testing import CliRunner, Result

from rl_tui.commands.by_name import serve
from rl_tui.commands.main import program
from rl_tui.commands.serving.addresses import bind, listen
from rl_tui.common.errors import UserError

run = partial(called, "serve")


def refused(result: Result, status: int) -> str:
    assert result.stdout == ""
    assert "Traceback" not in result.stderr
    assert result.exit_code == status
    return result.stderr.splitlines()[-1]


@pytest.fixture
def started(monkeypatch: pytest.MonkeyPatch) -> list[tuple[str, ...]]:
    commands: list[tuple[str, ...]] = []
    monkeypatch.setattr(serve, "prepare", lambda scenario: None)
    monkeypatch.setattr(
        serve, "serve_apps", lambda listening, command, *rest, **more: commands.append(command)
    )
    return commands


def test_a_missing_package_is_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(serve, "find_spec", lambda name: None)
    line = refused(run(), 1)
    assert line == 'rl-tui: rl-tui serve needs two more packages: pip install "rl-tui[serve]"'


pytest.importorskip("aiohttp", reason='needs aiohttp: pip install "rl-tui[serve]"')
pytest.importorskip("textual_serve", reason='needs textual-serve: pip install "rl-tui[serve]"')


def test_the_apps_get_the_display_options_that_were_given(started: list[tuple[str, ...]]) -> None:
    result = run("student", "--port", "0", "--theme", "light", "--ascii", "--reduced-motion", "--fps", "5.5")
    assert (result.exit_code, result.output) == (0, "")
    arguments = ("play", "student", "--theme=light", "--ascii", "--fps=5.5", "--reduced-motion")
    assert started == [(sys.executable, "-P", "-m", "rl_tui", *arguments)]


def test_without_a_scenario_they_open_the_catalogue(started: list[tuple[str, ...]]) -> None:
    assert run("--port", "0").exit_code == 0
    assert started == [(sys.executable, "-P", "-m", "rl_tui")]


def test_nobody_is_let_in_before_it_can_answer(monkeypatch: pytest.MonkeyPatch) -> None:
    with socket.create_server(("127.0.0.1", 0)) as free:
        address = free.getsockname()[:2]
    came: list[str] = []

    def come(when: str) -> None:
        try:
            socket.create_connection(address, 5).close()
        except ConnectionRefusedError:
            came.append(f"refused {when}")
        else:
            came.append(f"let in {when}")

    monkeypatch.setattr(serve, "prepare", lambda scenario: come("before"))
    monkeypatch.setattr(serve, "serve_apps", lambda *rest, **more: come("then"))
    assert run("student", "--port", str(address[1])).exit_code == 0
    assert came == ["refused before", "let in then"]


def test_of_two_that_start_at_once_one_is_told() -> None:
    with bind("127.0.0.1", 0) as first, bind("127.0.0.1", first.getsockname()[1]) as second:
        listen(first, "127.0.0.1")
        with pytest.raises(UserError, match="another program uses it"):
            listen(second, "127.0.0.1")


def test_a_port_in_use_is_one_line() -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        line = refused(run("--port", str(port)), 1)
    assert line.startswith(f"rl-tui: cannot listen on port {port} of 127.0.0.1: another program uses it")


@pytest.mark.parametrize(
    ("arguments", "status", "words"),
    [
        (("student.toml",), 1, "and a kiosk has no others: did you mean student"),
        (("../x",), 1, "and a kiosk has no others: --no-kiosk"),
        (("gym:CliffWalking-v1",), 1, "is not a scenario of rl-tui"),
        (("--theme", "pink"), 1, "theme 'pink' is not known"),
        (("--no-kiosk", "nowhere"), 1, "there is no scenario"),
        (("--port", "65536"), 2, "a whole number in [0, 65535], not 65536"),
        (("--most", "0"), 2, "not 0"),
        (("--url", "lab.example.org"), 2, "--url lab.example.org is not an address"),
        (("--host", "192.0.2.1", "--yes"), 1, "this machine does not have that address"),
    ],
)
def test_what_cannot_be_served_is_one_line(arguments: tuple[str, ...], status: int, words: str) -> None:
    assert words in refused(run(*arguments), status)


def test_another_address_is_warned_of_and_confirmed(started: list[tuple[str, ...]]) -> None:
    result = run("--host", "0.0.0.0", "--port", "0")
    assert "add --yes" in refused(result, 2)
    assert started == []
    result = run("--host", "0.0.0.0", "--port", "0", "--yes")
    assert result.exit_code == 0
    assert "every address of this machine can be reached from other machines" in result.stderr
    assert "no password and no encryption" in result.stderr
    assert len(started) == 1


@pytest.mark.parametrize(("answer", "status", "servers"), [("y", 0, 1), ("n", 1, 0), ("", 1, 0)])
def test_a_person_is_asked(
    started: list[tuple[str, ...]], monkeypatch: pytest.MonkeyPatch, answer: str, status: int, servers: int
) -> None:
    monkeypatch.setattr(serve, "is_interactive", lambda: True)
    result = CliRunner().invoke(program, ["serve", "--host", "0.0.0.0", "--port", "0"], input=f"{answer}\n")
    assert result.exit_code == status
    assert "Serve it there? [y/N]" in result.stderr
    assert len(started) == servers


def test_files_are_never_given_to_other_machines(started: list[tuple[str, ...]]) -> None:
    line = refused(run("--host", "0.0.0.0", "--no-kiosk", "--yes"), 2)
    assert "--no-kiosk" in line
    assert "only on 127.0.0.1" in line
    assert started == []


def test_files_behind_a_proxy_are_confirmed(started: list[tuple[str, ...]]) -> None:
    arguments = ("--no-kiosk", "--url", "https://lab.example.org", "--port", "0")
    assert "add --yes" in refused(run(*arguments), 2)
    result = run(*arguments, "--yes")
    assert result.exit_code == 0
    assert "The proxy in front must ask for a password" in result.stderr


def test_a_kiosk_cannot_be_left_by_an_option(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("RL_TUI_KIOSK", "1")
    result = CliRunner().invoke(serve.command, ["--no-kiosk"])  # the whole program would become one
    assert (result.exit_code, result.stdout) == (2, "")
    assert "RL_TUI_KIOSK is set, so --no-kiosk is not allowed: unset it first" in result.stderr
