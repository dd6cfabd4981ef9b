"""A sentence on errors that nearly everybody meets: modules that are missing, and the API of the old Gym."""

from __future__ import annotations

import linecache
import re
from collections.abc import Sequence
from types import FrameType
from typing import Final

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
"""Modules that are well known, and the package that one installs for each.

Any other name may be a misspelt one or somebody's own, and a package of that name may be anything.
"""
_GYM: Final = (
    "Gym is Gymnasium now: write `import gymnasium as gym`, which is installed; "
    "reset then returns (observation, info), and step (observation, reward, terminated, truncated, info)"
)
_STEP: Final = (
    "step returns five values since Gym 0.26: write `next_state, reward, terminated, truncated, info = "
    "env.step(action)`, and `done = terminated or truncated`"
)
_RESET: Final = "reset returns (observation, info) since Gym 0.26: write `state, info = env.reset()`"
_UNKNOWN: Final = "if it is a file of yours, put it beside the script"
_NOTEBOOK: Final = "only a notebook has it: delete the line, which was exported from one"
_ATTRIBUTES: Final = {
    "seed": "environments are seeded by reset since Gym 0.26: write `env.reset(seed=0)`",
    **dict.fromkeys(
        ("P", "nS", "nA", "s", "desc", "nrow", "ncol"),
        "wrappers pass no attributes on since Gymnasium 1.0: write `env.unwrapped.{name}`",
    ),
}
_TOO_MANY: Final = re.compile(r"too many values to unpack \(expected [34]\)")


def advice_on(error: BaseException, text: str, frames: Sequence[FrameType], line: int | None) -> str:
    """Return a sentence that says how to mend ``error``, or nothing.

    ``text`` is what it says, ``frames`` are those of the user's code, the innermost first, and ``line`` is
    the one in the innermost of them that raised it.
    """
    if isinstance(error, ModuleNotFoundError):
        return _on_missing(error.name or "")
    if isinstance(error, ValueError) and _TOO_MANY.search(text):
        return _STEP if _calls_step(frames, line) else ""
    if isinstance(error, NameError) and error.name in ("get_ipython", "display"):
        return _NOTEBOOK
    if isinstance(error, AttributeError):
        is_environment = _is_environment(error.obj)
        return _ATTRIBUTES.get(error.name or "", "").format(name=error.name) if is_environment else ""
    if isinstance(error, TypeError) and "render()" in text and "mode" in text:
        return "how to draw is said to gymnasium.make since Gym 0.26, by its argument `render_mode`"
    if isinstance(error, TypeError | LookupError | ValueError) and _has_whole_reset(frames):
        return _RESET
    return ""


def _on_missing(name: str) -> str:
    top = name.partition(".")[0]
    if top == "gym":
        return _GYM
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
    """Return whether a variable there is all that ``reset`` returned, the observation and the info."""
    return any(
        type(value) is tuple and len(value) == 2 and type(value[1]) is dict
        for frame in frames
        for value in frame.f_locals.values()
    )


def _is_environment(value: object) -> bool:
    from gymnasium import Env

    return isinstance(value, Env)
