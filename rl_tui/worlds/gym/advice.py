"""Gymnasium's log level, one setting for the whole process."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any


@contextmanager
def advice_kept() -> Iterator[None]:
    """Restore the log level afterwards: making an environment silences all advice.

    Works as a decorator too, without importing gymnasium.
    """
    logger = _logger()
    level = None if logger is None else logger.min_level
    try:
        yield
    finally:
        logger = _logger()
        if logger is not None:
            logger.min_level = logger.WARN if level is None else level


def _logger() -> Any:
    return getattr(sys.modules.get("gymnasium"), "logger", None)
