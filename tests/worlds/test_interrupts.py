"""ctrl+C, and environments that raise the same exception."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor

import pytest

from rl_tui.common.interrupts import INTERRUPTS, is_interrupt, note_interrupts


@pytest.fixture(autouse=True)
def usual(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.setattr(INTERRUPTS, "came", False)
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def test_what_an_environment_raises_by_itself_is_no_interrupt() -> None:
    note_interrupts()
    assert not is_interrupt(KeyboardInterrupt())
    with pytest.raises(KeyboardInterrupt) as pressed:
        signal.raise_signal(signal.SIGINT)
    assert is_interrupt(pressed.value)
    assert not is_interrupt(SystemExit())


def test_where_nobody_looks_out_it_is_taken_for_one() -> None:
    assert is_interrupt(KeyboardInterrupt())
    with ThreadPoolExecutor(1) as pool:
        assert not pool.submit(is_interrupt, KeyboardInterrupt()).result()


def test_a_program_that_ignores_it_is_never_interrupted() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    note_interrupts()
    assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN
    assert not is_interrupt(KeyboardInterrupt())
