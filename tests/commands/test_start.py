"""Settings before a command: display options, variables, ctrl+C."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from called import assert_refused
from called import called as run

from rl_tui.commands import main
from rl_tui.commands import main as main_module
from rl_tui.commands.line.screen import FEWEST_FILES, require_open_files
from rl_tui.commands.main import program
from rl_tui.common.errors import UserError
from rl_tui.screen.terminal.driver_choice import driver_class

SMALL = ("screenshot", "--size", "40x10", "--out", "-")


@pytest.mark.screen
def test_display_options_count_before_the_command_too() -> None:
    before, after = run("--theme", "light", *SMALL).stdout, run(*SMALL, "--theme", "light").stdout
    assert before == after != run(*SMALL).stdout


@pytest.mark.parametrize(
    ("before", "after", "given"),
    [
        ("--theme light --ascii", "--colors 16", "--theme=light --colors=16 --ascii"),
        ("--theme light", "--theme dark", "--theme=dark"),
        ("--no-color", "", "--colors=none"),
        ("--no-color", "--colors truecolor", "--colors=truecolor"),
    ],
)
def test_the_later_one_wins_and_serve_hands_them_on_to_its_apps(before: str, after: str, given: str) -> None:
    from rl_tui.commands.by_name.serve import app_command, command

    with program.make_context("rl-tui", [*before.split(), "serve"]) as whole:
        whole.invoked_subcommand = "serve"
        program.callback(**whole.params)  # type: ignore[misc]
        with command.make_context("serve", after.split(), parent=whole) as context:
            arguments = app_command(context, "student", dict(context.params))[4:]
    assert arguments == ("play", "student", *given.split())


def test_a_command_without_a_screen_refuses_them() -> None:
    assert_refused(run("--ascii", "list"), 2, "--ascii")


@pytest.mark.parametrize("number", ["0", "-1", "many", "", "9" * 5_000])
def test_a_number_of_threads_that_is_none_is_left_out(number: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NUMBA_NUM_THREADS", number)
    main_module.leave_out_bad_threads()
    assert "NUMBA_NUM_THREADS" not in os.environ


def test_a_number_of_threads_stays(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NUMBA_NUM_THREADS", "2")
    main_module.leave_out_bad_threads()
    assert os.environ["NUMBA_NUM_THREADS"] == "2"


@pytest.mark.parametrize(("said", "stays"), [("zz", False), ("none", False), ("", False), ("256", True)])
def test_a_number_of_colours_that_is_none_is_left_out(
    said: str, stays: bool, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("TEXTUAL_COLOR_SYSTEM", said)
    main_module.leave_out_bad_colours()
    assert ("TEXTUAL_COLOR_SYSTEM" in os.environ) == stays
    assert capsys.readouterr().err.count("\n") == (0 if stays else 1)


@pytest.mark.parametrize("named", ["os:system", "os:path", "nowhere:Driver", ":", "os", "x" * 5_000])
def test_what_is_not_a_driver_is_refused_in_a_line(named: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TEXTUAL_DRIVER", named)
    with pytest.raises(UserError, match=r"^TEXTUAL_DRIVER=.{1,60} is not a driver of Textual; unset it$"):
        driver_class()


def test_a_driver_of_textual_is_left_to_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TEXTUAL_DRIVER", "textual.drivers.web_driver:WebDriver")
    assert driver_class() is None


def test_few_open_files_are_raised_or_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    limits = [(8, 1_000)]
    monkeypatch.setattr("resource.getrlimit", lambda kind: limits[-1])
    monkeypatch.setattr("resource.setrlimit", lambda kind, wanted: limits.append(wanted))
    require_open_files()
    assert limits[-1] == (FEWEST_FILES, 1_000)
    limits.append((8, 8))
    with pytest.raises(UserError, match="only 8 files"):
        require_open_files()


@pytest.mark.process
def test_a_picture_for_a_stdout_that_is_closed_is_refused_in_a_sentence() -> None:
    command = f"exec {sys.executable} -m rl_tui screenshot --size 40x10 --out - >&-"
    ended = subprocess.run(["sh", "-c", command], stderr=subprocess.PIPE, text=True, check=False)
    assert (ended.returncode, ended.stderr.count("\n")) == (1, 1)
    assert "unexpected" not in ended.stderr


# Each represents everything imported at that time
@pytest.mark.exhaustive("starts it once for each module", but=["rl_tui.commands.main"])
@pytest.mark.process
@pytest.mark.skipif(sys.platform == "win32", reason="there are no such signals")
@pytest.mark.parametrize("module", ["click", "rl_tui.commands.main", "rl_tui.common.errors"])
def test_ctrl_c_while_it_is_being_imported_leaves_no_traceback(module: str, tmp_path: Path) -> None:
    (tmp_path / "sitecustomize.py").write_text(
        "import os, signal, sys\n"
        "class Finder:\n"
        "    def find_spec(self, name, *_):\n"
        f"        if name == {module!r}:\n"
        "            os.kill(os.getpid(), signal.SIGINT)\n"
        "sys.meta_path.insert(0, Finder())\n",
        encoding="utf-8",
    )
    paths = [str(tmp_path), *filter(None, [os.environ.get("PYTHONPATH")])]
    ended = subprocess.run(
        [sys.executable, "-m", "rl_tui", "list"],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(paths)},
        capture_output=True,
        text=True,
        check=False,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler) and None,
    )
    assert (ended.returncode, ended.stderr) == (130, "")


@pytest.mark.process
@pytest.mark.skipif(sys.platform == "win32", reason="there are no such signals")
def test_ctrl_c_in_a_text_that_is_being_executed_gives_the_usual_status() -> None:
    code = (
        "import signal\n"
        "from rl_tui.commands import main\n"
        "main.enter_kiosk = lambda _: exec('signal.raise_signal(signal.SIGINT)', globals())\n"
        "main.main()"
    )
    ended = subprocess.run(
        [sys.executable, "-c", code],
        check=False,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler) and None,
    )
    assert ended.returncode == 130


@pytest.mark.process
@pytest.mark.skipif(sys.platform == "win32", reason="there are no such signals")
def test_ctrl_c_that_another_error_comes_of_gives_the_usual_status_without_a_word() -> None:
    code = (
        "import signal\n"
        "from rl_tui.commands import main\n"
        "def breaks_off(_):\n"
        "    try:\n"
        "        signal.raise_signal(signal.SIGINT)\n"
        "    except KeyboardInterrupt:\n"
        "        raise ImportError('broken off') from None\n"
        "main.enter_kiosk = breaks_off\n"
        "main.main()"
    )
    ended = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        check=False,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler) and None,
    )
    assert (ended.returncode, ended.stderr) == (130, "")


NAME = "OPENBLAS_NUM_THREADS"


@pytest.mark.parametrize(("given", "then"), [({}, "1"), ({NAME: "4"}, "4"), ({"OMP_NUM_THREADS": "4"}, None)])
def test_linear_algebra_gets_one_thread_unless_somebody_wants_more(
    given: dict[str, str], then: str | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(os, "environ", dict(given))
    monkeypatch.delitem(sys.modules, "numpy", raising=False)
    main.calculate_in_one_thread()
    assert os.environ.get(NAME) == then
