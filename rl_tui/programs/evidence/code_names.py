"""The names in a program for s, a, r, s′, Q, α and γ of the book."""

from __future__ import annotations

import ast
import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Final

from rl_tui.common.findings import one_line
from rl_tui.programs.evidence.code_places import CodeLine, ProgramCode
from rl_tui.programs.evidence.verdict import Rule, UpdateFound, UpdateTarget
from rl_tui.programs.watched.program_log import FoundTable

_USUAL: Final = {
    "state": ("state", "obs", "observation", "s", "current_state"),
    "action": ("action", "a", "act"),
    "reward": ("reward", "r", "rew"),
    "next_state": (
        *("next_state", "new_state", "next_obs", "next_observation", "s2", "s_next", "s_", "ns"),
        *("observation_", "next_s", "sp"),
    ),
    "terminated": ("terminated", "term", "terminal", "done"),
}
"""Common names in an update, the most frequent first."""
DISCOUNTS: Final = ("gamma", "discount", "discount_factor", "discount_rate", "df")
"""Common names of γ, the most frequent first."""
DISCOUNT: Final = re.compile(r"gamma|discount|γ|^(g|df)$", re.IGNORECASE)
EPSILONS: Final = ("epsilon", "eps", "ε", "exploration_rate", "explore_rate", "exploration_prob")
"""Common names of ε, the most frequent first."""
_SHOULD_READ: Final = {
    UpdateTarget.NEXT_ACTION: UpdateTarget.NEXT_ACTION,
    UpdateTarget.DRAWN: UpdateTarget.NEXT_ACTION,
    UpdateTarget.EXPECTED: UpdateTarget.EXPECTED,
    UpdateTarget.ALLOWED: UpdateTarget.ALLOWED,
}
"""The value of the next state that a correction names, if it is not the best."""
_RETURNED: Final = ("next_state", "reward", "terminated")
_AGENT: Final = "agent"
"""Name of an agent without its own loop in our loop."""
_LONGEST: Final = 40
_NEAR: Final = 1e-9


_NESTED: Final = ("lists", "dict-of-arrays", "dict-of-dicts")
"""Forms of a table with an index for the state, and another one for the action."""


@dataclass(frozen=True, slots=True)
class CodeNames:
    """Names or short expressions for a correction, by default the book's."""

    table: str = "Q"
    state: str = "s"
    action: str = "a"
    reward: str = "r"
    next_state: str = "s2"
    terminated: str = "terminated"
    alpha: str = "alpha"
    gamma: str = "gamma"
    environment: str = "env"
    form: str = "array"
    """Form of the table, as in `FoundTable`."""
    value: UpdateTarget = UpdateTarget.BEST
    """The value of the next state in the update, as it should be."""
    other: str = ""
    """The other one of two tables that change in turn."""

    def cell(self) -> str:
        """Write the updated estimate."""
        between = "][" if self.form in _NESTED else ", "
        return f"{self.table}[{self.state}{between}{self.action}]"

    def update(self) -> str:
        """Write the correct line of the update."""
        return f"{self.cell()} += {self.alpha} * (target - {self.cell()})"

    def rows(self, actions: int) -> str:
        """Write a table with separate rows."""
        if self.form == "dict-of-arrays":
            return f"{{state: [0.0] * {actions} for state in range(states)}}"
        return f"[[0.0] * {actions} for state in range(states)]"

    def best(self) -> str:
        """Write the next state's value."""
        if self.form == "dict-of-pairs":
            return f"max({self.table}[{self.next_state}, b] for b in actions)"
        if self.form == "dict-of-dicts":
            return f"max({self.table}[{self.next_state}].values())"
        return f"max({self.table}[{self.next_state}])"

    def random_tie(self) -> str:
        """Write a random choice among the best actions."""
        if self.form != "array":
            return "best = [a for a in actions if value of a == largest value]; action = random.choice(best)"
        row = f"{self.table}[{self.state}]"
        return f"{self.action} = np.random.choice(np.flatnonzero({row} == {row}.max()))"

    def target(self) -> str:
        """Write the correct line of the target."""
        value = self.best()
        between = "][" if self.form in _NESTED else ", "
        if self.value is UpdateTarget.ALLOWED:
            value = f"max({self.table}[{self.next_state}{between}b] for b in allowed)"
        elif self.value is UpdateTarget.BEST_BY_OTHER:
            value = f"{self.other}[{self.next_state}{between}argmax({self.table}[{self.next_state}])]"
        elif self.value is UpdateTarget.NEXT_ACTION:
            value = f"{self.table}[{self.next_state}{between}next_action]"
        elif self.value is UpdateTarget.EXPECTED:
            value = f"((1 - epsilon) * {value} + epsilon * mean({self.table}[{self.next_state}]))"
        reward = self.reward
        return f"target = {reward} if {self.terminated} else {reward} + {self.gamma} * {value}"


