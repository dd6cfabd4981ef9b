"""Python child processes that work for this program."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Mapping
from typing import Final

_SCRIPT: Final = """\
import sys
sys.path[:] = {path!r}
from {module} import main
main(**{arguments!r})
"""
# Windows has no sessions and no nice values. Elsewhere this is 0
_ON_WINDOWS: Final[int] = getattr(subprocess, "CREATE_NEW_PROCESS_GROUP", 0) | getattr(
    subprocess, "BELOW_NORMAL_PRIORITY_CLASS", 0
)


def python_process(
    module: str, arguments: Mapping[str, object], environment: Mapping[str, str], folder: str | None = None
) -> subprocess.Popen[bytes]:
    """Start a process that calls ``main`` of `module` with `arguments`, over pipes.

    It has its own session and no terminal, so neither keys nor hang-ups reach it. Its ``main`` should end
    when stdin closes, which happens whenever this process ends. It imports nothing from the current folder.
    On Windows its priority is below normal.

    Raises:
        OSError: The process cannot be started.
    """
    if not sys.executable:
        raise FileNotFoundError("the path of the Python interpreter is unknown")
    path = [each for each in sys.path if each]
    return subprocess.Popen(
        [sys.executable, "-P", "-c", _SCRIPT.format(path=path, module=module, arguments=dict(arguments))],
        bufsize=0,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        cwd=folder,
        env=environment,
        start_new_session=True,
        creationflags=_ON_WINDOWS,
    )
