"""Hide what only POSIX has, in each Python process that finds this folder in PYTHONPATH.

Other packages are imported first, and keep what they use. Only the program sees a Windows without modules
such as fcntl. It does not replace a test on Windows.
"""

from __future__ import annotations

import asyncio
import errno
import fcntl
import importlib
import mmap
import os
import select
import signal
import sys
from contextlib import suppress
from types import ModuleType

MODULES = "fcntl grp numba posix pty pwd readline resource scipy syslog termios tty"
LIBRARIES = """
asyncio.subprocess click.testing concurrent.futures ctypes.util gymnasium.envs.toy_text http.server
importlib.metadata logging.handlers multiprocessing.pool numpy.testing pathlib platformdirs pydantic
rich.console sqlite3 subprocess tempfile textual.app textual.drivers.linux_driver textual.pilot
textual.widgets tomlkit webbrowser zipfile
"""
NAMES = {
    os: """
O_CLOEXEC O_DIRECTORY O_NOCTTY O_NOFOLLOW O_NONBLOCK PRIO_PROCESS WNOHANG chown fchmod fchown fork forkpty
getegid geteuid getgid getgroups getloadavg getpgid getpgrp getpriority getsid getuid killpg memfd_create
mkfifo nice openpty register_at_fork sched_getaffinity set_blocking setpgid setpriority setsid statvfs
sysconf tcgetpgrp tcsetpgrp ttyname uname wait wait4 waitid
""",
    signal: """
SIGALRM SIGCHLD SIGCONT SIGHUP SIGIO SIGKILL SIGPIPE SIGQUIT SIGSTOP SIGTSTP SIGTTIN SIGTTOU SIGUSR1 SIGUSR2
SIGWINCH alarm pthread_sigmask setitimer sigpending sigwait
""",
    select: "epoll poll",
    mmap: "MAP_ANONYMOUS MAP_PRIVATE PROT_READ PROT_WRITE",
}


def hide() -> None:
    for name in LIBRARIES.split():
        with suppress(ImportError):
            importlib.import_module(name)
    copies = {module: _copy_of(module) for module in (*NAMES, sys)}
    for module in {*sys.modules.values()} - {*copies, sys.modules[__name__]}:
        for name, value in list(vars(module).items()):
            if isinstance(value, ModuleType) and value in copies:
                setattr(module, name, copies[value])
    for module, names in NAMES.items():
        for name in names.split():
            if hasattr(module, name):
                delattr(module, name)
    hidden = MODULES.split()
    loaded = [each for each in sys.modules if each.partition(".")[0] in hidden]
    sys.modules.update(dict.fromkeys([*hidden, *loaded]))  # type: ignore[arg-type]
    sys.modules["msvcrt"] = _Msvcrt("msvcrt")
    os.name, sys.platform = "nt", "win32"


class _Msvcrt(ModuleType):
    """The part of Windows' module that locks files, by the locks of POSIX."""

    LK_NBLCK = 2
    _flock = staticmethod(fcntl.flock)

    def locking(self, descriptor: int, mode: int, _: int) -> None:
        assert mode == self.LK_NBLCK
        try:
            self._flock(descriptor, _AT_ONCE)
        except BlockingIOError as error:
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES)) from error


_AT_ONCE = fcntl.LOCK_EX | fcntl.LOCK_NB


def _copy_of(module: ModuleType) -> ModuleType:
    copy = ModuleType(module.__name__)
    vars(copy).update(vars(module))
    return copy


assert asyncio.subprocess is not None
hide()
