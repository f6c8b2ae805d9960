# SPDX-License-Identifier: GPL-3.0-or-later

"""Checks of results that know nothing of how they were made."""

from collections.abc import Callable, Mapping
from typing import Any

from bench.field.checks import messages, pictures, surfaces, textures
from bench.field.runs import Run

Truth = Mapping[str, Any]
"""The facts that a generator knows about its file: see the modules in `generators`."""

_OF_RESULTS: dict[str, Callable[[Run, Truth], list[str]]] = {
    "voxelize": surfaces.check_solid,
    "Voxelize (operator)": surfaces.check_solid,
    "reconstruct": surfaces.check_scan,
    "Reconstruct (operator)": surfaces.check_scan,
    "resize": pictures.check_resized,
    "rasterize": pictures.check_drawn,
    "mipmaps": textures.check_levels,
    "bake --all": textures.check_model,
}


def check(run: Run, truth: Truth) -> list[str]:
    """Returns the faults of a run, each as its class, a colon and details."""
    findings = [*run.findings, *messages.check(run, truth)]
    if run.has_result:
        findings += _OF_RESULTS[run.entry_point](run, truth)
    return findings
