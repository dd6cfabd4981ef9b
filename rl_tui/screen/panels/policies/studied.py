"""The studied policy in other panels."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np
from rich.style import Style

from rl_tui.agents.exact.policy_figures import best_pairs
from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.answers.policy_kind import PolicyKind
from rl_tui.runs.answers.policy_values import WHILE_RUNNING
from rl_tui.screen.kit.layers import with_exact
from rl_tui.screen.kit.snapshot_facts import studied_answer
from rl_tui.screen.theme.roles import Palette
from rl_tui.worlds.mdp.space import BoolArray, FloatArray

POLICY_NAMES: Final = {
    PolicyKind.UNIFORM: "random",
    PolicyKind.GREEDY: "greedy",
    PolicyKind.BEHAVIOUR: "agent",
    PolicyKind.OPTIMAL: "optimal",
    PolicyKind.DRAWN: "drawn",
}
"""In display order."""


def policy_name(kind: PolicyKind) -> str:
    """Name a policy as after ``V of``."""
    return "the agent" if kind is PolicyKind.BEHAVIOUR else f"the {POLICY_NAMES[kind]} policy"


def policy_ink(kind: PolicyKind, palette: Palette) -> Style:
    """Return a policy's colour in every panel."""
    inks = palette.text, palette.greedy_line, palette.episodes, palette.dim, palette.you
    return dict(zip(POLICY_NAMES, inks, strict=True))[kind]


def study_headings(
    snapshot: Snapshot, shown: PolicyKind | None, title: str, what: str, *, names_key: bool
) -> tuple[str, ...]:
    """Return headings for ``what`` (V or Q) of ``shown``, and of a policy that waits for a pause."""
    if shown is not None:
        said = f"{what} of {policy_name(shown)}"
        forms = (f"{title} · {said}", said, f"{what}: {POLICY_NAMES[shown]}")
        return (f"{title} · {said} · t p: policies", *forms) if names_key else forms
    answers = snapshot.answers
    if answers.studied is None:
        return ()
    answer = answers.policies.get(answers.studied)
    if answer is None or answer.refused != WHILE_RUNNING:
        return ()
    note = f"pause: {what} of {policy_name(answers.studied)}"
    return f"{title} · {what} and greedy · {note}", f"{title} · {note}", note


def shown_actions(snapshot: Snapshot, kind: PolicyKind, policy: FloatArray) -> BoolArray:
    """Return the likeliest, or drawn, actions, [P]."""
    space = snapshot.world.space
    likeliest = best_pairs(space, policy)
    if kind is PolicyKind.DRAWN:
        is_drawn = np.zeros(space.states, np.bool_)
        is_drawn[[state for state, _ in snapshot.answers.drawn.choices]] = True
        likeliest &= np.repeat(is_drawn, np.diff(space.first_pair))
    return likeliest


def as_studied(snapshot: Snapshot) -> Snapshot:
    """Put the studied policy in place of the learned one."""
    answer, kind = studied_answer(snapshot), snapshot.answers.studied
    if answer is None or kind is None or answer.policy is None or answer.v is None or answer.q is None:
        return snapshot
    if snapshot.world.is_bandit:
        return snapshot
    policy = shown_actions(snapshot, kind, answer.policy).astype(np.float64)
    agent = with_exact(snapshot, answer.v, answer.q, policy)
    beside = None if snapshot.beside is None else as_studied(snapshot.beside)
    return replace(snapshot, agent=agent, beside=beside)
