"""The server's address, and the check of who may connect.

A page of another site in the same browser can send requests to 127.0.0.1. Browsers let it open WebSockets and
only report its site in ``Origin``. A site can also point its name to 127.0.0.1 after loading (DNS rebinding).
Then the origin matches, but the name is in ``Host``. So both headers are checked.
"""

from __future__ import annotations

import errno
import socket
import sys
from dataclasses import dataclass
from ipaddress import ip_address
from typing import Final
from urllib.parse import urlsplit

from rl_tui.common.errors import UserError

_THIS_MACHINE: Final = ("localhost", "127.0.0.1", "::1")


def bind(host: str, port: int) -> socket.socket:
    """Return a socket bound to `port` (0: any free one), not listening yet.

    Raises:
        UserError: The address is unknown or in use.
    """
    try:
        family, _, _, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
    except socket.gaierror as fault:
        raise UserError(f"--host {host}: unknown host name ({fault.strerror})") from None
    except OSError as fault:
        raise _cannot_listen(host, port, fault) from None
    bound = socket.socket(family, socket.SOCK_STREAM)
    try:
        if sys.platform != "win32":  # on Windows two programs could then share a port
            bound.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        if family == socket.AF_INET6:
            bound.setsockopt(socket.IPPROTO_IPV6, socket.IPV6_V6ONLY, 1)
        bound.bind((address[0], port))
    except OSError as fault:
        bound.close()
        raise _cannot_listen(host, port, fault) from None
    return bound


def listen(bound: socket.socket, host: str) -> None:
    """Accept connections on a socket from :func:`bind`, or raise UserError."""
    try:
        bound.listen()
    except OSError as fault:  # another program bound the same port and was faster
        raise _cannot_listen(host, bound.getsockname()[1], fault) from None


def _cannot_listen(host: str, port: int, fault: OSError) -> UserError:
    if fault.errno == errno.EADDRINUSE:
        advice = "another program uses it; take another --port, or --port 0 for a free one"
    elif fault.errno == errno.EACCES:
        advice = "ports below 1024 are kept for the system; take another --port"
    elif fault.errno == errno.EADDRNOTAVAIL:
        advice = "this machine does not have that address"
    else:
        advice = fault.strerror or str(fault)
    return UserError(f"cannot listen on port {port} of {host}: {advice}")


def is_this_machine(host: str) -> bool:
    """Return True if only this machine can reach a name or an address."""
    try:
        found = socket.getaddrinfo(host.strip("[]"), None, type=socket.SOCK_STREAM)
    except OSError:
        return False
    return bool(found) and all(ip_address(str(each[4][0]).split("%")[0]).is_loopback for each in found)


def url_of(listening: socket.socket) -> str:
    """Return the URL of a listening socket."""
    host, port = listening.getsockname()[:2]
    return f"http://[{host}]:{port}/" if ":" in host else f"http://{host}:{port}/"


@dataclass(frozen=True, slots=True)
class Doorkeeper:
    """The check of request headers. `url` is what people type."""

    host: str
    url: str | None = None

    def knows(self, asked_for: str) -> bool:
        """Return True if a request with this ``Host`` header is meant for this server.

        Numeric addresses always pass, since nobody can redirect them. A name must be ours.
        """
        name = _name(asked_for)
        return name in self._names() or _is_address(name)

    def lets_in(self, origin: str, asked_for: str) -> bool:
        """Return True if a page came from this server, by ``Origin`` and ``Host``."""
        if not self.knows(asked_for):
            return False
        if self.url is not None and origin.lower() == _origin(self.url):
            return True
        scheme, _, place = origin.lower().partition("://")
        return scheme in ("http", "https") and place == asked_for.lower()

    def _names(self) -> set[str]:
        names = {*_THIS_MACHINE, self.host.lower().strip("[]")}
        if not is_this_machine(self.host):
            names |= {socket.gethostname().lower(), socket.getfqdn().lower()}
        if self.url is not None:
            names.add(_name(urlsplit(self.url).netloc))
        return names - {"", "0.0.0.0", "::"}


def _name(netloc: str) -> str:
    # The host of "host:port", without brackets
    try:
        return urlsplit(f"//{netloc}").hostname or ""
    except ValueError:
        return ""


def _origin(url: str) -> str:
    parts = urlsplit(url)
    return f"{parts.scheme}://{parts.netloc}".lower()


def _is_address(name: str) -> bool:
    try:
        ip_address(name)
    except ValueError:
        return False
    return True
