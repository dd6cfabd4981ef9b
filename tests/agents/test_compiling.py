"""The sources of machine code."""

from __future__ import annotations

import io
import json
import threading
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import pytest

from rl_tui.agents.compiling import background, cache_folder, loops, worker
from rl_tui.agents.compiling import loops as compiler_lock
from rl_tui.agents.compiling.background import GONE, BackgroundCompiler
from rl_tui.agents.compiling.loops import CodeOrigin, CompilerLock, all_loops, compile_here
from rl_tui.agents.kernels.machine_code import SHARED, Loop

LOOP = Loop("q-learning", "epsilon-greedy", stepped=False)
OTHER = Loop("sarsa", "softmax", stepped=False)
LONGEST = 60.0


class Machine:
    def __init__(self) -> None:
        self.compiled = set[Loop]()
        self.noted = set[Loop]()
        self.cached = set[Loop]()
        self.done: list[tuple[str, Loop]] = []
        self.takes_code = True
        self.workers: list[Worker] = []
        self.start_worker: Callable[[], Worker] = self.new_worker
        self.script: Callable[[Machine, Loop], str | None] = keeps

    def new_worker(self) -> Worker:
        self.workers.append(Worker(self))
        return self.workers[-1]

    def was_compiled(self, loop: Loop) -> bool:
        return loop in self.noted

    def load(self, loop: Loop) -> bool:
        self.done.append(("load", loop))
        self.compiled |= {loop} & self.cached
        return loop in self.cached

    def compile_here(self, loop: Loop) -> None:
        self.done.append(("compile", loop))
        self.compiled.add(loop)


class Worker:
    def __init__(self, machine: Machine) -> None:
        self.machine = machine
        self.is_idle = self.has_ended = False
        self.asked: list[Loop] = []

    def ask(self, loop: Loop) -> None:
        self.asked.append(loop)

    def answer(self, seconds: float) -> str | None:
        return GONE if self.has_ended else self.machine.script(self.machine, self.asked[-1])

    def let_others_go_first(self) -> None:
        self.is_idle = True

    def end(self) -> None:
        self.has_ended = True


def keeps(machine: Machine, loop: Loop) -> str:
    machine.cached.add(loop)
    return CodeOrigin.COMPILED


@pytest.fixture
def machine(monkeypatch: pytest.MonkeyPatch) -> Machine:
    machine = Machine()
    monkeypatch.setattr(background, "COMPILED_LOOPS", machine.compiled)
    monkeypatch.setattr(background, "WorkerProcess", lambda: machine.start_worker())
    monkeypatch.setattr(loops, "load", machine.load)
    monkeypatch.setattr(loops, "compile_here", machine.compile_here)
    monkeypatch.setattr(loops, "LOOKED_FOR_EVERY", 0.001)
    monkeypatch.setattr(cache_folder, "was_compiled", machine.was_compiled)
    monkeypatch.setattr(cache_folder, "takes_code", lambda: machine.takes_code)
    return machine


class Asked(NamedTuple):
    compiler: BackgroundCompiler
    may_end: threading.Event


@pytest.fixture
def asked(machine: Machine) -> Asked:
    is_asked, may_end = threading.Event(), threading.Event()

    def slowly(machine: Machine, loop: Loop) -> str | None:
        is_asked.set()
        return keeps(machine, loop) if may_end.wait(0.001) else None

    machine.script = slowly
    compiler = BackgroundCompiler()
    compiler.want([LOOP])
    assert is_asked.wait(LONGEST)
    return Asked(compiler, may_end)


def finish(compiler: BackgroundCompiler) -> None:
    for thread in threading.enumerate():
        if thread.name == "background compiler":
            thread.join(LONGEST)
            assert not thread.is_alive()
    assert not compiler.is_busy


def come_by(*wanted: Loop) -> BackgroundCompiler:
    compiler = BackgroundCompiler()
    compiler.want(wanted)
    finish(compiler)
    return compiler


def test_what_is_in_the_cache_is_read_and_no_process_starts(machine: Machine) -> None:
    machine.noted, machine.cached = {LOOP}, {LOOP}
    come_by(LOOP)
    assert machine.done == [("load", LOOP)]
    assert machine.workers == []


def test_one_worker_compiles_all_that_is_wanted_and_ends(machine: Machine) -> None:
    come_by(LOOP, OTHER)
    assert machine.done == [("load", LOOP), ("load", OTHER)]
    (only,) = machine.workers
    assert only.asked == [LOOP, OTHER]
    assert only.has_ended


def test_a_note_without_machine_code_is_asked_of_the_worker(machine: Machine) -> None:
    machine.noted = {LOOP}
    come_by(LOOP)
    assert machine.done == [("load", LOOP), ("load", LOOP)]
    assert len(machine.workers) == 1


