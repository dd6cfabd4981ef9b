"""The fingerprint of a transition table."""

from __future__ import annotations

import hashlib
from dataclasses import fields
from typing import Final

import numpy as np

from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

_PIECE: Final = 65_536  # names per piece, to save memory with large worlds


def table_digest(mdp: TabularMDP) -> str:
    """Return the SHA-256 of all content. Equal tables have equal digests."""
    digest = hashlib.sha256()
    for each in fields(mdp):
        value = getattr(mdp, each.name)
        digest.update(f"{each.name}:".encode())
        if isinstance(value, np.ndarray):
            digest.update(f"{value.dtype.str}{value.shape}".encode())
            digest.update(np.ascontiguousarray(value).data)
        elif isinstance(value, (int, float)):
            digest.update(repr(float(value)).encode())
        else:
            for first in range(0, len(value), _PIECE):
                digest.update("\0".join([*value[first : first + _PIECE], ""]).encode())
    return digest.hexdigest()
