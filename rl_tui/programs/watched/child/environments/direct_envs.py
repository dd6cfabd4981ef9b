"""Environments made from their class, or taken out of their wrappers."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from typing import Any, Final

import gymnasium
from gymnasium.utils import seeding

from rl_tui.programs.watched.child.environments.watched_env import Elsewhere, StepReports, made_elsewhere

Announce = Callable[[gymnasium.Env[Any, Any]], StepReports | None]
_KEY: Final = "_rl_tui_reports"
_IS_INNER: Final = "_rl_tui_is_inner"
_KEYS: Final = (_KEY, _IS_INNER)
Given = tuple[tuple[Any, ...], dict[str, Any]]
Answer = Callable[[Any, str, Any], Any]
"""Returns the result of a method for the frame that called it."""


def _as_it_is(frame: Any, method: str, result: Any) -> Any:
    del frame, method
    return result


class DirectEnvs:
    """Lets environments report their own steps, by another class with the same name."""

    def __init__(
        self,
        announce: Announce,
        announce_again: Callable[[gymnasium.Env[Any, Any], StepReports], None],
    ) -> None:
        self._announce, self._announce_again = announce, announce_again
        self.answer: Answer = _as_it_is
        self.without_spaces: Mapping[str, Callable[[Any, Any, Callable[..., Any], Given], Any]] = {}
        """Methods that watch environments without finite spaces, by "step" and "reset"."""
        self.more_methods: Mapping[str, Any] = {}
        self._classes: dict[type, type] = {}

    def install(self, seed: int) -> None:
        """Watch each environment. Their generators start from `seed`."""
        made, count = gymnasium.Env.__new__, 0
        original = seeding.np_random

        def new(cls: type, *_: Any, **__: Any) -> Any:
            is_ours = Elsewhere.is_now or issubclass(cls, gymnasium.Wrapper) or _KEY in cls.__dict__
            return made(cls if is_ours else self._class_of(cls))

        def np_random(given: int | None = None) -> Any:
            nonlocal count
            count += given is None
            return original(seed + count if given is None else given)

        gymnasium.Env.__new__ = new
        seeding.np_random = np_random

    def hand_out(self, env: gymnasium.Env[Any, Any], reports: StepReports | None) -> None:
        """Let `env` report through `reports`, unless a wrapper does."""
        if _KEY not in env.__dict__:
            env.__class__ = self._class_of(type(env))
            env.__dict__[_KEY] = reports
            if reports is not None:
                reports.bare = env
                env.__dict__[_IS_INNER] = True

    def call(self, method: str, env: Any, frame: Any, original: Callable[..., Any], given: Given) -> Any:
        """Call `method` of `env` for `frame`, "step" or "reset"."""
        arguments, more = given
        reports = self._reports_of(env)
        if reports is None and method in self.without_spaces and _KEY in env.__dict__:
            return self.without_spaces[method](env, frame, original, given)
        has_action = method == "step" and len(arguments) + len(more) == 1
        if reports is None or reports.is_inside or reports.is_silent or not (has_action or method == "reset"):
            return original(env, *arguments, **more)
        if method == "reset":
            return reports.reset(frame, lambda: original(env, *arguments, **more))
        (action,) = (*arguments, *more.values())
        return reports.step(frame, lambda _: original(env, *arguments, **more), action)

    def _reports_of(self, env: Any) -> StepReports | None:
        inside = env.__dict__
        if _KEY not in inside:
            try:
                reports = self._announce(env)
            except AttributeError:  # its spaces are not known before the end of its __init__
                return None
            if reports is not None:
                reports.bare = env
            inside[_KEY] = reports
        elif _IS_INNER in inside and not inside[_KEY].is_inside:
            del inside[_IS_INNER]
            if not inside[_KEY].is_used:
                self._announce_again(env, inside[_KEY])
        found: StepReports | None = inside[_KEY]
        return found

    def _class_of(self, cls: Any) -> type:
        if cls not in self._classes:
            self._classes[cls] = self._watched_class(cls)
        return self._classes[cls]

    def _watched_class(self, cls: Any) -> type:
        def watched(method: str) -> Callable[..., Any]:
            def call(env: Any, *arguments: Any, **more: Any) -> Any:
                frame = sys._getframe(1)
                result = self.call(method, env, frame, getattr(cls, method), (arguments, more))
                return self.answer(frame, method, result)

            call.__name__ = method
            return call

        def reduce(env: Any, protocol: Any) -> Any:
            kind, env.__class__ = env.__class__, cls
            try:
                made, arguments, *rest = env.__reduce_ex__(protocol)
            finally:
                env.__class__ = kind
            if rest and isinstance(rest[0], dict):
                rest[0] = {name: each for name, each in rest[0].items() if name not in _KEYS}
            return _copied, (made, *arguments), *rest

        methods = {"step": watched("step"), "reset": watched("reset"), "__reduce_ex__": reduce, _KEY: True}
        if cls.__module__.startswith("gymnasium."):
            methods |= self.more_methods
        names = {name: getattr(cls, name) for name in ("__module__", "__qualname__", "__doc__")}
        made: type = type(cls)(cls.__name__, (cls,), {**names, **methods})
        return made


def _copied(made: Callable[..., Any], *arguments: Any) -> Any:
    """Return an unwatched copy, because trying it out is not a step of the program."""
    with made_elsewhere():
        return made(*arguments)
