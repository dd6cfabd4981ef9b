"""Classes of the program's own with reset and step, whose steps are reported."""

from __future__ import annotations

import builtins
import sys
import time
import weakref
from collections.abc import Callable
from functools import wraps
from types import FunctionType
from typing import Any, Final

import gymnasium
import numpy as np

from rl_tui.programs.watched.child.environments.direct_envs import Given
from rl_tui.programs.watched.child.environments.making import Making
from rl_tui.programs.watched.child.environments.numbering import Numbering
from rl_tui.programs.watched.child.errors import is_users_file
from rl_tui.programs.watched.child.recorder import Recorder
from rl_tui.programs.watched.child.tables.search import attributes
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
"""Names of methods that take a step."""
_RESET: Final = (
    "reset",
    "reset_game",
    "reset_env",
    "restart",
    "start",
    "new_game",
    "new_episode",
    "start_episode",
)
_UNKNOWN: Final = object()
_NO_SLEEP: Final = "time.sleep() returns at once: the speed is set on screen"


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


class _World:
    """One world: the last observation, and its place in the episode."""

    def __init__(self, it: object) -> None:
        self.it = weakref.ref(it)
        self.observation: Any = _UNKNOWN
        self.was_reset = self.is_inside = False
        self.episode = self.place = 0


class FunctionWorld:
    """A function that takes a step from the state it is given."""

    def __init__(self, function: FunctionType) -> None:
        self.kind = _Kind(FunctionType)
        self.kind.name = function.__name__
        self.world = _World(function)
        self.next_state: Key | None = None
        """State in which the last step of an unfinished episode ended."""


