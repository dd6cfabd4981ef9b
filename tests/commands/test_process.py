"""Settings of the process before heavy imports."""

from __future__ import annotations

import os
import sys

import pytest

from rl_tui.commands import main

NAME = "OPENBLAS_NUM_THREADS"


@pytest.mark.parametrize(("given", "then"), [({}, "1"), ({NAME: "4"}, "4"), ({"OMP_NUM_THREADS": "4"}, None)])
def test_linear_algebra_gets_one_thread_unless_somebody_wants_more(
    given: dict[str, str], then: str | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(os, "environ", dict(given))
    monkeypatch.delitem(sys.modules, "numpy", raising=False)
    main.calculate_in_one_thread()
    assert os.environ.get(NAME) == then