def test_where_the_worker_dies_this_process_compiles(machine: Machine) -> None:
    machine.script = lambda *_: GONE
    come_by(LOOP, OTHER)
    assert machine.done == [("compile", LOOP), ("compile", OTHER)]
    assert all(each.has_ended for each in machine.workers)


def test_where_no_process_can_be_started_this_one_compiles(machine: Machine) -> None:
    def refused() -> Worker:
        raise BlockingIOError

    machine.start_worker = refused
    come_by(LOOP)
    assert machine.done == [("compile", LOOP)]


def test_after_a_full_disk_no_worker_is_asked_again(machine: Machine) -> None:
    machine.script = lambda *_: CodeOrigin.NOT_KEPT
    come_by(LOOP, OTHER)
    assert machine.done == [("compile", LOOP), ("compile", OTHER)]
    assert machine.workers[0].asked == [LOOP]


def test_what_the_worker_kept_but_cannot_be_read_is_compiled_here(machine: Machine) -> None:
    machine.script = lambda *_: CodeOrigin.COMPILED
    come_by(LOOP)
    assert machine.done == [("load", LOOP), ("compile", LOOP)]


def test_where_nothing_can_be_kept_no_process_starts(machine: Machine) -> None:
    machine.takes_code = False
    come_by(LOOP)
    assert machine.done == [("compile", LOOP)]
    assert machine.workers == []


def test_what_another_process_compiled_is_read_while_the_worker_waits(machine: Machine) -> None:
    steps = iter([SHARED, LOOP])

    def another(machine: Machine, _: Loop) -> None:
        step = next(steps, None)
        if step is not None:
            machine.noted.add(step)
            machine.cached.add(step)

    machine.script = another
    come_by(LOOP)
    assert machine.done == [("load", SHARED), ("load", LOOP)]
    assert machine.workers[0].has_ended


def test_nothing_more_wanted_lets_others_go_first_and_reads_nothing(machine: Machine, asked: Asked) -> None:
    compiler, may_end = asked
    compiler.want(())
    assert machine.workers[0].is_idle
    assert not machine.workers[0].has_ended
    may_end.set()
    finish(compiler)
    assert machine.done == []
    assert LOOP in machine.cached


def test_an_idle_worker_is_replaced_where_something_else_is_wanted(machine: Machine) -> None:
    is_asked = threading.Event()

    def never(machine: Machine, loop: Loop) -> str | None:
        is_asked.set()
        return keeps(machine, loop) if loop == OTHER else None

    machine.script = never
    compiler = BackgroundCompiler()
    compiler.want([LOOP])
    assert is_asked.wait(LONGEST)
    compiler.want(())
    compiler.want([OTHER])
    finish(compiler)
    assert [each.asked for each in machine.workers] == [[LOOP], [OTHER]]
    assert machine.done == [("load", OTHER)]


