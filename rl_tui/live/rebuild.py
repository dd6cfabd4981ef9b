"""The next world of a run, built in a thread of its own while something else goes on."""

from __future__ import annotations

import threading

from rl_tui.runs.edited_world import EditedWorld, NextWorld, next_world
from rl_tui.runs.recipe import Recipe, WorldChange


class Rebuild:
    """Builds one world at a time, so that no more than one is in memory beside that in force.

    One that nobody waits for any more is built to its end and dropped; the next begins then.
    """

    def __init__(self) -> None:
        self._work: _Work | None = None

    def of(self, before: EditedWorld, change: WorldChange, recipe: Recipe) -> NextWorld | None:
        """Return what ``change`` makes of ``before``, once; None while it is built. It begins where it can.

        Raises what made it fail.
        """
        work = self._work
        if work is None or (work.is_over and not work.is_of(before, change)):
            self._work = work = _Work(before, change, recipe)
        if not work.is_over or not work.is_of(before, change):
            return None
        self._work = None
        return work.result()

    def give_up(self) -> None:
        """Drop what is built, or is being built: nobody waits for it."""
        if self._work is not None and self._work.give_up():
            self._work = None


class _Work:
    """One world that is built, in a thread that does not keep the process alive."""

    def __init__(self, before: EditedWorld, change: WorldChange, recipe: Recipe) -> None:
        self._before, self._change, self._recipe = before, change, recipe
        self._lock = threading.Lock()
        self._is_wanted = True
        self._outcome: NextWorld | BaseException | None = None
        self.is_over = False
        """Whether it has been built, or has failed."""
        threading.Thread(target=self._build, name="world", daemon=True).start()

    def is_of(self, before: EditedWorld, change: WorldChange) -> bool:
        """Return whether it is what ``change`` makes of ``before``, and was not given up."""
        return self._is_wanted and self._before is before and self._change == change

    def result(self) -> NextWorld:
        """Return what was built; raises what made it fail."""
        if isinstance(self._outcome, NextWorld):
            return self._outcome
        assert self._outcome is not None
        raise self._outcome

    def give_up(self) -> bool:
        """Keep nothing of it; return whether it is over."""
        with self._lock:
            self._is_wanted, self._outcome = False, None
            return self.is_over

    def _build(self) -> None:
        try:
            outcome: NextWorld | BaseException = next_world(self._before, self._change, self._recipe)
        except BaseException as fault:
            outcome = fault
        with self._lock:
            self._outcome = outcome if self._is_wanted else None
            self.is_over = True
