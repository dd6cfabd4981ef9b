"""``rl-tui sweep --dask``, the parts that need no cluster."""

from __future__ import annotations

import subprocess
import sys

import pytest
from click.testing import CliRunner, Result

from rl_tui.commands.main import program

SWEEP = ("sweep", "maze", "--vary", "alpha=0.1,0.2", "--episodes", "2")


def run(*args: str) -> Result:
    return CliRunner().invoke(program, [*SWEEP, *args])


@pytest.mark.parametrize(
    "address",
    ["node1", "node1:8786", "http://node1:8786", "tcp://node1", "tcp://node1:x", "tcp://a b:1", "tcp://:1"],
)
def test_what_is_no_address_is_refused(address: str) -> None:
    result = run("--dask", address)
    assert result.exit_code == 2
    assert f"{address} is not the address of a Dask scheduler" in result.stderr


def test_jobs_are_of_this_machine() -> None:
    result = run("--dask", "tcp://node1:8786", "--jobs", "2")
    assert result.exit_code == 2
    assert "leave out --jobs" in result.stderr


@pytest.mark.parametrize(
    "address", ["tcp://node-1.example.org:8786", "tls://10.0.0.1:1", "tcp://[::1]:65535"]
)
def test_without_dask_it_is_said_what_to_install(address: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    result = run("--dask", address)
    assert result.exit_code == 1
    assert result.stderr == 'rl-tui: the option --dask needs another package: pip install "rl-tui[dask]"\n'


@pytest.mark.process
def test_dask_is_imported_only_for_a_cluster() -> None:
    modules = "rl_tui.commands.main, rl_tui.studies.sweeps.cluster.dask_workers"
    code = f"import sys, {modules}; print({{'dask', 'distributed'}} & {{*sys.modules}})"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "set()\n"
