"""The connection to a Dask scheduler. Only this module imports Dask."""

from __future__ import annotations

import asyncio
import logging
import pickle
import queue
import threading
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from concurrent.futures import CancelledError
from contextlib import contextmanager, suppress
from functools import partial
from typing import TYPE_CHECKING, Any, Final, NamedTuple, TypeVar, cast

from rl_tui.common.errors import UserError
from rl_tui.studies.sweeps.cluster.task import Call
from rl_tui.studies.sweeps.cluster.versions import NO_VERSION, PACKAGES, PYTHON, minor

if TYPE_CHECKING:
    from distributed import Client, Future

MISSING: Final = 'the option --dask needs another package: pip install "rl-tui[dask]"'
LONGEST_CONNECT: Final = 10.0
LONGEST_ANSWER: Final = 60.0
LONGEST_LOOK: Final = 5.0
LONGEST_GOODBYE: Final = 2.0
"""Time limits in seconds."""

T = TypeVar("T")


class Landed(NamedTuple):
    """The end of a future. A CancelledError means a lost connection."""

    key: str
    result: Any = None
    error: BaseException | None = None


class Connection:
    """A client of the scheduler at `address`, for one thread. Raises UserError, now or later."""

    def __init__(self, address: str, longest_connect: float = LONGEST_CONNECT) -> None:
        try:
            from distributed import Client
        except ImportError as error:
            raise UserError(MISSING) from error
        self.address = address
        _silence()
        _check_scheduler(address, longest_connect)
        self._client: Client = Client(address, timeout=longest_connect, set_as_default=False)
        self._futures: dict[str, Future] = {}
        self._done: dict[str, queue.SimpleQueue[Future | None]] = {}
        self._landed: queue.SimpleQueue[Landed] = queue.SimpleQueue()

    def threads(self) -> dict[str, int]:
        """Return the threads of each worker by address."""
        with self._in_one_line():
            return dict(within(LONGEST_ANSWER, self._client.nthreads))

    def versions(self, workers: Sequence[str]) -> dict[str, dict[str, str]]:
        """Return the versions of Python and `PACKAGES` on `workers`, without sending our code.

        A worker that has left is missing, and one that does not respond has no versions.
        """
        try:
            return self._versions(workers, LONGEST_LOOK)
        except TimeoutError:
            if len(workers) == 1:
                return {workers[0]: {}}
            return {address: said for each in workers for address, said in self.versions([each]).items()}
        except OSError as error:
            raise UserError(gone(self.address)) from error

    def _versions(self, workers: Sequence[str], longest: float) -> dict[str, dict[str, str]]:
        import importlib.metadata
        import platform

        found: dict[str, dict[str, str]] = {address: {} for address in workers}
        asked: list[tuple[str, Callable[..., str], tuple[str, ...]]] = [
            (PYTHON, platform.python_version, ()),
            *((name, importlib.metadata.version, (name,)) for name in PACKAGES),
        ]
        for name, function, arguments in asked:
            if not found:
                break
            self.check()
            run = partial(self._client.run, function, *arguments, workers=list(found), on_error="return")
            for address, version in within(longest, run).items():
                if isinstance(version, OSError):
                    del found[address]
                elif isinstance(version, Exception):
                    found[address][name] = NO_VERSION
                else:
                    found[address][name] = minor(version) if name == PYTHON else version
        return found

    def submit(self, key: str, call: Call, worker: str) -> None:
        """Call `call` on `worker` only. `landed` returns the result."""
        with self._in_one_line():
            future = self._client.submit(
                pickle.loads, call.pickled, key=key, workers=[worker], allow_other_workers=False, pure=False
            )
        self._futures[key] = future
        if worker not in self._done:
            self._done[worker] = queue.SimpleQueue()
            # Dask tries for half a minute to reach a worker that died with a result, which must
            # not delay the others
            threading.Thread(
                target=self._collect, args=(self._done[worker],), name="collects results", daemon=True
            ).start()
        future.add_done_callback(self._done[worker].put)

    def landed(self, seconds: float) -> Iterator[Landed]:
        """Yield finished futures, waiting up to `seconds` for the first."""
        with suppress(queue.Empty):
            each = self._landed.get(timeout=seconds) if seconds > 0 else self._landed.get_nowait()
            while True:
                self._futures.pop(each.key, None)
                yield each
                each = self._landed.get_nowait()

    def forget(self, keys: Collection[str]) -> None:
        """Cancel the futures `keys`."""
        futures = [future for key in keys if (future := self._futures.pop(key, None)) is not None]
        if futures:
            with self._in_one_line():
                self._client.cancel(futures)

    def running_when_left(self, worker: str) -> Collection[str] | None:
        """Return the keys that `worker` was running when it died, or None if unknown.

        Its finished results are lost.
        """
        if worker in self._done:
            self._done.pop(worker).put(None)
        with self._in_one_line():
            events = self._client.get_events(worker)
        for _, event in reversed(events or ()):
            if isinstance(event, Mapping) and event.get("action") == "remove-worker":
                return () if event.get("expected") else event.get("processing-tasks")
        return None

    def check(self) -> None:
        """Raise UserError if the scheduler has gone."""
        if self._client.status != "running":
            raise UserError(gone(self.address))

    def tell(self, function: Callable[[str], None], argument: str, workers: Sequence[str]) -> None:
        """Call `function` on `workers` during their work, without results."""
        if workers and self._client.status == "running":
            run = partial(self._client.run, function, argument, workers=list(workers), on_error="ignore")
            with suppress(OSError):
                within(LONGEST_GOODBYE, run)

    def close(self) -> None:
        """Cancel unfinished futures and disconnect."""
        try:
            with suppress(OSError, UserError, RuntimeError):
                if self._client.status == "running":
                    self.forget(list(self._futures))
            with suppress(OSError, RuntimeError):
                self._client.close(timeout=LONGEST_GOODBYE)
        finally:
            for done in self._done.values():
                done.put(None)

    def _collect(self, done: queue.SimpleQueue[Future | None]) -> None:
        """Fetch finished results together, because each request costs time."""
        while (future := done.get()) is not None:
            futures = {future.key: future}
            with suppress(queue.Empty):
                while (more := done.get_nowait()) is not None:
                    futures[more.key] = more
                done.put(None)
            try:
                results = self._client.gather(futures, errors="skip")
            except Exception as error:  # a broken connection may raise anything
                is_lost = isinstance(error, OSError) or self._client.status != "running"
                for key in futures:
                    self._landed.put(Landed(key, error=CancelledError(key) if is_lost else error))
                continue
            for key, each in futures.items():
                if each.status == "error":
                    self._landed.put(Landed(key, error=each.exception()))
                elif each.status == "cancelled":
                    self._landed.put(Landed(key, error=CancelledError(key)))
                elif results.get(key) is not None:
                    self._landed.put(Landed(key, results[key]))

    @contextmanager
    def _in_one_line(self) -> Iterator[None]:
        self.check()
        try:
            yield
        except Exception as error:  # a client that is being closed may raise anything
            if isinstance(error, OSError) or self._client.status != "running":
                raise UserError(gone(self.address)) from error
            raise


