"""How much memory the runs on screen may take to remember what they have been through."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from rl_tui.common.kiosk import in_kiosk


@dataclass(frozen=True, slots=True)
class Limits:
    """What one lane may keep, of which there are four at the most.

    ``checkpoints`` and ``samples`` are bytes of the branch in force, ``checkpoints_left`` and
    ``samples_left`` those of all others together. ``branches`` and ``changes``, in all of them together, are
    None where only the session file limits them.
    """

    checkpoints: int
    checkpoints_left: int
    samples: int
    samples_left: int
    branches: int | None = None
    changes: int | None = None


USUAL: Final = Limits(256 * 2**20, 128 * 2**20, 32 * 2**20, 64 * 2**20)
KIOSK: Final = Limits(8 * 2**20, 4 * 2**20, 2 * 2**20, 2 * 2**20, branches=50, changes=5_000)


def limits() -> Limits:
    """Return what is in force in this process."""
    return KIOSK if in_kiosk() else USUAL
