"""The program's own classes with reset and step."""

from __future__ import annotations

import ast
import builtins
import inspect
import linecache
import sys
import time
import tokenize
import weakref
from collections.abc import Callable
from functools import wraps
from types import FunctionType
from typing import Any, Final

import gymnasium
import numpy as np

from rl_tui.programs.watched.child.boxes.sites import ACTION_NAME
from rl_tui.programs.watched.child.environments.direct_envs import Given
from rl_tui.programs.watched.child.environments.making import Making
from rl_tui.programs.watched.child.environments.numbering import Numbering
from rl_tui.programs.watched.child.environments.watched_env import is_with_information
from rl_tui.programs.watched.child.errors import is_users_file
from rl_tui.programs.watched.child.tables.search import attributes, candidates
from rl_tui.programs.watched.child.worlds.first_steps import (
    FEW_STEPS,
    HeldStep,
    OwnStep,
    TableSearch,
    number_of_actions,
    step_of,
)
from rl_tui.programs.watched.child.worlds.met import Key, MetNumbering, UnfitError, key_of, state_key
from rl_tui.programs.watched.messages import MessageKind

_STEP: Final = (
    *("step", "act", "move", "make_step", "take_action", "perform_action", "do_action", "take_step"),
    *("make_action", "execute"),
)
_RESET: Final = (
    *("reset", "reset_game", "reset_env", "restart", "start", "new_game", "new_episode", "start_episode"),
)
_VALUES: Final = range(3, 6)
_UNKNOWN: Final = object()
_NO_SLEEP: Final = "time.sleep() returns at once: you set the speed on screen"


class _Kind:
    """The worlds of one class, which have one number. Their first steps are held until a table is found."""

    def __init__(self, cls: type) -> None:
        self.name = cls.__name__
        self.numbering: Numbering | None = None
        self.number = 0
        self.actions = number_of_actions(cls, {})
        self.held: list[tuple[_World, HeldStep]] = []
        self.search = TableSearch()
        self.is_over = False
        """True if no further step is reported."""
        self.is_guess = False
        """True if its method only looks like a step."""


class _World:
    def __init__(self, it: object) -> None:
        self.it = weakref.ref(it)
        self.observation: Any = _UNKNOWN
        self.was_reset = self.is_inside = False
        self.episode = self.place = 0


class FunctionWorld:
    """A function that takes a step from a given state."""

    def __init__(self, function: FunctionType) -> None:
        self.kind = _Kind(FunctionType)
        self.kind.name = function.__name__
        self.world = _World(function)
        self.next_state: Key | None = None
        """State in which the last step of an unfinished episode ended."""