def within(seconds: float, ask: Callable[[], T]) -> T:
    """Return the result of `ask`. Raises TimeoutError, while it continues in its thread.

    A process that is stopped, or does not speak Dask's protocol, would block clients forever.
    """
    answers: queue.SimpleQueue[tuple[T | None, BaseException | None]] = queue.SimpleQueue()

    def answer() -> None:
        try:
            answers.put((ask(), None))
        except BaseException as error:
            answers.put((None, error))

    threading.Thread(target=answer, name="asks the scheduler", daemon=True).start()
    try:
        result, error = answers.get(timeout=seconds)
    except queue.Empty:
        raise TimeoutError(f"no answer within {seconds:g} s") from None
    if error is not None:
        raise error
    return cast(T, result)


def gone(address: str) -> str:
    """Return the error for a scheduler that has gone."""
    return f"{address}: the scheduler is gone; once it is back, repeat the command to continue from the store"


def _silence() -> None:
    """Silence Dask. An abandoned client logs tracebacks even after it is closed."""
    for name in [*logging.root.manager.loggerDict]:
        if name.split(".")[0] == "distributed":
            logging.getLogger(name).setLevel(logging.CRITICAL + 1)


def _check_scheduler(address: str, longest: float) -> None:
    """Raise UserError if no scheduler responds. A client might wait forever."""
    from distributed import Security, rpc

    async def kind() -> str:
        async with rpc(address, connection_args=Security().get_connection_args("client")) as server:
            return str((await server.identity())["type"])

    try:
        found = asyncio.run(asyncio.wait_for(kind(), longest))
    except TypeError as error:  # there is no certificate
        raise UserError(
            f"{address}: tls:// needs a certificate; name its files in the Dask settings distributed.comm.tls"
        ) from error
    except (OSError, TimeoutError) as error:
        raise UserError(
            f"{address}: no Dask scheduler answers; start one (dask scheduler), or give its address"
        ) from error
    if found != "Scheduler":
        raise UserError(f"{address} is a Dask {found.lower()}; give the address of its scheduler")
