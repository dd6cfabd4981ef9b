"""The notes below the table of policies.

They state the cost of exploring, the gap to the optimal policy, and why a number is missing.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Final

from rl_tui.agents.catalogue import POLICY_BY_ID
from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.answers.policy_kind import PolicyKind
from rl_tui.runs.answers.policy_values import PENDING, TOO_MANY, WHILE_RUNNING, PolicyAnswer
from rl_tui.screen.draw import numbers
from rl_tui.screen.kit.snapshot_facts import shown_by
from rl_tui.screen.panels.last_step.update_text import setting
from rl_tui.screen.panels.policies.names import POLICY_NAMES
from rl_tui.screen.panels.policies.studied import is_kept_back
from rl_tui.screen.theme.glyphs import Glyphs
from rl_tui.screen.theme.look import Look
from rl_tui.worlds.drawing import Arms

OF_MEANS_NOW: Final = "of the means as they are now"
WITHOUT_LIMIT: Final = "as if without a limit"
AS_MUCH_AS_OPTIMAL: Final = "greedy earns as much as optimal"
SHORT_OF_OPTIMAL: Final = "short of optimal"
_GAMMA_BEST: Final = "best for this γ (γ-best)"
_NO_ENDING: Final = 0.9995  # from there on it is written as 100 %
WIDEST: Final = 8  # cells of the widest number
Note = tuple[str, bool]


def notes(snapshot: Snapshot, look: Look) -> Iterator[Note]:
    """Yield the notes, those that matter most first, and of each whether it is about figures."""
    is_bandit = isinstance(snapshot.world.drawing, Arms)
    if is_bandit and is_kept_back(snapshot, PolicyKind.UNIFORM):
        yield f"what they earn tells of the true means: {shown_by(snapshot, 'them')}", False
        return
    yield from _gaps(snapshot, look)
    yield from _reasons(snapshot)
    if is_bandit:
        yield f"a pull: the reward it brings on average{_as_means_are(snapshot)}, exact", False
        yield "optimal: the best arm", False
        return
    limit, gamma = snapshot.world.space.time_limit, snapshot.agent.hyperparameters.gamma
    within = f" within {limit:,} steps" if limit else ""
    if may_not_end(known_answers(snapshot)):
        yield f"ending: the chance that an episode ends{within}", False
    yield f"return: expected, undiscounted,{within or ' without a limit'}", False
    as_if = f", {WITHOUT_LIMIT}" if limit else ""
    yield f"at start: V there, γ {numbers.brief(gamma, look.glyphs)}{as_if}", False
    if not is_kept_back(snapshot, PolicyKind.OPTIMAL):
        yield f"optimal: {_GAMMA_BEST}", False


def amount(x: float, look: Look, width: int = WIDEST) -> str:
    """Return an exact figure in ``width`` cells."""
    return numbers.figure(x, width, look.glyphs)


def answer_of(snapshot: Snapshot, kind: PolicyKind) -> PolicyAnswer:
    """Return what is known of a policy."""
    return snapshot.answers.policies.get(kind, PENDING)


def known_answers(snapshot: Snapshot) -> list[PolicyAnswer]:
    """Return what is known of the policies that may be seen."""
    return [answer_of(snapshot, kind) for kind in POLICY_NAMES if not is_kept_back(snapshot, kind)]


def may_not_end(known: Iterable[PolicyAnswer]) -> bool:
    """Return whether an episode of any of these policies may go on; then a column says how likely it ends.

    That matters more than how long episodes are.
    """
    return any(each.ends is not None and each.ends < _NO_ENDING for each in known)


def _as_means_are(snapshot: Snapshot) -> str:
    """Return which means of the arms the figures are of, where these drift; else nothing."""
    mdp = snapshot.world.mdp
    return f", {OF_MEANS_NOW}" if mdp is not None and mdp.drift_std else ""


def return_of(snapshot: Snapshot, kind: PolicyKind) -> float | None:
    """Return the exact return of a policy; None where it is not known or not to be seen."""
    return None if is_kept_back(snapshot, kind) else answer_of(snapshot, kind).expected_return


def _gaps(snapshot: Snapshot, look: Look) -> Iterator[Note]:
    """Yield what lies between acting and greedy, and between greedy and the best."""
    acts, greedy, best = (
        return_of(snapshot, kind) for kind in (PolicyKind.BEHAVIOUR, PolicyKind.GREEDY, PolicyKind.OPTIMAL)
    )
    what = "a pull" if isinstance(snapshot.world.drawing, Arms) else "an episode"
    if greedy is not None and acts is not None:
        yield exploring(greedy - acts, what, snapshot, look), True
    if greedy is not None and best is not None:
        gap = best - greedy
        if not _amount(gap, look):
            yield AS_MUCH_AS_OPTIMAL, True
        elif gap > 0.0:
            yield f"greedy is {_amount(gap, look)} {what} {SHORT_OF_OPTIMAL}", True
        else:
            yield f"greedy earns {_amount(-gap, look)} {what} more than optimal", True


def exploring(cost: float, what: str, snapshot: Snapshot, look: Look) -> str:
    """Return what exploring costs, with the ε in force, or brings where greedy earns less.

    ``what`` it costs that is an episode or a pull.
    """
    size = _amount(abs(cost), look)
    said, _ = cost_of_exploring(cost, size or "nothing", snapshot, look.glyphs)
    return f"{said} {what}" if size else said


def cost_of_exploring(cost: float, size: str, snapshot: Snapshot, glyphs: Glyphs) -> tuple[str, str]:
    """Return what exploring costs, or brings where greedy earns less: with the ε in force, and without it.

    ``size`` is that of ``cost`` as it is written.
    """
    values = snapshot.agent.hyperparameters
    rate = ""
    if POLICY_BY_ID[values.policy].explores_by_epsilon:
        epsilon = round(values.epsilon_at(snapshot.counters.episodes), 3)
        rate = f" (ε {setting(epsilon, glyphs)})"
    said = f"{'brings' if cost <= -numbers.NEGLIGIBLE else 'costs'} {size}"
    return f"exploring{rate} {said}", f"exploring {said}"


def _amount(x: float, look: Look) -> str:
    """Return an amount, empty for none."""
    return "" if abs(x) < numbers.NEGLIGIBLE else amount(x, look)


def _reasons(snapshot: Snapshot) -> Iterator[Note]:
    """Yield why figures are lacking, a reason once."""
    said = set[str]()
    if not snapshot.answers.drawn.choices and answer_of(snapshot, PolicyKind.DRAWN).is_known:
        yield "nothing drawn: at random; D draws", False
    for kind, name in POLICY_NAMES.items():
        if is_kept_back(snapshot, kind):
            which = f" {_GAMMA_BEST}," if kind is PolicyKind.OPTIMAL else ""
            yield f"{name.line}:{which} hidden, {shown_by(snapshot)}", False
        elif (refused := answer_of(snapshot, kind).refused) and refused not in said:
            said.add(refused)
            is_of_all = refused in (TOO_MANY, WHILE_RUNNING)
            yield refused if is_of_all else f"{name.line}: {refused}", False
        elif answer_of(snapshot, kind).is_known and answer_of(snapshot, kind).expected_return is None:
            ends = answer_of(snapshot, kind).ends
            if ends is not None:
                share = f"ends in {numbers.percent(ends)}" if ends else "never ends"
                yield f"{name.line}: {share}, so it has no return", False
