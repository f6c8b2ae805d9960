# SPDX-License-Identifier: GPL-3.0-or-later

"""Sampling tables of random offsets and weights, within the limits of the file format."""

import json

import numpy as np
import prefilter


def random_table(path, *, filter="lanczos2", texels=8, grid=4, slices=2, degree=1, reach=3, seed=0):
    """A table whose texels lie up to `reach` texels from their cell, read from a file at `path`."""
    rng = np.random.default_rng(seed)
    terms = 4 if degree == 1 else 10
    columns = (grid + 1) // 2
    sections = []
    for levels in (3, 2, 1):
        subdomains = columns * (columns + 1) // 2 * (1 if levels == 1 else slices)
        offsets = rng.integers(-reach, reach, (subdomains, texels, 3), endpoint=True)
        offsets[..., 0] = rng.integers(0, levels, (subdomains, texels))
        coefficients = rng.normal(0.0, 1.0 / texels, (subdomains, texels, terms))
        excess = coefficients.sum(axis=1, keepdims=True) - np.eye(terms)[0]
        coefficients -= excess / texels
        sections.append(
            {
                "levels": levels,
                "offsets": offsets.tolist(),
                "coefficients": coefficients.tolist(),
                "errors": [1.0] * subdomains,
                "trilinear_errors": [1.0] * subdomains,
                "gaps": None,
            }
        )
    table = {
        "format": "prefilter sampling table",
        "version": 1,
        "filter": filter,
        "texels": texels,
        "subdomains": [grid, grid, slices],
        "degree": degree,
        "ramp_weight": 0.0,
        "sections": sections,
    }
    path.write_text(json.dumps(table))
    return prefilter.SamplingTable.load(path)
