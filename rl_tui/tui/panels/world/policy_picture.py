"""Whose values and actions a picture of a world shows: the agent's, a planner's policy, or one studied."""

from __future__ import annotations

from typing import Final

import numpy as np
from rich.style import Style

from rl_tui.lab.answers.policy_kind import PolicyKind
from rl_tui.lab.live.snapshot import Snapshot
from rl_tui.tui.panels.legend import (
    GREEDY_IN_FULL,
    POLICY_IN_FULL,
    Legend,
    LegendSign,
    no_table_sign,
    no_value_sign,
)
from rl_tui.tui.panels.panel import Panel
from rl_tui.tui.panels.policies.studied import studied_kind, study_headings
from rl_tui.tui.panels.snapshot_facts import is_new_run
from rl_tui.tui.panels.world.drawn import DRAWN_IN_FULL, random_signs
from rl_tui.tui.theme.look import Look

TITLE: Final = "World"


class PolicyPicture(Panel):
    """A picture with values and actions of states, and what it says of whose they are."""

    def __init__(self, look: Look, *, id: str | None = None, classes: str | None = None) -> None:  # noqa: A002
        super().__init__(look, id=id, classes=classes)
        self.names_policies_key = True
        """Whether its border names the key that opens the panel of policies: not while that is open."""
        self.differing: frozenset[int] = frozenset()
        """The states whose greedy actions are others in the lane beside; seen when it is drawn again."""

    def begins_anew(self, snapshot: Snapshot) -> bool:
        """Return whether the numbers of ``snapshot`` have nothing in common with those drawn until now."""
        before = self.snapshot
        if before is None or before.answers.studied is snapshot.answers.studied:
            return is_new_run(before, snapshot)
        return True

    @staticmethod
    def waits_for_study(snapshot: Snapshot) -> bool:
        """Return whether values of a policy are to come in place of those that ``snapshot`` shows."""
        return snapshot.answers.studied is not None and studied_kind(snapshot) is None

    @property
    def studied(self) -> PolicyKind | None:
        """The policy whose values and actions are drawn; None: they are what the agent has learned."""
        return None if self.snapshot is None else studied_kind(self.snapshot)

    def study_headings(self, what: str) -> tuple[str, ...]:
        """Return headings that say of which policy ``what`` is, or how to see it; none for the agent's."""
        if self.snapshot is None:
            return ()
        key = self.names_policies_key
        return study_headings(self.snapshot, self.studied, TITLE, what, names_key=key)

    def random_signs(self) -> Legend:
        """Return the signs of states in which nothing was drawn; none where no drawing is shown."""
        return random_signs(self.look) if self.shows_drawing else ()

    def valueless_signs(self) -> Legend:
        """Return the sign of a state of no value; none where there is no such state."""
        snapshot = self.snapshot
        if snapshot is None or self.studied is None or not np.isnan(snapshot.agent.values).any():
            return ()
        return (no_value_sign(self.look),)

    def study_signs(self, *, has_numbers: bool, has_actions: bool) -> Legend:
        """Return the signs of values of the policy that is studied, for cells with their numbers or without.

        Cells that have every action, in place of V, tell of tints themselves. None where none is studied.
        """
        if self.studied is None:
            return ()
        valueless = self.valueless_signs() if has_numbers or has_actions else ()
        return valueless if has_actions else (*valueless, *self.value_signs())

    def value_signs(self) -> Legend:
        """Return the sign of V(s), which is a colour; none where there are no colours.

        Where a program has no table it is that of a value that is missing.
        """
        palette, studied = self.look.palette, self.studied is not None
        if self.lacks_table:
            return (no_table_sign(self.look),)
        if not palette.tints:
            return ()
        name, in_full = ("Vπ", "value Vπ(s)") if studied else ("V", "value V(s)")
        return (LegendSign(" tint ", name, palette.value(1.0), in_full),)

    @property
    def lacks_table(self) -> bool:
        """Whether a program is watched of which no table is known."""
        program = None if self.snapshot is None else self.snapshot.program
        return program is not None and program.table is None and self.studied is None

    @property
    def shows_kept_policy(self) -> bool:
        """Whether arrows and values are those of the policy that a planner keeps, not the greedy ones."""
        return self.snapshot is not None and len(self.snapshot.agent.policy) > 0

    @property
    def shows_drawing(self) -> bool:
        """Whether actions are those that a person drew, whether their values are known or not."""
        return self.snapshot is not None and self.snapshot.answers.studied is PolicyKind.DRAWN

    @property
    def policy_shown(self) -> str:
        """What the arrows are, in a word."""
        if self.shows_drawing:
            return "drawn"
        return "policy" if self.shows_kept_policy else "greedy"

    def policy_sign(self, sign: str, style: Style) -> LegendSign:
        """Return the ``sign`` of the actions that are drawn."""
        in_full = POLICY_IN_FULL if self.shows_kept_policy else GREEDY_IN_FULL
        if self.shows_drawing:
            in_full = DRAWN_IN_FULL
        return LegendSign(sign, self.policy_shown, style, in_full)
