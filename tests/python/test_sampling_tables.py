# SPDX-License-Identifier: GPL-3.0-or-later

"""Sampling tables: the standard ones, their quality, and their files."""

from functools import cache

import numpy as np
import prefilter
import pytest
from prefilter.sampling import sampling_table
from prefilter.sampling.sampling_table import STANDARD_TEXELS

SMALL = {"texels": 4, "subdomains": (2, 2, 1)}


def assert_same(table, other, tolerance=0.0):
    assert repr(table) == repr(other)
    for levels in (3, 2, 1):
        mine, theirs = table.section(levels), other.section(levels)
        np.testing.assert_array_equal(mine.offsets, theirs.offsets)
        for name in ("coefficients", "errors", "trilinear_errors"):
            np.testing.assert_allclose(
                getattr(mine, name), getattr(theirs, name), rtol=0.0, atol=tolerance
            )


@pytest.mark.parametrize("filter", prefilter.SAMPLING_FILTERS)
@pytest.mark.parametrize("texels", STANDARD_TEXELS)
def test_a_standard_table_is_whole(filter, texels):
    table = prefilter.SamplingTable.standard(filter, texels)
    assert (table.filter, table.texels, table.subdomains, table.degree) == (
        filter,
        texels,
        (4, 4, 2),
        1,
    )
    for levels, subdomains in ((3, 6), (2, 6), (1, 3)):
        section = table.section(levels)
        assert section.offsets.shape == (subdomains, texels, 3)
        sums = section.coefficients.sum(axis=1)
        np.testing.assert_allclose(sums, np.eye(4)[:1].repeat(subdomains, 0), atol=1e-7)


@pytest.mark.parametrize(("filter", "texels"), [("tent", 4), ("lanczos2", 8)])
def test_a_standard_table_is_what_build_makes(filter, texels):
    standard = prefilter.SamplingTable.standard(filter, texels)
    built = prefilter.SamplingTable.build(filter, texels=texels)
    assert_same(standard, built, tolerance=1e-8)


# Upper bounds asked of 8 texels, 4 x 4 x 2, linear, as shares of trilinear interpolation's error.
@pytest.mark.parametrize(
    ("filter", "most"), [("box", 0.586), ("tent", 0.237), ("gaussian", 0.220), ("lanczos2", 0.253)]
)
def test_eight_texels_are_better_than_trilinears_eight(filter, most):
    assert 0.0 < prefilter.SamplingTable.build(filter, spectrum="white").error_ratio <= most
    # On natural images they are ahead by more.
    assert 0.0 < prefilter.SamplingTable.standard(filter, 8).error_ratio <= most


@pytest.mark.parametrize("filter", ["tent", "gaussian", "lanczos2"])
def test_four_texels_are_no_worse_than_trilinears_eight(filter):
    assert prefilter.SamplingTable.build(filter, texels=4, spectrum="white").error_ratio < 1.0
    assert prefilter.SamplingTable.standard(filter, 4).error_ratio < 1.0


@pytest.mark.parametrize("filter", ["box", "tent"])
def test_magnified_boxes_and_tents_are_bilinear(filter):
    table = prefilter.SamplingTable.standard(filter, 4)
    assert table.error_ratios[1] == 0.0


def centers_off(table, levels):
    """Distances in cells from samples to the weighted centers of their texels, within a cell."""
    grid, _, slices = table.subdomains
    section = table.section(levels)
    width = 1.0 / 2.0 ** section.offsets[..., :1]
    centers = (section.offsets[..., 1:] + 0.5) * width
    off = []
    for share in np.random.default_rng(0).random((50, 3)):
        y, x = sorted(share[:2] / 2)
        f = share[2] if levels > 1 else x * y
        i, j, k = int(x * grid), int(y * grid), int(f * slices) if levels > 1 else 0
        columns = (grid + 1) // 2
        subdomain = k * columns * (columns + 1) // 2 + i * (i + 1) // 2 + j
        weights = section.coefficients[subdomain] @ (1.0, x, y, f)
        off.append(np.hypot(*(weights @ centers[subdomain] - (x, y))))
    return np.sqrt(np.mean(np.square(off)))


@cache
def heeding_ramps(filter, weight):
    return prefilter.SamplingTable.build(filter, texels=6, ramp_weight=weight)


@pytest.mark.parametrize("levels", [3, 2, 1])
@pytest.mark.parametrize("filter", ["gaussian", "lanczos2"])
def test_ramps_come_out_as_they_are(filter, levels):
    free, standard, strict = (
        centers_off(heeding_ramps(filter, weight), levels) for weight in (0.0, 5.0, 1e6)
    )
    assert standard < 0.7 * free
    assert strict < 1e-3


def test_results_do_not_depend_on_threads():
    one, two = (prefilter.SamplingTable.build("tent", **SMALL, threads=n) for n in (1, 2))
    assert_same(one, two)


def test_a_file_holds_all_of_a_table(tmp_path):
    table = prefilter.SamplingTable.build("mitchell", texels=3, subdomains=(3, 3, 2), degree=2)
    table.save(tmp_path / "table.json")
    assert_same(table, prefilter.SamplingTable.load(tmp_path / "table.json"))


def test_building_can_be_cancelled():
    with pytest.raises(prefilter.Cancelled):
        prefilter.SamplingTable.build("lanczos3", progress=lambda fraction: False)


def test_a_missing_table_names_the_script_that_makes_it(monkeypatch, tmp_path):
    monkeypatch.setattr(sampling_table.resources, "files", lambda _: tmp_path)
    with pytest.raises(FileNotFoundError, match=r"'lanczos2-8\.json'.*scripts/sampling_tables\.py"):
        prefilter.SamplingTable.standard("lanczos2", 8)
