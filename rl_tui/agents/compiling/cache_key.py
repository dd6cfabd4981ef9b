"""What the machine code of the kernels comes from: the modules that can have put something into it.

Numba freezes what a kernel reads from a module, its own or one it imports: a helper's code, a number of
``stop.py``, a place in ``SCHEDULES``. So the key is a hash over every module that marks something as compiled
or inlined, the one that compiles it, the one that has machine code in place of Python, and all that these
import, in turn. It is a superset: a few of them only prepare arrays.
"""

from __future__ import annotations

import hashlib
import os
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Final

import numpy as np

PACKAGE: Final = Path(__file__).parents[2]
NAME: Final = PACKAGE.name
DECORATORS: Final = "rl_tui.agents.kernels.compiled"
COMPILER: Final = "rl_tui.agents.compiling.jit"
NATIVE: Final = "rl_tui.agents.compiling.native"
# Who imports one of these has kernels, or what they inline
MARKS: Final = frozenset(
    f"{DECORATORS}.{mark}"
    for mark in ("compiled", "compiled_for", "for_kernels", "inlined", "inlined_by_type", "member_of")
)

# To parse the sources would take ten times as long; the tests hold this against it. The package's name comes
# first, since what begins with a fixed text is found quickly
_IMPORT: Final = re.compile(
    rb"rl_tui(?:(?<=from\srl_tui)|(?<=import\srl_tui))([\w.]*)(?: import (\([^)]*\)|.*))?"
)
_NAME: Final = re.compile(rb"\w+")
_FOR_TYPES: Final = re.compile(rb"^if TYPE_CHECKING:\n(?:(?:[ \t].*)?\n)*", re.MULTILINE)


def cache_key(package: Path = PACKAGE) -> str:
    """Return numba's version and a hash over NumPy's and the kernels' sources in ``package``, as one name.

    It is the same wherever ``package`` stands. That takes some 5 ms.
    """
    from importlib.metadata import PackageNotFoundError, version

    try:
        numba = version("numba")
    except PackageNotFoundError:  # then there is no machine code either
        numba = "0"
    digest = hashlib.sha256(np.__version__.encode())
    for module, source in sorted(kernel_sources(package).items()):
        digest.update(f"{module} {len(source)} ".encode())
        digest.update(source)
    return f"{numba}-{digest.hexdigest()[:16]}"


def kernel_sources(package: Path = PACKAGE) -> dict[str, bytes]:
    """Return the source of every module that the key depends on, by the module's name."""
    files = dict(_modules(package))
    room = ".".join(DECORATORS.split(".")[:2])
    read = {module: Path(file).read_bytes() for module, file in files.items() if module.startswith(room)}
    found = dict[str, bytes]()
    waiting = [
        COMPILER,
        NATIVE,
        *(module for module, source in read.items() if not MARKS.isdisjoint(imports(source))),
    ]
    while waiting:
        module = waiting.pop()
        if module in files and module not in found:
            found[module] = read[module] if module in read else Path(files[module]).read_bytes()
            # How the compiler keeps what it has made puts nothing into it
            waiting += imports(found[module]) if module != COMPILER else ()
    return found


def imports(source: bytes) -> set[str]:
    """Return what ``source`` imports of this package when it runs, within functions too.

    Of ``from a import b`` that is a and a.b, which may be no module.
    """
    if b"TYPE_CHECKING" in source:
        source = _FOR_TYPES.sub(b"", source)
    found = set[str]()
    for inside, names in _IMPORT.findall(source):
        origin = NAME + inside.decode()
        found.add(origin)
        found.update(f"{origin}.{name.decode()}" for name in _NAME.findall(names))
    return found


def _modules(package: Path) -> Iterator[tuple[str, str]]:
    """Yield the name and the file of each module in ``package``."""
    for folder, _, names in os.walk(package):
        inside = os.path.relpath(folder, package)
        parts = [NAME] if inside == os.curdir else [NAME, *inside.split(os.sep)]
        for name in names:
            stem, ending = os.path.splitext(name)
            if ending == ".py":
                yield ".".join(parts if stem == "__init__" else [*parts, stem]), os.path.join(folder, name)
