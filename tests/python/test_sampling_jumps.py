# SPDX-License-Identifier: GPL-3.0-or-later

"""Steps of samples where sets of texels change, against samples of every image of one texel."""

import numpy as np
import prefilter
import pytest

SIZE = 16
BESIDE = 1e-6
ALONG = np.array([step / 4 + side for step in range(5) for side in (-1e-4, 1e-4)])


@pytest.fixture(scope="module", params=["tent", "lanczos2"])
def case(request):
    """A table, and the levels of all images that are 1 at one texel and 0 elsewhere.

    The channels of a sample are then the weights of the image's texels.
    """
    table = prefilter.SamplingTable.build(request.param, texels=5)
    image = np.eye(SIZE * SIZE, dtype=np.float32).reshape(SIZE, SIZE, -1)
    return table, prefilter.sampling_levels(image, request.param, wrap="repeat")


def steps(case, cells, first, second):
    """The largest step for images from 0 to 1 from samples to others, of places in units of so many
    cells along the image, and mip values."""
    table, levels = case
    samples = []
    for x, y, mip in (first, second):
        x, y, mip = np.broadcast_arrays(x, y, mip)
        coordinates = np.stack([x.ravel(), y.ravel()], axis=1) / cells
        samples.append(
            prefilter.sample(levels, table, coordinates, 2.0 ** mip.ravel(), wrap="repeat")
        )
    return np.abs(samples[0] - samples[1]).sum(axis=1).max() / 2


def across_sides(case, cells, mips):
    """Along a cell's grid and diagonals, from one side to the other."""
    lines = []
    for step in range(4):
        lines.append((5 + step / 4, 5 + ALONG, BESIDE, 0))
        lines.append((5 + ALONG, 5 + step / 4, 0, BESIDE))
    lines.append((5 + ALONG, 5 + ALONG, BESIDE, -BESIDE))
    lines.append((5 + ALONG, 6 - ALONG, BESIDE, BESIDE))
    mips = np.array(mips)[:, None]
    return max(
        steps(case, cells, (x - dx, y - dy, mips), (x + dx, y + dy, mips)) for x, y, dx, dy in lines
    )


def across_mip(case, cells, mip):
    x, y = np.meshgrid(4 + ALONG, 5 + ALONG + 1e-5)
    return steps(case, cells, (x, y, mip - BESIDE), (x, y, mip + BESIDE))


def test_jumps_of_two_levels_are_those_of_samples(case):
    found = max(
        across_sides(case, SIZE / 2, [BESIDE, 0.5 - BESIDE, 0.5 + BESIDE, 1.0]),
        across_mip(case, SIZE / 2, 0.5),
        across_mip(case, SIZE / 4, 1.0),
    )
    assert found == pytest.approx(case[0].largest_jumps[2], rel=2e-3)


def test_jumps_of_one_level_are_those_of_samples(case):
    found = max(across_sides(case, SIZE, [0.0]), across_mip(case, SIZE / 2, 0.0))
    assert found == pytest.approx(case[0].largest_jumps[1], rel=2e-3)


def test_jumps_of_three_levels_are_those_of_filters_over_the_plane():
    """Every texel's channels are its filter at points of a plane of 6 x 6 cells that repeats."""
    points = (np.arange(96) + 0.5) / 16

    def filters(count):
        width = 6 / count
        away = (points - (np.arange(count)[:, None] + 0.5) * width + 3) % 6 - 3
        tent = np.maximum(1 - np.abs(away) / width, 0) / width / 16
        return np.einsum("yj,xi->yxji", tent, tent).reshape(count, count, -1).astype(np.float32)

    table = prefilter.SamplingTable.standard("tent", 8)
    case = (table, [filters(count) for count in (24, 12, 6, 3)])
    found = max(
        across_sides(case, 6, [1 + BESIDE, 1.5 - BESIDE, 1.5 + BESIDE, 2.0]),
        across_mip(case, 6, 1.5),
        across_mip(case, 3, 2.0),
    )
    assert found == pytest.approx(table.largest_jump, rel=0.02)
    assert table.largest_jumps[3] == table.largest_jump
