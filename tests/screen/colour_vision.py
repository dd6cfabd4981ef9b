"""The look of colours, for all eyes."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from rich.color import Color

Vector = npt.NDArray[np.float64]

# G. M. Machado, M. M. Oliveira, L. A. F. Fernandes: A Physiologically-based Model for Simulation of Color
# Vision Deficiency. IEEE TVCG 15 (6), 2009, pp. 1291-1298: the matrices of severity 1 for linear RGB, for
# protanopia, deuteranopia and tritanopia
EYES = {
    "all cones": np.eye(3),
    "no long cones": np.array(
        [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]]
    ),
    "no medium cones": np.array(
        [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]]
    ),
    "no short cones": np.array(
        [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]]
    ),
}
XYZ = np.array(
    [[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750], [0.0193339, 0.1191920, 0.9503041]]
)
WHITE = np.array([0.95047, 1.0, 1.08883])


def linear(color: Color) -> Vector:
    channels = np.array(color.get_truecolor()) / 255.0
    return np.where(channels <= 0.04045, channels / 12.92, ((channels + 0.055) / 1.055) ** 2.4)


def luminance(color: Color) -> float:
    """Relative luminance of WCAG, 0 to 1."""
    return float(XYZ[1] @ linear(color))


def lightness(color: Color) -> float:
    """CIE L*, 0 to 100: equal steps look equal."""
    return float(_lab(color, EYES["all cones"])[0])


def contrast(one: Color, other: Color) -> float:
    """Contrast ratio of WCAG, 1 to 21."""
    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)


def distance(one: Color, other: Color, eye: str) -> float:
    """CIE 1976 distance as ``eye`` sees both. About 2 is the smallest visible distance."""
    return float(np.linalg.norm(_lab(one, EYES[eye]) - _lab(other, EYES[eye])))


def least_distance(one: Color, other: Color) -> float:
    return min(distance(one, other, eye) for eye in EYES)


def _lab(color: Color, eye: Vector) -> Vector:
    seen = np.clip(eye @ linear(color), 0.0, 1.0)
    ratio = XYZ @ seen / WHITE
    root = np.where(ratio > 216 / 24389, np.cbrt(ratio), (24389 / 27 * ratio + 16) / 116)
    return np.array([116 * root[1] - 16, 500 * (root[0] - root[1]), 200 * (root[1] - root[2])])
