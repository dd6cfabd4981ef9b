"""A Python process of our own beside this one, which works for it."""

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


def python_process(
    module: str, arguments: Mapping[str, object], environment: Mapping[str, str], folder: str | None = None
) -> subprocess.Popen[bytes]:
    """Start a process that calls ``main`` of ``module`` with ``arguments``; its stdin and stdout are pipes.

    It has a session of its own and no terminal, so that no key and no hang-up reaches it, and should end with
    its stdin, which ends with this process, however that ends. It imports what this process would, but
    nothing from the current folder, which may be anybody's or gone. ``folder`` is where it works, None: where
    this process does. Raises OSError where no process can be started.
    """
    if not sys.executable:
        raise FileNotFoundError("which Python this is is not known")
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
        creationflags=getattr(subprocess, "CREATE_NEW_PROCESS_GROUP", 0),  # the same, on Windows
    )
