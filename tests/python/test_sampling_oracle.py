# SPDX-License-Identifier: GPL-3.0-or-later

"""Sampling tables, against equations 6.3 and 6.4 integrated by brute force over the plane."""

import numpy as np
import prefilter
import pytest
import sampling_oracle as oracle
from kernels import FILTERS

# Relative tolerances of errors, by the number of levels. Kernels are fitted to 1e-5; with two
# levels, texels enter the filter one by one, and the oracle's quadrature ignores the kinks.
TOLERANCES = {3: 2e-3, 2: 1e-2, 1: 1e-3}
# Below that an error is rounding.
NO_ERROR = 1e-9
LEVELS = (3, 2, 1)


@pytest.fixture(scope="module")
def small_tables():
    return {
        filter: prefilter.SamplingTable.build(
            filter, texels=5, subdomains=(2, 2, 1), ramp_weight=0.0, spectrum="white"
        )
        for filter in FILTERS
    }


@pytest.fixture(scope="module")
def quadratic():
    return prefilter.SamplingTable.build(
        "tent", texels=6, subdomains=(3, 3, 1), degree=2, ramp_weight=0.0, spectrum="white"
    )


def parts_of(table, levels):
    grid, _, slices = table.subdomains
    return oracle.subdomains(grid, slices, levels)


def rule(filter, levels):
    """Panels, and nodes in each."""
    if levels == 2 and filter == "tent":  # Where errors are small the kinks matter most.
        return 4, 4
    return (2, 3) if levels == 3 and filter != "box" else (2, 4)


def check_errors(table, levels):
    section = table.section(levels)
    parts = parts_of(table, levels)
    assert len(parts) == len(section.errors) == len(section.offsets)
    for part, found, trilinear, offsets, coefficients in zip(
        parts,
        section.errors,
        section.trilinear_errors,
        section.offsets,
        section.coefficients,
        strict=True,
    ):
        tolerance = {"rel": TOLERANCES[levels], "abs": NO_ERROR}
        expected = oracle.table_error(
            table.filter,
            table.degree,
            part,
            offsets.tolist(),
            coefficients,
            *rule(table.filter, levels),
        )
        assert found == pytest.approx(expected, **tolerance)
        expected = oracle.trilinear_error(table.filter, part, *rule(table.filter, levels))
        if part.grid % 2:  # Its weights have kinks inside.
            tolerance["rel"] = 1e-2
        assert trilinear == pytest.approx(expected, **tolerance)


@pytest.mark.parametrize("levels", LEVELS)
@pytest.mark.parametrize("filter", FILTERS)
def test_errors_are_those_of_the_filters_over_the_plane(small_tables, filter, levels):
    check_errors(small_tables[filter], levels)


@pytest.mark.parametrize("levels", LEVELS)
def test_errors_of_quadratic_weights(quadratic, levels):
    check_errors(quadratic, levels)


@pytest.mark.parametrize("levels", LEVELS)
@pytest.mark.parametrize("filter", FILTERS)
def test_no_weights_are_better_for_the_same_texels(small_tables, filter, levels):
    table = small_tables[filter]
    section = table.section(levels)
    for part, error, offsets, coefficients in zip(
        parts_of(table, levels), section.errors, section.offsets, section.coefficients, strict=True
    ):
        system = oracle.System(filter, 1, part, offsets.tolist(), *rule(filter, levels))
        best, least = system.solve(range(len(offsets)))
        assert error == pytest.approx(least, rel=TOLERANCES[levels], abs=NO_ERROR)
        if filter != "box" and np.linalg.cond(system.products) < 1e4:
            np.testing.assert_allclose(coefficients, best, rtol=0, atol=3e-3)


def test_ratios_are_of_the_whole_domain(small_tables):
    for table in small_tables.values():
        for levels in LEVELS:
            section = table.section(levels)
            # Every part of the folded cell stands for eight.
            total, trilinear = np.sum(section.errors), np.sum(section.trilinear_errors)
            if trilinear > 1e-12:
                assert table.error_ratios[levels] == pytest.approx(total / trilinear, rel=1e-9)
        assert table.error_ratio == table.error_ratios[3]


@pytest.mark.parametrize("filter", FILTERS)
def test_weights_sum_to_one_everywhere(small_tables, filter):
    table = small_tables[filter]
    for levels in LEVELS:
        sums = table.section(levels).coefficients.sum(axis=1)
        np.testing.assert_allclose(sums, np.eye(4)[[0] * len(sums)], rtol=0, atol=1e-7)