class OwnWorlds:
    """Watches the worlds of a program's own classes."""

    def __init__(self, making: Making) -> None:
        self._making, self._recorder, self._note = making, making.recorder, making.note
        self._kinds: dict[type, _Kind] = {}
        self._worlds: dict[int, _World] = {}
        self._functions: set[_Kind] = set()
        self._guessed: set[type] = set()
        self._held = 0
        self._are_ends_told = self._is_awake = False
        self.may_take_over: Callable[[Any], bool] = lambda _: False
        """Lets the assignments to a table at a frame report instead, if they can."""

    def install(self) -> None:
        """Watch classes of the program's own files."""
        build = builtins.__build_class__

        def building(function: Any, name: str, *bases: Any, **more: Any) -> Any:
            made = build(function, name, *bases, **more)
            is_users = type(function) is FunctionType and is_users_file(function.__code__.co_filename)
            if is_users and isinstance(made, type) and not issubclass(made, gymnasium.Env):
                self._watch(made)
            return made

        builtins.__build_class__ = building  # type: ignore[assignment]
        self._making.direct.without_spaces = {"step": self.step, "reset": self.reset}

    def step(self, it: Any, frame: Any, take: Callable[..., Any], given: Given) -> Any:
        """Take a step of `it` for `frame`."""
        arguments, more = given
        kind, world = self._known(it)
        is_silent = world is None or world.is_inside or self._making.is_inside
        if is_silent or kind.is_over or len(arguments) + len(more) != 1:
            return take(it, *arguments, **more)
        assert world is not None
        (action,) = (*arguments, *more.values())
        result, is_of_another = self._taken(kind, world, action, frame, lambda: take(it, *arguments, **more))
        if is_of_another:
            kind.is_over = True
        else:
            self._report(kind, world, action, step_of(result))
        return result

    def reset(self, it: Any, frame: Any, begin: Callable[..., Any], given: Given) -> Any:
        """Begin an episode of `it` for `frame`."""
        kind, world = self._known(it)
        if world is None or world.is_inside or self._making.is_inside or kind.is_over:
            return begin(it, *given[0], **given[1])
        if kind.numbering is not None:
            self._recorder.before(frame, kind.numbering, "reset")
        resets = self._recorder.resets
        result = self._call(world, lambda: begin(it, *given[0], **given[1]))
        if self._recorder.resets != resets:  # a world inside of this one reports
            kind.is_over = True
            return result
        self._recorder.resets += 1
        observation = result[0] if is_with_information(result) else result
        world.observation = _UNKNOWN if observation is None else _copied(observation)
        world.was_reset, world.place = True, 0
        return result

    def may_report(self, world: FunctionWorld) -> bool:
        """Return True if the next call may be a step."""
        return not (world.kind.is_over or world.world.is_inside or self._making.is_inside)

    def step_from(
        self,
        function: FunctionWorld,
        key: Key,
        given: tuple[Any, Any],
        frame: Any,
        take: Callable[[], Any],
        read: Callable[[Any], OwnStep | None],
    ) -> Any:
        """Take a step with a function.

        `key` of another state than the last next one begins an episode. `given` has state and action, `take`
        calls the function, and `read` returns the step in its result, or None.
        """
        kind, world = function.kind, function.world
        self._functions.add(kind)
        state, action = given
        world.observation = _copied(state)
        if key != function.next_state:
            world.place = 0
        result, is_of_another = self._taken(kind, world, action, frame, take)
        step = read(result)
        if is_of_another or step is None:
            self._drop(kind)
            return result
        self._report(kind, world, action, step)
        function.next_state = None if step.flags or kind.is_over else key_of(step.observation)
        return result

    def finish(self) -> None:
        """Report first steps that were never numbered."""
        for kind in (*self._kinds.values(), *self._functions):
            if kind.held and not kind.is_over:
                self._number_by_meeting(kind, None)

    def has_steps(self) -> bool:
        """Return True if steps are held."""
        return self._held > 0

    def _known(self, it: Any) -> tuple[_Kind, _World | None]:
        cls = type(it)
        kind = self._kinds.get(cls)
        if kind is None:
            kind = self._kinds[cls] = _Kind(cls)
            kind.is_guess = any(each in self._guessed for each in cls.__mro__)
        world = self._worlds.get(id(it))
        if world is None or world.it() is not it:
            try:
                world = self._worlds[id(it)] = _World(it)
            except TypeError:  # no weak reference to it is possible
                return kind, None
        return kind, world

    @staticmethod
    def _call(world: _World, method: Callable[[], Any]) -> Any:
        world.is_inside = True
        try:
            return method()
        finally:
            world.is_inside = False

    def _taken(
        self, kind: _Kind, world: _World, action: Any, frame: Any, take: Callable[[], Any]
    ) -> tuple[Any, bool]:
        """Return the result of a step, and True if a world inside of this one has reported it."""
        if world.observation is not _UNKNOWN:
            self._number(kind, world, action, frame)
            if kind.numbering is not None:
                self._recorder.before(frame, kind.numbering, "step")
        count = self._recorder.count + self._held
        result = self._call(world, take)
        return result, self._recorder.count + self._held != count

    def _report(self, kind: _Kind, world: _World, action: Any, step: OwnStep | None) -> None:
        before = world.observation
        if step is None:
            world.observation = _UNKNOWN
            return
        if before is _UNKNOWN:  # a copy, or a world without a first state
            if world.was_reset:
                self._give_up(kind, "its reset() returns no state")
            return
        world.observation = _copied(step.observation)
        if not self._is_awake:
            self._stay_awake()
        if not (step.is_of_gymnasium or self._are_ends_told):
            self._are_ends_told = True
            self._recorder.channel.message(MessageKind.OWN_ENDS)
        held = HeldStep(before, action, step, world.place)
        world.place += 1
        if kind.numbering is not None:
            self._emit(kind, world, held)
            return
        try:
            state_key(step.observation)
            key_of(action)
        except UnfitError as why:
            self._give_up(kind, str(why))
            return
        kind.held.append((world, held))
        self._held += 1

    def _emit(self, kind: _Kind, world: _World, held: HeldStep) -> None:
        numbering, step = kind.numbering, held.step
        assert numbering is not None
        try:
            if isinstance(numbering, MetNumbering):
                state, next_state = numbering.state(held.before), numbering.state(step.observation)
                action = numbering.action(held.action)
            else:
                state, next_state = (
                    numbering.state(key_of(held.before)),
                    numbering.state(key_of(step.observation)),
                )
                action = numbering.action(key_of(held.action))
        except UnfitError as why:
            self._give_up(kind, str(why))
            return
        except (TypeError, ValueError):
            self._give_up(kind, "a state or an action is outside of its table")
            return
        if held.place == 0:
            world.episode = self._recorder.begin_episode()
        told = (kind.number, state, action, step.reward, next_state, step.flags, world.episode, held.place)
        self._recorder.after(told, numbering)

    def _number(self, kind: _Kind, world: _World, action: Any, frame: Any) -> None:
        if kind.numbering is not None or kind.is_over:
            return
        if kind.actions is None:
            it = world.it()
            kind.actions = number_of_actions(type(it), attributes(it))
        last = kind.held[-1][1] if kind.held else None
        try:
            found = kind.search.array(frame, world.observation, action, kind.actions, last)
        except UnfitError as why:
            self._give_up(kind, str(why))
            return
        if found is not None:
            self._begin(kind, found)
        elif len(kind.held) >= FEW_STEPS:
            self._number_by_meeting(kind, frame)

    def _number_by_meeting(self, kind: _Kind, frame: Any) -> None:
        steps = [held for _, held in kind.held]
        observations = [each for held in steps for each in (held.before, held.step.observation)]
        taken = len({key_of(held.action) for held in steps})
        actions = kind.search.width(frame, observations) or kind.actions or max(2, taken)
        numbering = MetNumbering(observations, max(actions, taken))
        for held in steps:
            numbering.action(held.action)
        if not candidates(frame, numbering, None) and self.may_take_over(frame):
            self._drop(kind)
        else:
            self._begin(kind, numbering)

    def _begin(self, kind: _Kind, numbering: Numbering) -> None:
        kind.numbering = numbering
        kind.number = self._making.announce_own(kind.name, numbering)
        held, kind.held = kind.held, []
        self._held -= len(held)
        for world, each in held:
            self._emit(kind, world, each)
        if isinstance(numbering, MetNumbering):
            self._making.tell_names(kind.number, numbering)

    def _stay_awake(self) -> None:
        self._is_awake, sleep = True, time.sleep

        def no_sleep(seconds: float) -> None:
            if is_users_file(sys._getframe(1).f_code.co_filename):
                self._note(_NO_SLEEP)
            else:
                sleep(seconds)

        time.sleep = no_sleep  # type: ignore[assignment]

    def _drop(self, kind: _Kind) -> None:
        kind.is_over = True
        self._held -= len(kind.held)
        kind.held = []

    def _give_up(self, kind: _Kind, why: str) -> None:
        self._drop(kind)
        if kind.is_guess and kind.numbering is None:
            return
        more = "not watched" if kind.numbering is None else "no longer watched"
        self._note(f"{kind.name} is {more}: {why}")

    def _watch(self, cls: type) -> None:
        own = {name: each for name, each in vars(cls).items() if type(each) is FunctionType}
        resets = [name for name in _RESET if name in own]
        able = [name for name in own if _takes_an_action(own[name])]
        steps: list[str] = [name for name in _STEP if name in able]
        if resets and not steps:
            steps = [name for name in able if _looks_like_a_step(own[name])]
            steps = steps if len(steps) == 1 else []
            self._guessed.update([cls] * len(steps))
        for name in steps[:1]:
            setattr(cls, name, _hooked(own[name], self.step))
        for begin in resets:
            setattr(cls, begin, _hooked(own[begin], self.reset))


