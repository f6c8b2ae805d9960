# SPDX-License-Identifier: GPL-3.0-or-later

"""Pictures of texel weights."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import prefilter
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from ...bridge.images import FloatArray

OCTAVES = 4
"""Colors span weights from 2^-OCTAVES to 2^OCTAVES; weights beyond are clamped."""

_STRIPE = 1 / 64  # The period of the hatching, as a share of the longer side.
_STRIPES = ((0.32, 0.32, 0.32), (0.22, 0.22, 0.22))

# A path through OKLab (Ottosson, 2020): lightness is linear, so equal ratios of weights look
# equally far apart, and gray prints keep the order. The hue goes from blue over red to yellow.
_LIGHTNESS = (0.28, 0.96)
_HUE = (-95.0, 105.0)  # In degrees.
_CHROMA = 0.13
_LAB_TO_LMS = np.array(
    [
        [1.0, 0.3963377774, 0.2158037573],
        [1.0, -0.1055613458, -0.0638541728],
        [1.0, -0.0894841775, -1.2914855480],
    ]
)
_LMS_TO_RGB = np.array(
    [
        [4.0767416621, -3.3077115913, 0.2309699292],
        [-1.2684380046, 2.6097574011, -0.3413193965],
        [-0.0041960863, -0.7034186147, 1.7076147010],
    ]
)


@dataclass(frozen=True)
class Weights:
    """A picture of weights, and the share of texels with a weight above 0."""

    picture: "FloatArray"
    used_share: float


def colors(weights: ArrayLike) -> NDArray[np.float32]:
    """Returns (..., 3) sRGB colors for weights above 0, by their logarithm."""
    octave = np.log2(np.maximum(np.asarray(weights, float), 2.0 ** -(OCTAVES + 1)))
    position = np.clip(octave / (2 * OCTAVES) + 0.5, 0.0, 1.0)
    lightness = _LIGHTNESS[0] + position * (_LIGHTNESS[1] - _LIGHTNESS[0])
    hue = np.radians(_HUE[0] + position * (_HUE[1] - _HUE[0]))
    chroma = _CHROMA * np.ones_like(position)
    lab = np.stack([lightness, chroma * np.cos(hue), chroma * np.sin(hue)], axis=-1)
    light = ((lab @ _LAB_TO_LMS.T) ** 3) @ _LMS_TO_RGB.T
    flat = np.clip(light, 0.0, 1.0).astype(np.float32).reshape(-1, 1, 3)
    return prefilter.to_srgb(flat).reshape(light.shape)


def picture(weights: NDArray[np.float32]) -> "FloatArray":
    """Returns (height, width, 4) sRGB colors; texels of weight 0 are hatched in gray."""
    height, width = weights.shape
    rgba = np.ones((height, width, 4), np.float32)
    rgba[..., :3] = colors(weights)
    period = max(4, round(max(width, height) * _STRIPE))
    diagonal = (np.arange(height)[:, None] + np.arange(width)) % period
    hatching = np.array(_STRIPES, np.float32)[(2 * diagonal >= period).astype(int)]
    unused = weights == 0.0
    rgba[unused, :3] = hatching[unused]
    return rgba


def unused_color() -> tuple[float, float, float]:
    """Returns the mean color of the hatching."""
    return tuple(np.mean(_STRIPES, axis=0))
