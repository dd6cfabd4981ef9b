"""What a script raised: where in the user's own code, and what may help."""

from __future__ import annotations

import sys
import sysconfig
import traceback
from collections.abc import Iterator
from pathlib import Path
from types import FrameType, TracebackType
from typing import Any, Final

from rl_tui.common.errors import UserError
from rl_tui.lab.programs.child.advice import advice_on

_OURS: Final = str(Path(__file__).parents[3])
_LIBRARIES: Final = tuple(
    {sysconfig.get_path(name) for name in ("stdlib", "platstdlib", "purelib", "platlib")}
    | {"<frozen", sys.prefix + "/lib"}
)
_LONGEST_TEXT: Final = 1_000
_LONGEST_TRACEBACK: Final = 12_000
_MOST_FRAMES: Final = 40


def is_users_file(file: str) -> bool:
    """Return whether code of ``file`` is the user's own: none of ours, no library and no part of Python."""
    return not (file.startswith((_OURS, *_LIBRARIES)) or "site-packages" in file or "dist-packages" in file)


def users_place(frame: FrameType | None) -> tuple[str, int] | None:
    """Return file and line of the user's code that runs in ``frame`` or led to it, None without any."""
    while frame is not None:
        if is_users_file(frame.f_code.co_filename):
            return frame.f_code.co_filename, line_of(frame)
        frame = frame.f_back
    return None


def line_of(frame: FrameType) -> int:
    """Return the line that ``frame`` is at.

    Some instructions have none, such as the jump back to the head of a loop: then it is the line before them.
    """
    if frame.f_lineno is not None:
        return frame.f_lineno
    before = [line for start, _, line in frame.f_code.co_lines() if line and start <= frame.f_lasti]
    return before[-1] if before else frame.f_code.co_firstlineno


def described(error: BaseException) -> dict[str, Any]:
    """Return what is told of ``error``: type, text, file, line and traceback, without frames of ours.

    The place is the innermost one in the user's code; of a syntax error it is the line that has it.
    """
    if isinstance(error, UserError) and isinstance(error.__cause__, SyntaxError):
        error = error.__cause__
    frames = [each for each in _walk(error.__traceback__) if not _is_ours(each[0])]
    own = [each for each in frames if is_users_file(each[0].f_code.co_filename)] or frames
    file, line = (own[-1][0].f_code.co_filename, own[-1][1]) if own else ("", None)
    if isinstance(error, SyntaxError) and error.filename:
        file, line = error.filename, error.lineno
    text = _text_of(error)
    advice = advice_on(error, text, [frame for frame, _ in own[::-1]], line)
    return {
        "type": type(error).__name__,
        "text": _bounded(f"{text}: {advice}" if text and advice else text or advice, _LONGEST_TEXT),
        "file": file,
        "line": line,
        "traceback": _bounded(_formatted(error), _LONGEST_TRACEBACK),
    }


def _walk(trace: TracebackType | None) -> Iterator[tuple[FrameType, int]]:
    while trace is not None:
        yield trace.tb_frame, trace.tb_lineno
        trace = trace.tb_next


def _is_ours(frame: FrameType) -> bool:
    return frame.f_code.co_filename.startswith(_OURS)


def _text_of(error: BaseException) -> str:
    if isinstance(error, SyntaxError):
        return error.msg or ""
    try:
        return str(error)
    except Exception:  # a class of the user's may say what it likes
        return ""


def _formatted(error: BaseException) -> str:
    report = traceback.TracebackException.from_exception(error, compact=True)
    chain: traceback.TracebackException | None = report
    while chain is not None:
        kept = [each for each in chain.stack if not each.filename.startswith(_OURS)]
        dropped = kept[_MOST_FRAMES // 2 : -_MOST_FRAMES // 2] if len(kept) > _MOST_FRAMES else []
        chain.stack = traceback.StackSummary.from_list([each for each in kept if each not in dropped])
        chain = chain.__cause__ or chain.__context__
    return "".join(report.format())


def _bounded(text: str, longest: int) -> str:
    """Return a text of at most ``longest`` characters: its beginning and its end, where it is longer."""
    half = longest // 2
    return text if len(text) <= longest else f"{text[:half]}\n…\n{text[len(text) - half :]}"
