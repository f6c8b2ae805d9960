# SPDX-License-Identifier: GPL-3.0-or-later

"""Filter kernels in closed form, and their weights of texels, independent of the library's."""

import numpy as np


def mitchell(x):
    x = abs(x)
    near = (7 * x**3 - 12 * x**2 + 16 / 3) / 6
    far = (-7 / 3 * x**3 + 12 * x**2 - 20 * x + 32 / 3) / 6
    return np.where(x < 1, near, np.where(x < 2, far, 0.0))


def bspline2(x):
    x = abs(x)
    return np.where(x < 0.5, 0.75 - x**2, np.where(x < 1.5, (1.5 - x) ** 2 / 2, 0.0))


def lanczos(radius):
    return lambda x: np.where(abs(x) < radius, np.sinc(x) * np.sinc(x / radius), 0.0)


# Half the width of each kernel's support. A new separable filter needs a line here and, unless it
# is the box, in KERNELS: all oracles of images, levels and shapes iterate over these tables.
RADII = {
    "box": 0.5,
    "tent": 1.0,
    "bspline2": 1.5,
    "mitchell": 2.0,
    "lanczos2": 2.0,
    "lanczos3": 3.0,
    "gaussian": 2.0,
}

# The kernel, and the largest error of the library's polynomials.
KERNELS = {
    "tent": (lambda x: np.maximum(0.0, 1 - abs(x)), 1e-7),
    "bspline2": (bspline2, 1e-7),
    "mitchell": (mitchell, 1e-7),
    "lanczos2": (lanczos(2), 1e-5),
    "lanczos3": (lanczos(3), 1e-5),
    "gaussian": (lambda x: np.where(abs(x) < 2, np.exp(-np.pi * x**2), 0.0), 5e-6),
}
FILTERS = tuple(RADII)
RADIAL = ("radial2", "radial3")  # Their oracles integrate over the plane.


def tolerance_of(filter):
    """How far weighted means of values in [0, 1] may be off."""
    return 2e-7 + (KERNELS[filter][1] if filter in KERNELS else 0.0)


def folded(weights, reach, size, wrap):
    """Folds the weights of texels -reach ... size + reach onto the image's own texels."""
    texel = np.arange(-reach, size + reach)
    read = np.clip(texel, 0, size - 1) if wrap == "clamp" else texel % size
    counts = (wrap != "border") | (read == texel)
    result = np.zeros((size, len(weights)))
    np.add.at(result, read[counts], weights.T[counts])
    return result.T


def weights_at(filter, centers, width, size, wrap):
    """Weights of texels along an axis, a row per center; the kernel's unit is `width` texels."""
    center = np.atleast_1d(np.asarray(centers, float))[:, None]
    reach = int(np.ceil(3 * max(width, 1) + abs(center).max())) + 1
    texel = np.arange(-reach, size + reach)
    if filter == "box":
        low = np.maximum(texel, center - width / 2)
        weights = np.maximum(0.0, np.minimum(texel + 1, center + width / 2) - low)
    else:
        weights = KERNELS[filter][0]((texel + 0.5 - center) / max(1.0, width))
    return folded(weights / weights.sum(axis=1, keepdims=True), reach, size, wrap)


def weights_of_texels(filter, size, target, wrap):
    """Weights for each of the texels that an axis is resampled to."""
    ratio = size / target
    return weights_at(filter, (np.arange(target) + 0.5) * ratio, ratio, size, wrap)