def names_of(
    code: ProgramCode, table: FoundTable, update: UpdateFound, numbers: Mapping[str, float]
) -> CodeNames:
    """Return the names at the update, with the book's for unknown ones."""
    value = _SHOULD_READ.get(update.target, UpdateTarget.BEST)
    if update.rule is Rule.DOUBLE_Q or (table.other and update.rule is Rule.UNKNOWN):
        value = UpdateTarget.BEST_BY_OTHER
    used, by_role = _written_in(code)
    found = dict(by_role)
    for role, number in (("alpha", update.alpha), ("gamma", update.gamma)):
        held = _held(numbers, number)
        if held is not None:
            found[role] = held
    short = {role: one_line(_as_written(name, used), _LONGEST) for role, name in found.items()}
    name, other = (one_line(_as_written(each, used), _LONGEST) for each in (table.name, table.other))
    return CodeNames(name, form=table.form, value=value, other=other, **short)


@lru_cache(maxsize=32)
def _written_in(code: ProgramCode) -> tuple[frozenset[str], Mapping[str, str]]:
    line = code.call_line() if code.lacks_update else code.update_line()
    used = _used_at(code, line)
    found: dict[str, str] = {}
    for role, usual in _USUAL.items():
        found.update((role, each) for each in reversed(usual) if each in used)
    return used, found | _returned_near(code, line)


def declared(numbers: Mapping[str, float], names: tuple[str, ...]) -> tuple[str, float] | None:
    """Return name and value of the first of `names`, if any."""
    named = {name.lower().rsplit(".", 1)[-1]: (name, value) for name, value in numbers.items()}
    return next((named[name] for name in names if name in named), None)


def _as_written(name: str, used: frozenset[str]) -> str:
    """Return an agent's attribute as its code writes it: `self.q` for `agent.q`."""
    head, _, attribute = name.partition(".")
    if head != _AGENT or not attribute or _AGENT in used:
        return name
    if "self" in used:
        return f"self.{attribute}"
    return attribute if attribute in used else name


def _used_at(code: ProgramCode, line: CodeLine | None) -> frozenset[str]:
    scope = None if line is None else code.scope_of(line)
    if scope is None:
        return frozenset()
    return frozenset(_names_in(scope))


def _names_in(scope: ast.AST) -> Iterator[str]:
    for node in ast.walk(scope):
        if isinstance(node, ast.Name):
            yield node.id
        elif isinstance(node, ast.arg):
            yield node.arg


def _returned_near(code: ProgramCode, line: CodeLine | None) -> dict[str, str]:
    call = code.step_call
    if call is None or line is None or code.scope_of(call.line) is not code.scope_of(line):
        return {}
    found = {"environment": ast.unparse(call.environment)} if call.environment is not None else {}
    if isinstance(call.argument, ast.Name):
        found["action"] = call.argument.id
    for role, target in zip(_RETURNED, call.unpacked, strict=False):
        if isinstance(target, ast.Name) and not target.id.startswith("_"):
            found[role] = target.id
    return found


def _held(numbers: Mapping[str, float], wanted: float | None) -> str | None:
    """Return the shortest name of a number, unless only constants have it."""
    if wanted is None:
        return None
    names = [
        name
        for name, each in numbers.items()
        if math.isclose(each, wanted, rel_tol=_NEAR) and name.replace(".", "_").isidentifier()
    ]
    return min(names, key=len, default=None)