def test_where_no_thread_can_be_started_it_compiles_at_once(
    machine: Machine, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refused(_: threading.Thread) -> None:
        raise RuntimeError("can't start new thread")

    monkeypatch.setattr(threading.Thread, "start", refused)
    compiler = BackgroundCompiler()
    compiler.want([LOOP])
    assert machine.done == [("compile", LOOP)]
    assert machine.workers == []


def test_to_finish_waits_for_the_worker_and_reads_nothing(machine: Machine, asked: Asked) -> None:
    compiler, may_end = asked
    threading.Timer(0.01, may_end.set).start()
    compiler.finish(LONGEST)
    finish(compiler)
    assert (machine.cached, machine.done) == ({LOOP}, [])


def test_to_finish_gives_up_a_worker_that_takes_too_long(asked: Asked) -> None:
    compiler, may_end = asked
    compiler.finish(0.0)
    assert compiler.is_busy
    may_end.set()
    finish(compiler)


def test_a_thread_that_dies_leaves_nothing_waiting(machine: Machine) -> None:
    def dies(machine: Machine, loop: Loop) -> str:
        raise SystemExit

    machine.script = dies
    compiler = come_by(LOOP, OTHER)
    assert compiler.failed.keys() == {LOOP, OTHER}
    assert not compiler.is_busy


def test_what_cannot_be_had_here_is_told_as_false(machine: Machine, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(loop: Loop) -> None:
        raise ImportError("no numba")

    monkeypatch.setattr(loops, "compile_here", broken)
    monkeypatch.setattr(loops, "load", broken)
    compiler = BackgroundCompiler()
    assert not compiler.get(LOOP)
    assert not compiler.read(OTHER)
    assert compiler.failed.keys() == {LOOP, OTHER}
    assert not compiler.is_loading


def test_what_fails_stays_interpreted_and_is_not_tried_again(
    machine: Machine, monkeypatch: pytest.MonkeyPatch
) -> None:
    machine.takes_code = False

    def broken(loop: Loop) -> None:
        if loop == LOOP:
            raise ImportError("no numba")
        machine.compile_here(loop)

    monkeypatch.setattr(loops, "compile_here", broken)
    compiler = come_by(LOOP, OTHER)
    assert machine.done == [("compile", OTHER)]
    assert isinstance(compiler.failed[LOOP], ImportError)
    assert compiler.why_not([LOOP]).endswith("ImportError: no numba")
    assert compiler.why_not([LOOP, OTHER]) == compiler.why_not([]) == ""
    compiler.want([LOOP])
    assert not compiler.is_busy


def test_the_worker_answers_each_line() -> None:
    asked = [json.dumps(LOOP), json.dumps(OTHER)]
    seen: list[Loop] = []

    def come_by(loop: Loop) -> CodeOrigin:
        seen.append(loop)
        return CodeOrigin.FOUND if loop == LOOP else CodeOrigin.COMPILED

    stdout = io.StringIO()
    worker.work(asked, stdout, come_by)
    assert seen == [LOOP, OTHER]
    assert stdout.getvalue() == "found\ncompiled\n"


@pytest.fixture
def empty_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    folder = tmp_path / "cache"
    folder.mkdir()
    for module in (cache_folder, compiler_lock, loops):
        monkeypatch.setattr(module, "cache_folder", lambda: folder)
    return folder


@pytest.fixture
def made(monkeypatch: pytest.MonkeyPatch) -> list[Loop]:
    """A list of everything that would be compiled or read; nothing really is."""
    made: list[Loop] = []
    monkeypatch.setattr(loops, "COMPILED_LOOPS", set[Loop]())
    monkeypatch.setattr(loops, "_make", made.append)
    return made


def names(folder: Path) -> set[str]:
    return {path.name for path in folder.iterdir()}


def test_what_is_compiled_is_noted_with_what_all_share(empty_cache: Path, made: list[Loop]) -> None:
    compile_here(LOOP)
    assert made == [SHARED, LOOP]
    assert cache_folder.was_compiled(SHARED)
    assert cache_folder.was_compiled(LOOP)
    assert not cache_folder.was_compiled(OTHER)
    assert len(names(empty_cache)) == 2  # and no lock


def test_what_the_cache_did_not_take_is_not_noted(
    empty_cache: Path, made: list[Loop], monkeypatch: pytest.MonkeyPatch
) -> None:
    from rl_tui.agents.compiling.machine_cache import SAVES

    monkeypatch.setattr(SAVES, "failed", True)
    assert compile_here(LOOP) is CodeOrigin.NOT_KEPT
    assert names(empty_cache) == set()


def test_a_kiosk_writes_neither_a_lock_nor_a_note(
    empty_cache: Path, made: list[Loop], monkeypatch: pytest.MonkeyPatch
) -> None:
    seen: list[set[str]] = []
    monkeypatch.setattr(loops, "_make", lambda loop: seen.append(names(empty_cache)))
    for module in (cache_folder, compiler_lock, loops):
        monkeypatch.setattr(module, "takes_code", lambda: False)
    compile_here(LOOP)
    assert seen == [set(), set()]
    assert names(empty_cache) == set()


def test_who_waits_for_the_compiler_reads_what_it_keeps(
    empty_cache: Path, made: list[Loop], monkeypatch: pytest.MonkeyPatch
) -> None:
    with CompilerLock() as lock:
        assert lock.acquire()
        waits = 0

        def sleep(_: float) -> None:
            nonlocal waits
            waits += 1
            assert made == []
            if waits == 3:
                cache_folder.note_compiled(LOOP)

        monkeypatch.setattr(loops.time, "sleep", sleep)
        monkeypatch.setattr(loops, "load", lambda loop: True)
        assert compile_here(LOOP) is CodeOrigin.FOUND
    assert (waits, made) == (3, [])


def test_a_compiler_that_was_stopped_is_not_waited_for(
    empty_cache: Path, made: list[Loop], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(loops, "LONGEST_WAIT", 0.0)
    with CompilerLock() as lock:
        assert lock.acquire()
        compile_here(LOOP)
    assert made == [SHARED, LOOP]


def test_where_there_can_be_no_lock_nobody_waits(empty_cache: Path, made: list[Loop]) -> None:
    (empty_cache / ".compiling.lock").mkdir()
    compile_here(LOOP)
    assert made == [SHARED, LOOP]


def test_torn_files_are_removed_once_nobody_can_be_writing_them(empty_cache: Path) -> None:
    (empty_cache / "module").mkdir()
    left = empty_cache / "module" / "f-1.py311.1.nbc.tmp.0123456789abcdef"
    left.touch()
    cache_folder.remove_unfinished(left.stat().st_mtime + 1)
    assert left.exists()
    cache_folder.remove_unfinished(left.stat().st_mtime + cache_folder.LONGEST_WRITTEN + 1)
    assert not left.exists()


def test_all_loops_are_different_and_have_a_learner() -> None:
    found = list(all_loops())
    assert len(found) == len(set(found))
    assert all(loops.learner_of(loop).loop == loop for loop in found)
