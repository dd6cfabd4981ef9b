"""The unexpected: which fault it was, and what became of the session."""

from __future__ import annotations

import shlex
from typing import TYPE_CHECKING

from textual.worker import WorkerFailed

if TYPE_CHECKING:
    from rl_tui.live.sessions.autosave import Autosave


def bug_of(fault: Exception | None, autosave: Autosave | None) -> Exception:
    """Return the fault behind ``fault``, with a note on how to go on with the session, if any."""
    if isinstance(fault, WorkerFailed) and isinstance(fault.error, Exception):
        fault = fault.error
    if fault is None:
        fault = RuntimeError("no reason is known")
    if autosave is not None and autosave.path is not None:
        fault.add_note(f"what was done is kept: rl-tui play {shlex.quote(str(autosave.path))}")
    return fault
