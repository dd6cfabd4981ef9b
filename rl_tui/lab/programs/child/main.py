"""A first version of the watched side: runs a script unchanged and streams what it does."""

from __future__ import annotations

import json
import mmap
import os
import random
import re
import sys
import types
from array import array
from pathlib import Path
from time import monotonic
from typing import Any

import gymnasium as gym
import numpy as np

from rl_tui.lab.programs.child.agent import run_agent
from rl_tui.lab.programs.child.faults import described
from rl_tui.lab.programs.child.script import run_script
from rl_tui.lab.programs.child.source import read_script
from rl_tui.lab.programs.child.surroundings import bound_memory, end_with, surround
from rl_tui.lab.programs.messages import HEADER, MESSAGE, STEPS, TABLE, Kind

SKIP = re.compile(
    r"^(n|N|counts?|visits?|returns?|policy|pi|e|E|traces?|P|R|model|rewards?)$|count|visit|trace|policy|model"
)
GOOD = re.compile(r"q|values?|table", re.I)
OWN = (types.ModuleType, type, types.FunctionType, np.ndarray, str, int, float, list, dict, tuple)


class Stop(BaseException):
    pass


def dims(space: Any) -> tuple[int, ...] | None:
    if isinstance(space, gym.spaces.Discrete):
        return (int(space.n),)
    if isinstance(space, gym.spaces.Tuple) and all(isinstance(x, gym.spaces.Discrete) for x in space):
        return tuple(int(x.n) for x in space)
    return None


def form_of(v: Any, S: tuple[int, ...], A: int) -> str | None:
    if isinstance(v, np.ndarray):
        return "array" if v.shape == (*S, A) and v.dtype.kind in "fiu" else None
    if isinstance(v, dict) and v:
        k, x = next(iter(v.items()))
        if isinstance(x, (np.ndarray, list)) and np.shape(x) == (A,):
            return "dict-of-arrays"
        if isinstance(k, tuple) and len(k) == 2 and isinstance(x, (int, float)) and k[1] in range(A):
            return "dict-of-pairs"
    if isinstance(v, list) and len(S) == 1 and len(v) == S[0] and v and np.shape(v[0]) == (A,):
        return "lists"
    return None


