"""Commands of the program, called in this process."""

from __future__ import annotations

import json
from typing import Any, NoReturn

from click.testing import CliRunner, Result

from rl_tui.commands.main import program


def called(*args: object) -> Result:
    return CliRunner().invoke(program, [*map(str, args)], prog_name="rl-tui")


def printed(*args: object) -> str:
    result = called(*args)
    assert (result.exit_code, result.stderr) == (0, "")
    return result.stdout


def document(*args: object) -> Any:
    return json.loads(printed(*args, "--json"), parse_constant=_refuse)


def assert_refused(result: Result, status: int, said: str) -> None:
    """Check that a line on stderr says why, and that nothing is on stdout."""
    assert (result.exit_code, result.stdout, result.stderr.count("\n")) == (status, "", 1), result.output
    assert said in result.stderr
    assert "Traceback" not in result.stderr


def _refuse(name: str) -> NoReturn:
    raise AssertionError(f"{name} in JSON")