def _hooked(original: Any, report: Callable[..., Any]) -> Any:
    @wraps(original)
    def method(it: Any, *arguments: Any, **more: Any) -> Any:
        return report(it, sys._getframe(1), original, (arguments, more))

    return method


def _takes_an_action(function: FunctionType) -> bool:
    code, optional = function.__code__, len(function.__defaults__ or ())
    required = code.co_argcount - 1 - optional
    has_required_names = code.co_kwonlyargcount > len(function.__kwdefaults__ or ())
    return not has_required_names and (required == 1 or (required == 0 and optional > 0))


def _looks_like_a_step(function: FunctionType) -> bool:
    """Return True if a method has an action by its name, returns 3 to 5 values and changes the object."""
    code = function.__code__
    if code.co_argcount < 2 or not ACTION_NAME.search(code.co_varnames[1]):
        return False
    lines = linecache.getlines(code.co_filename)[code.co_firstlineno - 1 :]
    head = "if True:\n" if lines and lines[0][0].isspace() else ""
    try:  # the lines may be those of another source, which was compiled with this file's name
        nodes = list(ast.walk(ast.parse("".join((head, *inspect.getblock(lines))))))
    except (SyntaxError, tokenize.TokenError, ValueError, RecursionError, MemoryError):
        return False
    returned = [each.value for each in nodes if isinstance(each, ast.Return)]
    changed = [each for each in nodes if isinstance(getattr(each, "ctx", None), ast.Store)]
    returns = any(isinstance(each, ast.Tuple) and len(each.elts) in _VALUES for each in returned)
    return returns and any(_is_part_of(each, code.co_varnames[0]) for each in changed)


def _is_part_of(target: ast.AST, name: str) -> bool:
    inner = target
    while isinstance(inner, ast.Attribute | ast.Subscript):
        inner = inner.value
    return inner is not target and isinstance(inner, ast.Name) and inner.id == name


def _copied(observation: Any) -> Any:
    return observation.copy() if type(observation) in (list, np.ndarray) else observation
