# SPDX-License-Identifier: GPL-3.0-or-later

"""The errors of mipmaps by mip value (figure 7.7)."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, cast

import numpy as np
import prefilter
from numpy.typing import NDArray

from ...core.jobs import Progress, parts, share
from ...core.wording import Sentence, joined
from ..choices import FILTERS, PlotSettings
from ..source import Source

STEPS_PER_LEVEL = 8  # Even, for Simpson's rule.
_FILTERING = 0.7  # Approximate share of the time spent on filtering.


@dataclass(frozen=True)
class ErrorCurves:
    """Root mean square errors over the surface.

    Attributes:
        image: The name of the image.
        filters: Keys of `choices.FILTERS`.
        mip_values: From 0 to the last level.
        errors: (filters, mip values), in scene-linear values.
    """

    image: str
    filters: tuple[str, ...]
    mip_values: NDArray[np.float64]
    errors: NDArray[np.float64]

    @property
    def overall(self) -> NDArray[np.float64]:
        """The root mean square over all mip values, for each filter.

        Between two levels the squared error is a quadratic polynomial of the mip value, for which
        Simpson's rule is exact.
        """
        intervals = len(self.mip_values) - 1
        if intervals == 0:
            return self.errors[:, 0]
        weights = np.full(intervals + 1, 2.0)
        weights[1::2] = 4.0
        weights[[0, -1]] = 1.0
        return np.sqrt((self.errors**2 @ weights) / (3.0 * intervals))

    def table(self) -> str:
        """Returns the values as comma-separated text, with a row for each mip value."""
        rows = [",".join(["mip value", *self.filters])]
        for value, errors in zip(self.mip_values, self.errors.T, strict=True):
            rows.append(",".join([f"{value:g}", *(f"{error:.9g}" for error in errors)]))
        rows.append(",".join(["all", *(f"{error:.9g}" for error in self.overall)]))
        return "\n".join(rows) + "\n"

    def summary(self) -> str:
        """Returns the errors over all mip values, in words."""
        errors = [
            Sentence("{} {}", Sentence(FILTERS[name].label), f"{error:.4g}")
            for name, error in zip(self.filters, self.overall, strict=True)
        ]
        text = "Error of '{}' over all mip values: {}"
        return Sentence(text, self.image, joined(", ", errors))


def default_filters(reader: str) -> tuple[str, ...]:
    """Returns the default filters to compare, for a key of `choices.READERS`."""
    return tuple(
        name for name in PlotSettings.filters if reader == "linear" or name != "pam-trilinear"
    )


def measure(source: Source, filters: Sequence[str], progress: Progress) -> ErrorCurves:
    """Filters an image with each filter, and measures the levels.

    The errors are those of supersampled readers, whatever the lookups of the settings.

    Args:
        source: The image and its surfaces, of which it needs at least one.
        filters: Keys of `choices.FILTERS`.
        progress: Called with the fraction done.

    Raises:
        prefilter.Cancelled: `progress` returned False.
        ValueError: No filter is asked for, or the library refuses the image or the surfaces.
        OSError: The color space needs a module that is missing.
    """
    if not filters:
        raise ValueError(Sentence("Filters: choose at least one"))
    linear = source.linear(progress)
    errors = []
    for name, part in zip(filters, parts(progress, len(filters)), strict=True):
        levels = source.filtered(linear, name, share(part, 0.0, _FILTERING), footprint=0.0)
        last = len(levels) - 1
        mip_values = np.linspace(0.0, last, STEPS_PER_LEVEL * last + 1)
        with source.naming_objects():
            errors.append(
                prefilter.mipmap_error(
                    levels,
                    linear,
                    source.surfaces,
                    mip_values,
                    wrap=cast("Any", source.wrap),
                    reader=cast("Any", source.reader),
                    progress=share(part, _FILTERING, 1.0),
                    threads=source.threads,
                )
            )
    return ErrorCurves(source.image_name, tuple(filters), mip_values, np.array(errors))