# Where all sets can be tried.
EXHAUSTIVE = [
    ("tent", 3, 2, (1, 1, 1)),
    ("tent", 2, 3, (2, 2, 1)),
    ("tent", 1, 3, (1, 1, 1)),
    ("box", 3, 3, (2, 2, 1)),
    ("box", 2, 3, (4, 4, 1)),
    ("bspline2", 2, 2, (2, 2, 1)),
    ("bspline2", 1, 3, (2, 2, 1)),
    ("gaussian", 2, 2, (2, 2, 1)),
    ("mitchell", 1, 2, (2, 2, 1)),
    ("lanczos2", 1, 3, (1, 1, 1)),
]


@pytest.mark.parametrize(("filter", "levels", "texels", "shape"), EXHAUSTIVE)
def test_the_best_of_all_sets_is_found(filter, levels, texels, shape):
    table = prefilter.SamplingTable.build(
        filter, texels=texels, subdomains=shape, ramp_weight=0.0, spectrum="white"
    )
    section = table.section(levels)
    for part, error, offsets in zip(
        parts_of(table, levels), section.errors, section.offsets, strict=True
    ):
        all_texels = oracle.candidates(filter, part)
        system = oracle.System(filter, 1, part, all_texels, *rule(filter, levels))
        best, least = system.best_set(texels)
        assert error == pytest.approx(least, rel=TOLERANCES[levels], abs=NO_ERROR)
        chosen = sorted(map(tuple, offsets.tolist()))
        expected = sorted(all_texels[i] for i in best)
        if chosen != expected:
            # Another set that is just as good.
            again = oracle.System(filter, 1, part, chosen, *rule(filter, levels)).solve(
                range(texels)
            )[1]
            assert again == pytest.approx(least, rel=TOLERANCES[levels], abs=NO_ERROR)


@pytest.mark.parametrize("filter", FILTERS)
def test_tables_of_the_standard_shape_are_within_the_errors_that_they_state(filter):
    table = prefilter.SamplingTable.build(filter, spectrum="white")
    assert (table.texels, table.subdomains, table.degree) == (8, (4, 4, 2), 1)
    for levels in LEVELS:
        section = table.section(levels)
        for index in (1, len(section.errors) - 1):
            part = parts_of(table, levels)[index]
            offsets, coefficients = section.offsets[index], section.coefficients[index]
            expected = oracle.table_error(
                filter,
                1,
                part,
                offsets.tolist(),
                coefficients,
                *(rule(filter, levels) if filter in ("box", "tent") else (1, 4)),
            )
            assert section.errors[index] == pytest.approx(
                expected, rel=TOLERANCES[levels], abs=NO_ERROR
            )


@pytest.mark.parametrize("levels", LEVELS)
@pytest.mark.parametrize("filter", ["tent", "lanczos2"])
def test_weights_that_heed_ramps_are_the_best_for_their_texels(filter, levels):
    table = prefilter.SamplingTable.build(
        filter, texels=5, subdomains=(2, 2, 1), ramp_weight=3.0, spectrum="white"
    )
    section = table.section(levels)
    (part,) = parts_of(table, levels)
    system = oracle.System(
        filter, 1, part, section.offsets[0].tolist(), *rule(filter, levels), ramp_weight=3.0
    )
    least = system.solve(range(5))[1]
    found = system.value(section.coefficients[0])
    assert found == pytest.approx(least, rel=1e-4, abs=NO_ERROR)
    # Tables that ignore the ramp weight are far from that.
    free = prefilter.SamplingTable.build(
        filter, texels=5, subdomains=(2, 2, 1), ramp_weight=0.0, spectrum="white"
    )
    offsets = free.section(levels).offsets[0].tolist()
    system = oracle.System(filter, 1, part, offsets, *rule(filter, levels), ramp_weight=3.0)
    if found > 1e-6:
        assert system.value(free.section(levels).coefficients[0]) > 1.01 * least


@pytest.mark.parametrize(("levels", "texels"), [(3, 2), (1, 3)])
def test_the_best_of_all_sets_that_heed_ramps_is_found(levels, texels):
    table = prefilter.SamplingTable.build(
        "tent", texels=texels, subdomains=(1, 1, 1), ramp_weight=3.0, spectrum="white"
    )
    (part,) = parts_of(table, levels)
    system = oracle.System(
        "tent", 1, part, oracle.candidates("tent", part), *rule("tent", levels), ramp_weight=3.0
    )
    least = system.best_set(texels)[1]
    chosen = [tuple(offset) for offset in table.section(levels).offsets[0].tolist()]
    again = oracle.System("tent", 1, part, chosen, *rule("tent", levels), ramp_weight=3.0).solve(
        range(texels)
    )[1]
    assert again == pytest.approx(least, rel=1e-4, abs=NO_ERROR)
