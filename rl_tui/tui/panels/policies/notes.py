"""What is said below the figures of policies: what exploring costs, what is missing to the best, and why."""

from __future__ import annotations

from collections.abc import Iterator

from rl_tui.agents.catalogue import POLICY_BY_ID
from rl_tui.lab.answers.policy_kind import PolicyKind
from rl_tui.lab.answers.policy_values import TOO_MANY, WHILE_RUNNING
from rl_tui.lab.live.snapshot import Snapshot
from rl_tui.tui.draw import numbers
from rl_tui.tui.panels.policies.names import POLICY_NAMES
from rl_tui.tui.panels.policies.studied import is_kept_back
from rl_tui.tui.panels.policies.table import amount, answer_of, has_row
from rl_tui.tui.theme.look import Look
from rl_tui.worlds.drawing import Arms

Note = tuple[str, bool]


def notes(snapshot: Snapshot, look: Look) -> Iterator[Note]:
    """Yield the notes, those that matter most first, and of each whether it is about figures."""
    is_bandit = isinstance(snapshot.world.drawing, Arms)
    if is_bandit and is_kept_back(snapshot, PolicyKind.UNIFORM):
        yield "what they earn tells of the true means: h shows them", False
        return
    yield from _gaps(snapshot, look)
    yield from _reasons(snapshot)
    if is_bandit:
        yield f"a pull: the reward it brings on average{_as_means_are(snapshot)}, exact", False
        return
    limit, gamma = snapshot.world.space.time_limit, snapshot.agent.hyperparameters.gamma
    within = f" within {limit:,} steps" if limit else ""
    yield f"return: expected, undiscounted,{within or ' without a limit'}", False
    yield f"at start: V there, γ {numbers.brief(gamma, look.glyphs)}, as if without a limit", False


def _as_means_are(snapshot: Snapshot) -> str:
    """Return which means of the arms the figures are of, where these drift; else nothing."""
    mdp = snapshot.world.mdp
    return ", of the means as they are now" if mdp is not None and mdp.drift_std else ""


def return_of(snapshot: Snapshot, kind: PolicyKind) -> float | None:
    """Return the exact return of a policy; None where it is not known or not to be seen."""
    if is_kept_back(snapshot, kind) or not has_row(snapshot, kind):
        return None
    return answer_of(snapshot, kind).expected_return


def _gaps(snapshot: Snapshot, look: Look) -> Iterator[Note]:
    """Yield what lies between acting and greedy, and between greedy and the best."""
    acts, greedy, best = (
        return_of(snapshot, kind) for kind in (PolicyKind.BEHAVIOUR, PolicyKind.GREEDY, PolicyKind.OPTIMAL)
    )
    what = "a pull" if isinstance(snapshot.world.drawing, Arms) else "an episode"
    if greedy is not None and acts is not None:
        yield f"{exploring(greedy - acts, snapshot, look)} {what}", True
    if greedy is not None and best is not None:
        gap = best - greedy
        if not _amount(gap, look):
            yield "greedy earns as much as optimal", True
        elif gap > 0.0:
            yield f"greedy is {_amount(gap, look)} {what} short of optimal", True
        else:
            yield f"greedy earns {_amount(-gap, look)} {what} more than optimal for this γ", True


def exploring(cost: float, snapshot: Snapshot, look: Look) -> str:
    """Return what exploring costs, or brings where greedy earns less, with the ε in force."""
    values = snapshot.agent.hyperparameters
    rate = ""
    if POLICY_BY_ID[values.policy].explores_by_epsilon:
        epsilon = round(values.epsilon_at(snapshot.counters.episodes), 3)
        rate = f" (ε {numbers.brief(epsilon, look.glyphs)})"
    if not _amount(cost, look):
        return f"exploring{rate} costs nothing"
    return f"exploring{rate} {'costs' if cost > 0.0 else 'brings'} {_amount(abs(cost), look)}"


def _amount(x: float, look: Look) -> str:
    """Return an amount, empty for none."""
    return "" if abs(x) < numbers.NEGLIGIBLE else amount(x, look)


def _reasons(snapshot: Snapshot) -> Iterator[Note]:
    """Yield why figures are lacking, a reason once."""
    said = set[str]()
    for kind, name in POLICY_NAMES.items():
        if is_kept_back(snapshot, kind):
            yield f"{name.line}: hidden, h shows it", False
        elif not has_row(snapshot, kind):
            if answer_of(snapshot, kind).is_known:
                yield "drawn: nothing yet, D draws", False
        elif (refused := answer_of(snapshot, kind).refused) and refused not in said:
            said.add(refused)
            is_of_all = refused in (TOO_MANY, WHILE_RUNNING)
            yield refused if is_of_all else f"{name.line}: {refused}", False
        elif answer_of(snapshot, kind).is_known and answer_of(snapshot, kind).expected_return is None:
            ends = answer_of(snapshot, kind).ends
            if ends is not None:
                share = f"ends in {numbers.percent(ends)}" if ends else "never ends"
                yield f"{name.line}: {share}, so it has no return", False
