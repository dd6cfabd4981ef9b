"""Errors of the user's code, with advice on common ones."""

from __future__ import annotations

import linecache
import re
import sys
import sysconfig
import traceback
from collections.abc import Iterator, Sequence
from pathlib import Path
from types import FrameType
from typing import Any, Final

from rl_tui.common.errors import UserError
from rl_tui.programs.watched.notebook import cell_of

# Errors and their lines


_OURS: Final = str(Path(__file__).parents[3])
_LIBRARIES: Final = tuple(
    {sysconfig.get_path(name) for name in ("stdlib", "platstdlib", "purelib", "platlib")}
    | {"<frozen", sys.prefix + "/lib"}
)
_LONGEST_TEXT: Final = 1_000
_LONGEST_TRACEBACK: Final = 12_000
_MOST_FRAMES: Final = 40
_watched: Final[set[str]] = set()


def watch_file(path: Path) -> None:
    """Let the file at `path` count as the user's, wherever it lies."""
    _watched.add(str(path.absolute()))


def is_users_file(file: str) -> bool:
    """Return True for the watched file, and for code that is not ours, a library's or Python's."""
    if file in _watched:
        return True
    return not (file.startswith((_OURS, *_LIBRARIES)) or "site-packages" in file or "dist-packages" in file)


def users_place(frame: FrameType | None) -> tuple[str, int] | None:
    """Return file and line of the user's code in or above `frame`."""
    users = (each for each in with_callers(frame) if is_users_file(each.f_code.co_filename))
    return next(((each.f_code.co_filename, line_of(each)) for each in users), None)


def with_callers(frame: FrameType | None) -> Iterator[FrameType]:
    """Yield `frame` and all frames above it."""
    while frame is not None:
        yield frame
        frame = frame.f_back


def line_of(frame: FrameType) -> int:
    """Return the current line of `frame`, the one before for an instruction without a line."""
    if frame.f_lineno is not None:
        return frame.f_lineno
    before = [line for start, _, line in frame.f_code.co_lines() if line and start <= frame.f_lasti]
    return before[-1] if before else frame.f_code.co_firstlineno


def described(error: BaseException) -> dict[str, Any]:
    """Describe `error` without our frames, at the innermost place in the user's code or the syntax error."""
    if isinstance(error, UserError) and isinstance(error.__cause__, SyntaxError):
        error = error.__cause__
    frames = [
        each for each in traceback.walk_tb(error.__traceback__) if not _is_ours(each[0].f_code.co_filename)
    ]
    own = [each for each in frames if is_users_file(each[0].f_code.co_filename)] or frames
    file, line = (own[-1][0].f_code.co_filename, own[-1][1]) if own else ("", None)
    if isinstance(error, SyntaxError) and error.filename:
        file, line = error.filename, error.lineno
    text = _text_of(error)
    advice = _advice_on(error, text, [frame for frame, _ in own[::-1]], line)
    return {
        "type": type(error).__name__,
        "text": _bounded(f"{text}: {advice}" if text and advice else text or advice, _LONGEST_TEXT),
        "file": file,
        "line": line,
        "traceback": _bounded(_formatted(error), _LONGEST_TRACEBACK),
    }


def _is_ours(file: str) -> bool:
    return file.startswith(_OURS) and file not in _watched


def _text_of(error: BaseException) -> str:
    if isinstance(error, SyntaxError):
        return error.msg or ""
    try:
        return str(error)
    except Exception:  # a user's class may raise anything
        return ""


