"""Where a player writes down what is done in a playground: a file, or nowhere."""

from __future__ import annotations

from typing import Protocol

from rl_tui.lab.live.record import Record
from rl_tui.worlds.mdp.space import FloatArray


class RecordSink(Protocol):
    """Is offered the newest record again and again, from the player's thread, and must not hold it up."""

    def offer(self, record: Record, q: FloatArray | None = None) -> None:
        """Take ``record`` as the newest; ``q``, [P], is the table where it stands, if that is at hand."""

    def begin_anew(self, record: Record) -> None:
        """Take ``record`` as the beginning of another session; the one until now stays as it is."""

    def close(self) -> None:
        """Keep what was offered last; nothing will be offered any more."""
