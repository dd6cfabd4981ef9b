"""A temporary OpenSSH server."""

from __future__ import annotations

import getpass
import grp
import os
import shutil
import socket
import subprocess
import time
from collections.abc import Mapping
from pathlib import Path
from types import TracebackType
from typing import Final

DEADLINE: Final = 120.0
_LOOK_AGAIN: Final = 0.02  # seconds
_PRIVILEGE_SEPARATION: Final = Path("/run/sshd")  # a server that runs as root insists on this folder


def why_not() -> str:
    if _server() is None or shutil.which("ssh") is None:
        return "needs sshd and ssh: apt-get install openssh-server openssh-client"
    if os.getuid() == 0 and not _PRIVILEGE_SEPARATION.is_dir():
        try:
            _PRIVILEGE_SEPARATION.mkdir(mode=0o755)
        except OSError as error:
            return f"needs the folder {_PRIVILEGE_SEPARATION}, which sshd wants of root: {error.strerror}"
    if os.getuid() != 0 and not _terminals_have_their_group():
        return "needs root, or terminals of the group tty (devpts with gid=): sshd cannot give them to it"
    return ""


def _terminals_have_their_group() -> bool:
    """A new terminal has the group that sshd needs, which only root could change."""
    ours, theirs = os.openpty()
    try:
        group = os.fstat(theirs).st_gid
    finally:
        os.close(ours)
        os.close(theirs)
    return group == next((each.gr_gid for each in grp.getgrall() if each.gr_name == "tty"), os.getgid())


def _server() -> str | None:
    return shutil.which(
        "sshd", path=os.pathsep.join((os.environ.get("PATH", ""), "/usr/sbin", "/usr/local/sbin"))
    )


class SshServer:
    """Serves on a free port of the loopback interface, from ``folder``, with keys of its own.

    ``rules`` are more lines of its configuration.
    """

    def __init__(self, folder: Path, environment: Mapping[str, str], rules: str = "") -> None:
        self._folder = folder
        for key in ("host_key", "user_key"):
            subprocess.run(
                ["ssh-keygen", "-q", "-t", "ed25519", "-N", "", "-f", str(folder / key)],
                check=True,
                timeout=DEADLINE,
            )
        shutil.copy(folder / "user_key.pub", folder / "authorized_keys")
        variables = " ".join(f'"{name}={value}"' for name, value in environment.items())
        (folder / "sshd_config").write_text(
            f"HostKey {folder}/host_key\n"
            f"AuthorizedKeysFile {folder}/authorized_keys\n"
            "PidFile none\n"
            "UsePAM no\n"
            "StrictModes no\n"
            "PermitRootLogin prohibit-password\n"
            "Subsystem sftp internal-sftp\n"
            f"SetEnv {variables}\n"
            f"{rules}",
            encoding="utf-8",
        )

    def __enter__(self) -> SshServer:
        deadline = time.perf_counter() + DEADLINE
        while not self._start(deadline):
            assert "in use" in self.log, self.log  # another program took the port, and may answer there
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._process.terminate()
        self._process.wait(DEADLINE)

    def _start(self, deadline: float) -> bool:
        with socket.socket() as chosen:
            chosen.bind(("127.0.0.1", 0))
            self.port = chosen.getsockname()[1]
        command = [_server() or "sshd", "-D", "-e", "-f", str(self._folder / "sshd_config")]
        address = ["-o", f"ListenAddress=127.0.0.1:{self.port}"]
        with (self._folder / "log").open("wb") as log:
            self._process = subprocess.Popen([*command, *address], stdin=subprocess.DEVNULL, stderr=log)
        while "Server listening" not in self.log:
            if self._process.poll() is not None:
                return False
            if time.perf_counter() > deadline:
                self._process.kill()
                raise AssertionError(self.log)
            time.sleep(_LOOK_AGAIN)
        return True

    @property
    def log(self) -> str:
        return (self._folder / "log").read_text(encoding="utf-8", errors="replace")

    def login(self, *options: str) -> list[str]:
        """Return the login command up to the host name."""
        return ["ssh", *self._settings, "-p", str(self.port), *options, f"{getpass.getuser()}@127.0.0.1"]

    def transfer(self, program: str, *options: str) -> list[str]:
        return [program, *self._settings, "-P", str(self.port), *options]

    @property
    def _settings(self) -> list[str]:
        settings = {
            "IdentityFile": f"{self._folder}/user_key",
            "IdentitiesOnly": "yes",
            "UserKnownHostsFile": f"{self._folder}/known_hosts",
            "StrictHostKeyChecking": "accept-new",
            "BatchMode": "yes",
            "LogLevel": "ERROR",
        }
        return ["-F", "none", *(f"-o{name}={value}" for name, value in settings.items())]
