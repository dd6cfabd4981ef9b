"""Places in the source of a program. Nothing is executed."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, Final

from rl_tui.programs.evidence.syntax import (
    assigned,
    base_of,
    calls_of_step,
    chooses,
    first_name,
    inner_statements,
    is_main_guard,
    is_part_of,
    is_set_to_constant,
    is_simple,
    is_write,
    name_of,
    names_in,
    of_type,
    parsed_file,
    targets_of,
)
from rl_tui.programs.own_agents.binding import Style

if TYPE_CHECKING:
    from rl_tui.programs.watched.program_log import ProgramAgent, ProgramLog


# Functions that only read


_Function = ast.FunctionDef | ast.AsyncFunctionDef
_MODULES: Final = frozenset({"np", "numpy", "math", "random"})
_READING: Final = frozenset(
    {
        *("abs", "all", "any", "argmax", "bool", "choice", "dict", "enumerate", "flatnonzero"),
        *("float", "get", "getLegalActions", "int", "integers", "items", "keys", "len", "list"),
        *("max", "mean", "min", "rand", "randint", "random", "randrange", "range", "reversed"),
        *("round", "sample", "set", "sorted", "sum", "tolist", "tuple", "uniform", "values"),
        *("where", "zip", "print"),
    }
)
"""Functions and methods that change no table."""


def _is_elsewhere(target: ast.expr, table: str) -> bool:
    if isinstance(target, ast.Tuple):
        return all(_is_elsewhere(each, table) for each in target.elts)
    if isinstance(target, ast.Attribute):
        return bool(table) and target.attr != table
    return isinstance(target, ast.Name)


# Lines and calls


_MOST_FILES: Final = 16
_MOST_KEPT: Final = 32
"""Most programs whose code is cached, since a grade has as many at once as there are cores."""
_MOST_CALLS: Final = 3
"""Most calls followed from function to function."""
_CHOICE: Final = re.compile(r"action|policy|^act$|agent_start|choose|greedy", re.IGNORECASE)
"""Names of methods that choose an action."""


@dataclass(frozen=True, slots=True)
class CodeLine:
    """A line of a file, from 1."""

    file: str
    line: int


@dataclass(frozen=True, slots=True)
class StepCall:
    """A call of `env.step` with the targets of its result."""

    line: CodeLine
    environment: ast.expr | None
    argument: ast.expr | None
    unpacked: tuple[ast.expr, ...]


@dataclass(frozen=True, slots=True)
class _Statement:
    file: str
    node: ast.stmt

    @property
    def line(self) -> CodeLine:
        return CodeLine(self.file, self.node.lineno)


def program_code(log: ProgramLog) -> ProgramCode:
    """Return the program's source, cached while files and reports are the same."""
    files = [file for file, _ in (*log.called.values(), *log.lines)]
    trees = [(file, parsed_file(file)) for file in list(dict.fromkeys(files))[:_MOST_FILES]]
    changed_most = max(log.lines, key=lambda each: log.lines[each], default=None)
    return _code_of(
        tuple((file, tree) for file, tree in trees if tree is not None),
        tuple(log.called.items()),
        None if changed_most is None else CodeLine(*changed_most),
        "" if log.table is None else log.table.name.rpartition(".")[2],
        log.agent,
    )


@lru_cache(maxsize=_MOST_KEPT)
def _code_of(
    trees: tuple[tuple[str, ast.Module], ...],
    called: tuple[tuple[str, tuple[str, int]], ...],
    changed_most: CodeLine | None,
    table: str,
    agent: ProgramAgent | None,
) -> ProgramCode:
    return ProgramCode(dict(trees), dict(called), changed_most, table, agent)


