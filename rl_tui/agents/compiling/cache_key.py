"""The key of the machine code: a hash over all modules that can influence it.

Numba freezes everything that a kernel reads from modules: code of helpers, constants, indices. So the key
covers every module with marked functions, the compiler module, the native replacements, and all their
imports.
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
# A module that imports one of these has kernels, or functions that they inline
MARKS: Final = frozenset(
    f"{DECORATORS}.{mark}"
    for mark in ("compiled", "compiled_for", "for_kernels", "inlined", "inlined_by_type", "member_of")
)

# Parsing would take ten times as long; a test compares the two. The package name comes first, because a fixed
# prefix is found quickly
_IMPORT: Final = re.compile(
    rb"rl_tui(?:(?<=from\srl_tui)|(?<=import\srl_tui))([\w.]*)(?: import (\([^)]*\)|.*))?"
)
_NAME: Final = re.compile(rb"\w+")
_FOR_TYPES: Final = re.compile(rb"^if TYPE_CHECKING:\n(?:(?:[ \t].*)?\n)*", re.MULTILINE)


def cache_key(package: Path = PACKAGE) -> str:
    """Return numba's version with a hash over NumPy's version and the sources.

    The location of `package` does not matter.
    """
    from importlib.metadata import PackageNotFoundError, version

    try:
        numba = version("numba")
    except PackageNotFoundError:  # without numba there is no machine code
        numba = "0"
    digest = hashlib.sha256(np.__version__.encode())
    for module, source in sorted(kernel_sources(package).items()):
        digest.update(f"{module} {len(source)} ".encode())
        digest.update(source)
    return f"{numba}-{digest.hexdigest()[:16]}"


def kernel_sources(package: Path = PACKAGE) -> dict[str, bytes]:
    """Return the source of every module of the key, by name."""
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
            # Its imports only store code and do not influence it
            waiting += imports(found[module]) if module != COMPILER else ()
    return found


def imports(source: bytes) -> set[str]:
    """Return the modules of this package that `source` imports at run time, also inside functions.

    ``from a import b`` gives a and a.b, although a.b may not be a module.
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
    for folder, _, names in os.walk(package):
        inside = os.path.relpath(folder, package)
        parts = [NAME] if inside == os.curdir else [NAME, *inside.split(os.sep)]
        for name in names:
            stem, ending = os.path.splitext(name)
            if ending == ".py":
                yield ".".join(parts if stem == "__init__" else [*parts, stem]), os.path.join(folder, name)