class OwnWorlds:
    """Watches the worlds of a program's own classes. `note` receives messages."""

    def __init__(self, recorder: Recorder, making: Making, note: Callable[[str], None]) -> None:
        self._recorder, self._making, self._note = recorder, making, note
        self._kinds: dict[type, _Kind] = {}
        self._worlds: dict[int, _World] = {}
        self._functions: set[_Kind] = set()
        self._held = 0
        self._are_ends_told = self._is_awake = False

    def install(self) -> None:
        """Watch the classes that the program's own files define from now on."""
        build = builtins.__build_class__

        def building(function: Any, name: str, *bases: Any, **more: Any) -> Any:
            made = build(function, name, *bases, **more)
            is_users = type(function) is FunctionType and is_users_file(function.__code__.co_filename)
            if is_users and isinstance(made, type) and not issubclass(made, gymnasium.Env):
                self._watch(made)
            return made

        builtins.__build_class__ = building  # type: ignore[assignment]
        self._making.direct.without_spaces = self

    def step(self, it: Any, frame: Any, take: Callable[..., Any], given: Given) -> Any:
        """Take a step of the world `it` for the program at `frame`."""
        arguments, more = given
        kind, world = self._known(it)
        is_silent = world is None or world.is_inside or self._making.is_inside
        if is_silent or kind.is_over or len(arguments) + len(more) != 1:
            return take(it, *arguments, **more)
        assert world is not None
        (action,) = (*arguments, *more.values())
        if world.observation is not _UNKNOWN:
            self._number(kind, world, action, frame)
            if kind.numbering is not None:
                self._recorder.before(frame, kind.numbering, "step")
        count = self._seen
        result = self._call(world, it, take, given)
        if self._seen != count:  # a world inside of this one has reported
            kind.is_over = True
            return result
        self._report(kind, world, action, step_of(result))
        return result

    def reset(self, it: Any, frame: Any, begin: Callable[..., Any], given: Given) -> Any:
        """Begin an episode of the world `it` for the program at `frame`."""
        kind, world = self._known(it)
        if world is None or world.is_inside or self._making.is_inside or kind.is_over:
            return begin(it, *given[0], **given[1])
        if kind.numbering is not None:
            self._recorder.before(frame, kind.numbering, "reset")
        resets = self._recorder.resets
        result = self._call(world, it, begin, given)
        if self._recorder.resets != resets:  # a world inside of this one reports
            kind.is_over = True
            return result
        self._recorder.resets += 1
        is_with_info = type(result) is tuple and len(result) == 2 and type(result[1]) is dict
        observation = result[0] if is_with_info else result
        world.observation = _UNKNOWN if observation is None else _copied(observation)
        world.was_reset, world.place = True, 0
        return result

    def may_report(self, world: FunctionWorld) -> bool:
        """Return True if the next call of a function may be a step of the program."""
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

        Args:
            function: The function.
            key: Key of the state that it is given. Another one than the last next state begins an episode.
            given: State and action.
            frame: Frame of the caller.
            take: Calls the function.
            read: Returns the step that its result describes, or None.
        """
        kind, world = function.kind, function.world
        self._functions.add(kind)
        state, action = given
        world.observation = _copied(state)
        if key != function.next_state:
            world.place = 0
        self._number(kind, world, action, frame)
        if kind.numbering is not None:
            self._recorder.before(frame, kind.numbering, "step")
        count = self._seen
        result = self._call(world, None, lambda _: take(), ((), {}))
        step = read(result)
        if self._seen != count or step is None:  # another world has reported, or this is not a step
            self._drop(kind)
            return result
        self._report(kind, world, action, step)
        function.next_state = None if step.flags or kind.is_over else key_of(step.observation)
        return result

    def finish(self) -> None:
        """Report the first steps of a program that ended before they were numbered."""
        for kind in (*self._kinds.values(), *self._functions):
            if kind.held and not kind.is_over:
                self._number_by_meeting(kind, None)

    @property
    def _seen(self) -> int:
        return self._recorder.count + self._held

    def _known(self, it: Any) -> tuple[_Kind, _World | None]:
        cls = type(it)
        kind = self._kinds.get(cls)
        if kind is None:
            kind = self._kinds[cls] = _Kind(cls)
        world = self._worlds.get(id(it))
        if world is None or world.it() is not it:
            try:
                world = self._worlds[id(it)] = _World(it)
            except TypeError:  # no weak reference to it is possible
                return kind, None
        return kind, world

    @staticmethod
    def _call(world: _World, it: Any, method: Callable[..., Any], given: Given) -> Any:
        world.is_inside = True
        try:
            return method(it, *given[0], **given[1])
        finally:
            world.is_inside = False

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
        """Give numbers to states and actions, if the table shows them, or after enough steps."""
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
        self._begin(kind, MetNumbering(observations, max(actions, taken)))

    def _begin(self, kind: _Kind, numbering: Numbering) -> None:
        """Report the world, and the steps held until now."""
        kind.numbering = numbering
        kind.number = self._making.announce_own(kind.name, numbering)
        held, kind.held = kind.held, []
        self._held -= len(held)
        for world, each in held:
            self._emit(kind, world, each)
        if isinstance(numbering, MetNumbering):
            self._making.tell_names(kind.number, numbering)

    def _stay_awake(self) -> None:
        """Let the program's pauses between steps return at once."""
        self._is_awake, sleep = True, time.sleep

        def no_sleep(seconds: float) -> None:
            if is_users_file(sys._getframe(1).f_code.co_filename):
                self._note(_NO_SLEEP)
            else:
                sleep(seconds)

        time.sleep = no_sleep  # type: ignore[assignment]

    def _drop(self, kind: _Kind) -> None:
        """Report no further step of `kind`."""
        kind.is_over = True
        self._held -= len(kind.held)
        kind.held = []

    def _give_up(self, kind: _Kind, why: str) -> None:
        self._drop(kind)
        more = "" if kind.numbering is None else " any more"
        self._note(f"{kind.name} is not watched{more}: {why}")

    def _watch(self, cls: type) -> None:
        """Put hooks around the methods of `cls` that look like reset and step."""
        worlds, own = self, vars(cls)
        for name in _STEP:
            if type(own.get(name)) is FunctionType and _takes_an_action(own[name]):
                setattr(cls, name, _hooked(own[name], worlds.step))
                break
        for name in _RESET:
            if type(own.get(name)) is FunctionType:
                setattr(cls, name, _hooked(own[name], worlds.reset))


def _hooked(original: Any, report: Callable[..., Any]) -> Any:
    @wraps(original)
    def method(it: Any, *arguments: Any, **more: Any) -> Any:
        return report(it, sys._getframe(1), original, (arguments, more))

    return method


def _takes_an_action(function: FunctionType) -> bool:
    """Return True if a method must be given exactly one argument."""
    code, optional = function.__code__, len(function.__defaults__ or ())
    required = code.co_argcount - 1 - optional
    has_required_names = code.co_kwonlyargcount > len(function.__kwdefaults__ or ())
    return not has_required_names and (required == 1 or (required == 0 and optional > 0))


def _copied(observation: Any) -> Any:
    """Return an observation, as a copy if it may change."""
    return observation.copy() if type(observation) in (list, np.ndarray) else observation