class ProgramCode:
    """Syntax trees by file name. `called` has the lines that called `step` and `reset`."""

    def __init__(
        self,
        trees: Mapping[str, ast.Module],
        called: Mapping[str, tuple[str, int]],
        changed_most: CodeLine | None,
        table: str,
        agent: ProgramAgent | None,
    ) -> None:
        self._trees, self._called, self._changed_most = trees, called, changed_most
        self._name, self._agent = table, agent
        self._scopes: dict[CodeLine, ast.AST | None] = {}

    @cached_property
    def _statements(self) -> list[_Statement]:
        return [
            _Statement(file, node)
            for file, tree in self._trees.items()
            for node in ast.walk(tree)
            if isinstance(node, ast.stmt)
        ]

    @cached_property
    def _functions(self) -> dict[str, tuple[str, _Function]]:
        return {
            each.node.name: (each.file, each.node)
            for each in self._statements
            if isinstance(each.node, _Function)
        }

    @cached_property
    def _aliases(self) -> frozenset[str]:
        """Names of the table, including parameters, copies, rows and cells."""
        names = {self._name} - {""}
        for _ in range(3):  # the depth to which tables are passed
            names |= set(self._further_names(names))
        return frozenset(names)

    def _further_names(self, names: set[str]) -> Iterator[str]:
        for each in self._statements:
            for call in of_type(each.node, ast.Call):
                yield from self._parameters_given(call, names)
            target, value = assigned(each.node)
            if isinstance(target, ast.Name) and value is not None and is_part_of(value, names):
                yield target.id

    def _parameters_given(self, call: ast.Call, names: set[str]) -> Iterator[str]:
        function = self._functions.get(name_of(call.func))
        if function is None:
            return
        parameters = [each.arg for each in function[1].args.args]
        if parameters[:1] == ["self"]:
            parameters = parameters[1:]
        for parameter, argument in zip(parameters, call.args, strict=False):
            if name_of(argument) in names:
                yield parameter
        for keyword in call.keywords:
            if keyword.arg and name_of(keyword.value) in names:
                yield keyword.arg

    @cached_property
    def _writes(self) -> list[_Statement]:
        return [each for each in self._statements if is_write(each.node, self._aliases)]

    @cached_property
    def always_writes(self) -> bool:
        """True if the code after `env.step` always writes to the table.

        A write under an `if` without a writing `else` may be skipped in an evaluation.
        """
        return self._is_surely_done({id(each.node) for each in self._writes})

    @cached_property
    def writes_until_the_end(self) -> bool:
        """The same, but a test of the episode's end may skip it."""
        done = {id(each.node) for each in self._writes}
        for node in (each.node for each in self._statements if isinstance(each.node, ast.If)):
            parts = (self._is_always_in(part, done, _MOST_CALLS) for part in (node.body, node.orelse))
            if self._asks_for_end(node.test) and any(parts):
                done.add(id(node))
        return self._is_surely_done(done)

    def _is_surely_done(self, wanted: set[int]) -> bool:
        line = self.call_line()
        scope = None if line is None else self.scope_of(line)
        return self._is_always_in(getattr(scope, "body", []), wanted, _MOST_CALLS)

    def _asks_for_end(self, test: ast.expr) -> bool:
        results = () if self.step_call is None else self.step_call.unpacked
        flags = {name_of(each) for each in (results[2:4] if len(results) > 4 else results[2:3])} - {""}
        for each in self._statements:
            target, value = assigned(each.node)
            if isinstance(target, ast.Name) and value is not None and set() < names_in(value) <= flags:
                flags.add(target.id)
        return set() < names_in(test) <= flags

    @cached_property
    def reads_transitions(self) -> bool:
        """True if it reads a transition table, and may plan."""
        return any(
            attribute.attr == "P"
            for each in self._statements
            for attribute in of_type(each.node, ast.Attribute)
        )

    def _is_always_in(self, body: Iterable[ast.stmt], writes: set[int], depth: int) -> bool:
        return any(id(node) in writes or self._is_always_done(node, writes, depth) for node in body)

    def _is_always_done(self, node: ast.stmt, writes: set[int], depth: int) -> bool:
        if isinstance(node, _Function | ast.ClassDef):
            return False
        if isinstance(node, ast.If) and not is_main_guard(node):
            return all(self._is_always_in(part, writes, depth) for part in (node.body, node.orelse))
        if not is_simple(node):
            return self._is_always_in(inner_statements(node), writes, depth)
        called = [self._functions.get(name_of(call.func)) for call in of_type(node, ast.Call)]
        bodies = [each[1].body for each in called if each is not None and depth > 0]
        return any(self._is_always_in(inner, writes, depth - 1) for inner in bodies)

    @cached_property
    def lacks_update(self) -> bool:
        """True if an agent's update only reads."""
        line = self.call_line()
        function = None if line is None or self._agent is None else self.scope_of(line)
        if not isinstance(function, _Function) or self._agent is None:
            return False
        may_return = self._agent.style != Style.FUNCTION.value
        if not may_return and any(each.value is not None for each in of_type(function, ast.Return)):
            return False  # it may be a new table
        return self._only_reads(function, _MOST_CALLS)

    def _only_reads(self, function: _Function, depth: int) -> bool:
        """Return True if it certainly writes to no table. Without the table's name it may store nothing."""
        return all(self._is_harmless(node, depth) for part in function.body for node in ast.walk(part))

    def _is_harmless(self, node: ast.AST, depth: int) -> bool:
        match node:
            case ast.Assign(targets=targets):
                return all(_is_elsewhere(each, self._name) for each in targets)
            case ast.AnnAssign(target=target):
                return _is_elsewhere(target, self._name)
            case ast.AugAssign(target=target):
                return isinstance(target, ast.Attribute) and _is_elsewhere(target, self._name)
            case ast.Call(func=called):
                name = name_of(called)
                if isinstance(called, ast.Attribute) and name_of(base_of(called.value)) in _MODULES:
                    return name != "put"
                if name in self._functions:
                    return depth > 0 and self._only_reads(self._functions[name][1], depth - 1)
                return name in _READING
            case ast.Delete() | ast.Global() | ast.Nonlocal() | ast.Yield() | ast.YieldFrom() | ast.Await():
                return False
            case ast.With() | ast.Import() | ast.ImportFrom():
                return False
            case ast.FunctionDef() | ast.AsyncFunctionDef() | ast.ClassDef():
                return False
        return True

    def left_before_update(self) -> CodeLine | None:
        """Return the `if` that leaves the loop before the update."""
        call = self.call_line()
        if call is None or not self._writes:
            return None
        for each in self._statements:
            body = [*inner_statements(each.node)] if isinstance(each.node, ast.For | ast.While) else []
            lines = [inner.lineno for inner in body]
            if each.file != call.file or call.line not in lines:
                continue
            later = body[lines.index(call.line) + 1 :]
            writes = {id(write.node) for write in self._writes}
            at = next((place for place, inner in enumerate(later) if id(inner) in writes), None)
            for inner in later[:at] if at is not None else ():
                if isinstance(inner, ast.If) and isinstance(inner.body[-1], ast.Break | ast.Continue):
                    return CodeLine(each.file, inner.lineno)
        return None

    @cached_property
    def sets_a_constant(self) -> bool:
        """True if an update may set a constant."""
        call = self.call_line()
        if call is None:
            return False
        for each in self._statements:
            if is_set_to_constant(each.node, self._aliases):
                if self._in_scope(each, call):
                    if each.line.line > call.line:  # earlier lines make the table
                        return True
                elif any(self._in_scope(write, each.line) for write in self._writes):
                    return True
        return False

    def gives_other(self, reward: str) -> bool:
        """Return True if not only `env.step` may assign `reward`."""
        call = self.step_call
        if call is None or not any(name_of(each) == reward for each in call.unpacked):
            return True
        given = [each for each in self._statements if reward in targets_of(each.node)]
        added = (each.node.target for each in self._statements if isinstance(each.node, ast.AugAssign))
        return len(given) + sum(name_of(each) == reward for each in added) > 1

    def update_line(self) -> CodeLine | None:
        """Return the line that changed the table most, or first writes to it."""
        if self._changed_most is not None:
            return self._changed_most
        return self._writes[0].line if self._writes else None

    def table_line(self) -> CodeLine | None:
        """Return the line that makes the table."""
        for each in self._statements:
            target, value = assigned(each.node)
            if target is None or value is None or name_of(target) != self._name:
                continue
            if isinstance(value, ast.Call):
                return self._made_in(name_of(value.func)) or each.line
            if not isinstance(value, ast.Name | ast.Attribute | ast.Constant):
                return each.line
        return None

    def _made_in(self, function_name: str) -> CodeLine | None:
        if function_name not in self._functions:
            return None
        file, function = self._functions[function_name]
        for returned in of_type(function, ast.Return):
            if not isinstance(returned.value, ast.Name):
                return CodeLine(file, returned.lineno)
            for node in of_type(function, ast.stmt):
                target, value = assigned(node)
                if value is not None and name_of(target) == returned.value.id:
                    return CodeLine(file, node.lineno)
        return None

    @cached_property
    def step_call(self) -> StepCall | None:
        """The call of `env.step` that took the steps."""
        calls = list(self._step_calls())
        at = self._called.get("step")
        seen = [each for each in calls if at == (each.line.file, each.line.line)]
        return next(iter(seen or calls), None)

    def _step_calls(self) -> Iterator[StepCall]:
        for each in self._statements:
            for call in calls_of_step(each.node):
                target, value = assigned(each.node)
                unpacked = target.elts if isinstance(target, ast.Tuple) and value is call else ()
                yield StepCall(
                    CodeLine(each.file, call.lineno),
                    call.func.value if isinstance(call.func, ast.Attribute) else None,
                    call.args[0] if call.args else None,
                    tuple(unpacked),
                )

    def call_line(self) -> CodeLine | None:
        """Return the line of `step_call`."""
        at = self._called.get("step")
        if at is not None:
            return CodeLine(*at)
        return None if self.step_call is None else self.step_call.line

    def choice_line(self) -> CodeLine | None:
        """Return the line that chooses the action, through one function."""
        call = self.step_call
        if call is None or call.argument is None:
            return self._chosen_by_a_method() or self.call_line()
        given = first_name(call.argument)
        candidates = [
            each
            for each in self._statements
            if given and given in targets_of(each.node) and self._in_scope(each, call.line)
        ]
        for each in candidates:
            if chooses(each.node):
                return each.line
        for node in [call.argument, *(each.node for each in candidates)]:
            for inner in of_type(node, ast.Call):
                chosen = self._chosen_in(name_of(inner.func))
                if chosen is not None:
                    return chosen
        return candidates[0].line if candidates else call.line

    def _chosen_by_a_method(self) -> CodeLine | None:
        for name in self._functions:
            if _CHOICE.search(name):
                chosen = self._chosen_in(name)
                if chosen is not None:
                    return chosen
        return None

    def _chosen_in(self, function_name: str) -> CodeLine | None:
        if function_name not in self._functions:
            return None
        file, function = self._functions[function_name]
        returned = None
        for node in of_type(function, ast.stmt):
            if is_simple(node) and chooses(node):
                return CodeLine(file, node.lineno)
            if isinstance(node, ast.Return) and returned is None:
                returned = CodeLine(file, node.lineno)
        return returned

    def _in_scope(self, statement: _Statement, line: CodeLine) -> bool:
        return self.scope_of(statement.line) is self.scope_of(line)

    def scope_of(self, line: CodeLine) -> ast.AST | None:
        """Return the innermost function around `line`, or its file."""
        if line not in self._scopes:
            self._scopes[line] = self._found_scope(line)
        return self._scopes[line]

    def _found_scope(self, line: CodeLine) -> ast.AST | None:
        tree = self._trees.get(line.file)
        if tree is None:
            return None
        holding: ast.AST = tree
        for node in ast.walk(tree):  # outer ones come first
            if isinstance(node, _Function) and node.lineno <= line.line <= (node.end_lineno or 0):
                holding = node
        return holding