def _formatted(error: BaseException) -> str:
    report = traceback.TracebackException.from_exception(error, compact=True)
    chain: traceback.TracebackException | None = report
    while chain is not None:
        kept = [each for each in chain.stack if not _is_ours(each.filename)]
        dropped = kept[_MOST_FRAMES // 2 : -_MOST_FRAMES // 2] if len(kept) > _MOST_FRAMES else []
        chain.stack = traceback.StackSummary.from_list([_shown(each) for each in kept if each not in dropped])
        chain = chain.__cause__ or chain.__context__
    return "".join(report.format())


def _shown(frame: traceback.FrameSummary) -> traceback.FrameSummary:
    cell = None if frame.lineno is None else cell_of(frame.filename, frame.lineno)
    if cell is None:
        return frame
    place = f"{frame.filename}, cell {cell[0]}"
    return traceback.FrameSummary(place, cell[1], frame.name, lookup_line=False, line=frame.line)


def _bounded(text: str, longest: int) -> str:
    half = longest // 2
    return text if len(text) <= longest else f"{text[:half]}\n…\n{text[len(text) - half :]}"


# Advice: modules that are missing, and the API of the old Gym


_PACKAGES: Final = {
    **{
        name: name
        for name in (
            *("gymnasium", "imageio", "ipywidgets", "jax", "keras", "matplotlib", "mlflow", "networkx"),
            *("numba", "numpy", "pandas", "pettingzoo", "plotly", "pygame", "requests", "scipy", "seaborn"),
            *("statsmodels", "sympy", "tensorboard", "tensorflow", "torch", "tqdm", "wandb"),
        )
    },
    "bs4": "beautifulsoup4",
    "cv2": "opencv-python",
    "dotenv": "python-dotenv",
    "gym_toytext": "gymnasium[toy-text]",
    "IPython": "ipython",
    "PIL": "pillow",
    "serial": "pyserial",
    "skimage": "scikit-image",
    "sklearn": "scikit-learn",
    "stable_baselines3": "stable-baselines3",
    "tensorboardX": "tensorboardX",
    "yaml": "PyYAML",
}
"""Well-known modules with the package to install. Other names may be misspelt or the user's own, and a
package of that name may be anything.
"""
_STEP: Final = (
    "since Gym 0.26, step returns five values: write `next_state, reward, terminated, truncated, info = "
    "env.step(action)`, and `done = terminated or truncated`"
)
_RESET: Final = "since Gym 0.26, reset returns (observation, info): write `state, info = env.reset()`"
_UNKNOWN: Final = "if it is your own file, put it next to the script"
_ATTRIBUTES: Final = {
    "seed": "since Gym 0.26, reset sets the seed: write `env.reset(seed=0)`",
    **dict.fromkeys(
        ("P", "nS", "nA", "s", "desc", "nrow", "ncol"),
        "since Gymnasium 1.0, wrappers do not pass on attributes: write `env.unwrapped.{name}`",
    ),
}
_TOO_MANY: Final = re.compile(r"too many values to unpack \(expected [34]\)")


def _advice_on(error: BaseException, text: str, frames: Sequence[FrameType], line: int | None) -> str:
    if isinstance(error, ModuleNotFoundError):
        return _on_missing(error.name or "")
    if isinstance(error, ValueError) and _TOO_MANY.search(text):
        return _STEP if _calls_step(frames, line) else ""
    if isinstance(error, AttributeError):
        is_environment = _is_environment(error.obj)
        return _ATTRIBUTES.get(error.name or "", "").format(name=error.name) if is_environment else ""
    if isinstance(error, TypeError) and "render()" in text and "mode" in text:
        return "since Gym 0.26, `render_mode` is an argument of gymnasium.make"
    if isinstance(error, TypeError | LookupError | ValueError) and _has_whole_reset(frames):
        return _RESET
    return ""


def _on_missing(name: str) -> str:
    top = name.partition(".")[0]
    if top in _PACKAGES:
        return f"install it with `pip install {_PACKAGES[top]}`"
    return _UNKNOWN if top else ""


def _calls_step(frames: Sequence[FrameType], line: int | None) -> bool:
    if not frames or line is None:
        return False
    code = frames[0].f_code
    around = [linecache.getline(code.co_filename, each) for each in range(line - 1, line + 3)]
    return ".step(" in "".join(around)


def _has_whole_reset(frames: Sequence[FrameType]) -> bool:
    return any(
        type(value) is tuple and len(value) == 2 and type(value[1]) is dict
        for frame in frames
        for value in frame.f_locals.values()
    )


def _is_environment(value: object) -> bool:
    from gymnasium import Env

    return isinstance(value, Env)