class Recorder:
    def __init__(self, said: dict[str, Any]) -> None:
        self.pipe = os.fdopen(said["told"], "wb")
        self.asked = said["asked"]
        self.limit = memoryview(mmap.mmap(said["shared"], mmap.PAGESIZE)).cast("q")
        self.most, self.want = said["steps"], said["table"]
        self.n, self.steps, self.changes, self.last = 0, [], [], 0.0
        self.where: Any = None
        self.values: Any = None
        self.episode = -1
        self.pending = False

    def message(self, kind: str, **more: Any) -> None:
        self.flush()
        self.write(MESSAGE, json.dumps({"kind": kind, **more}).encode())

    def write(self, letter: bytes, payload: bytes) -> None:
        self.pipe.write(HEADER.pack(letter, len(payload)) + payload)
        self.pipe.flush()

    def flush(self) -> None:
        if self.steps or self.changes:
            payload = array("d", [len(self.steps) // 8, *self.steps, *self.changes]).tobytes()
            self.steps, self.changes = [], []
            self.write(STEPS, payload)
        self.last = monotonic()

    def read(self) -> Any:
        holder, key, _, form = self.where
        try:
            if isinstance(holder, types.FrameType):
                t = holder.f_locals[key]
            else:
                t = holder[key] if isinstance(holder, dict) else getattr(holder, key)
        except (KeyError, AttributeError):
            t = self.object
        self.object = t
        out = np.full(self.S * self.A, np.nan)
        if form in ("array", "lists"):
            out[:] = np.asarray(t, float).ravel()
        elif form == "dict-of-arrays":
            for s, row in t.items():
                k = self.key(s)
                out[k * self.A : (k + 1) * self.A] = row
        else:
            for (s, a), x in t.items():
                out[self.key(s) * self.A + a] = x
        return out

    def key(self, s: Any) -> int:
        return (
            int(np.ravel_multi_index(tuple(int(x) for x in s), self.parts))
            if isinstance(s, tuple)
            else int(s)
        )

    def find(self, f: Any, w: Any) -> Any:
        hits, done = [], set()
        while f:
            for sc, holder in ((f.f_locals, f), (f.f_globals, f.f_globals)):
                if id(sc) in done:
                    continue
                done.add(id(sc))
                for name, v in list(sc.items()):
                    form = form_of(v, w.dims, w.A)
                    if form and not name.startswith("_"):
                        hits.append((holder, name, name, form))
                    elif not isinstance(v, (*OWN, gym.Env)) and hasattr(v, "__dict__"):
                        for a, x in list(vars(v).items()):
                            form = form_of(x, w.dims, w.A)
                            if form:
                                hits.append((v, a, f"{name}.{a}", form))
            f = f.f_back
        hits = [h for h in hits if (self.want in h[1:3] if self.want else not SKIP.search(h[1]))]
        hits.sort(key=lambda h: -bool(re.match(r"q", h[1], re.I)) * 2 - bool(GOOD.search(h[1])))
        return hits

    def before(self, w: Any, f: Any) -> None:
        if self.where is None:
            hits = self.find(f, w)
            if hits:
                self.where, self.S, self.A, self.parts = hits[0], int(np.prod(w.dims)), w.A, w.dims
                self.values = self.read()
                t = self.object
                self.message(
                    Kind.TABLE,
                    step=self.n,
                    name=self.where[2],
                    form=self.where[3],
                    shape=list(np.shape(t)) or [len(t)],
                    dtype=str(getattr(t, "dtype", "")),
                    others=[h[2] for h in hits[1:]],
                    shared=False,
                )
                self.write(TABLE, self.values.tobytes())
        else:
            now = self.read()
            for c in np.flatnonzero((now != self.values) & ~(np.isnan(now) & np.isnan(self.values))):
                self.changes += [max(0, self.n - 1), int(c), self.values[c], now[c]]
            self.values = now
        if monotonic() - self.last > 1 / 30:
            self.flush()
        if self.n >= self.limit[0]:
            self.message(Kind.WAITING, step=self.n, stopped=None)
            while self.n >= self.limit[0]:
                if not os.read(self.asked, 65536):
                    os._exit(0)


R: Recorder


class Watch(gym.Wrapper):
    def __init__(self, env: Any, number: int) -> None:
        super().__init__(env)
        self.number, self.dims, self.A = number, dims(env.observation_space), int(env.action_space.n)

    def step(self, action: Any) -> Any:
        R.before(self, sys._getframe(1))
        result = self.env.step(action)
        s2, r, te, tr, _ = result
        k = R.__dict__.setdefault("parts", self.dims) and R.key(s2)
        R.steps += [self.number, self.s, int(action), float(r), k, te + 2 * tr, R.episode, self.place]
        self.place += 1
        self.s = k
        R.n += 1
        if R.most and R.n >= R.most:
            raise Stop
        return result

    def reset(self, *, seed: Any = None, options: Any = None) -> Any:
        R.before(self, sys._getframe(1))
        result = self.env.reset(seed=seed, options=options)
        R.__dict__.setdefault("parts", self.dims)
        self.s = R.key(result[0])
        R.episode += 1
        self.place = 0
        return result


def main(said: dict[str, Any]) -> None:
    global R
    R = Recorder(said)

    def note(text: str) -> None:
        R.message(Kind.NOTE, text=text)

    end_with(said["life"])
    if said["memory"] is not None:
        bound_memory(said["memory"])
    surround(note)
    make, count = gym.make, [0]

    def patched(*a: Any, **k: Any) -> Any:
        env = make(*a, **k)
        if dims(env.observation_space):
            env = Watch(env, count[0])
            env.reset(seed=said["seed"])
            R.message(
                Kind.ENVIRONMENT,
                number=count[0],
                id=env.spec.id,
                kwargs={key: v for key, v in env.spec.kwargs.items() if v is not None},
                states=list(env.dims),
                first_state=[0] * len(env.dims),
                actions=env.A,
                first_action=0,
                time_limit=env.spec.max_episode_steps or 0,
                wrappers=[],
            )
            count[0] += 1
        return env

    gym.make = patched
    random.seed(said["seed"])
    np.random.seed(said["seed"])
    path = Path(said["path"])
    try:
        if said["agent"] is None:
            run_script(read_script(path), path, said["arguments"], note)
        else:
            run_agent(said)
        if R.where is not None:
            now = R.read()
            for c in np.flatnonzero(now != R.values):
                R.changes += [R.n - 1, int(c), R.values[c], now[c]]
    except Stop:
        pass
    except BaseException as e:
        R.message(Kind.ERROR, **described(e))
    R.message(Kind.END, step=R.n)
