# SPDX-License-Identifier: GPL-3.0-or-later

"""Sampling tables for natural images, and those whose samples have another filter than the levels.

Expected values come from double integrals over the plane by brute force, and from random images
with the correlation that the tables assume.
"""

import json
from itertools import product

import numpy as np
import prefilter
import pytest
import sampling_oracle as oracle
from kernels import FILTERS
from test_sampling_laws import dense

LEVELS = (3, 2, 1)
DEVIATIONS = 2.0 ** np.arange(-4, 5)  # of the Gaussians that correlations are sums of, in cells
PARTS = 48  # of a cell along the line
SMALL = {"texels": 5, "subdomains": (2, 2, 1), "ramp_weight": 0.0}


def along(filter, levels, places, center, width):
    """A filter's integrals over parts of the line, or the weights of texels of level 0."""
    center, width = np.asarray(center)[:, None], np.asarray(width)[:, None]
    if levels < 3:
        first, last = (int(np.floor(places[end] * levels)) for end in (0, -1))
        return oracle.taps(filter, center[:, 0] * levels, width[:, 0] * levels, first, last)
    if filter == "box":
        edges = np.append(places, places[-1] + 1 / PARTS) - 0.5 / PARTS
        return np.diff(np.clip((edges - center) / width + 0.5, 0.0, 1.0), axis=1)
    inside = (np.arange(4) - 1.5) / 4 / PARTS
    values = oracle.kernel(
        filter, (places[:, None] + inside - center[..., None]) / width[..., None]
    )
    return values.mean(axis=2) / width / PARTS


def places_of(filters, levels, texels):
    """Middles of parts of the line, or of texels of level 0, as far as filters reach."""
    reach = max(oracle.RADII[filter] for filter in filters)
    low = min([-reach] + [(i + 0.5 - reach) / 2**d for d, i in texels])
    high = max([1 + reach] + [(i + 0.5 + reach) / 2**d for d, i in texels])
    parts = PARTS if levels == 3 else levels
    return (np.arange(np.floor(low) * parts, np.ceil(high) * parts) + 0.5) / parts


class Plane:
    """Inner products of texels' and samples' filters over natural images."""

    def __init__(self, filter, target, levels, offsets):
        self.filters, self.levels, self.offsets = (filter, target), levels, offsets
        self.places, self.texels, self.blurred = [], [], []
        for axis in (1, 2):
            texels = [(offset[0], offset[axis]) for offset in offsets]
            places = places_of(self.filters, levels, texels)
            depth, index = np.array(texels).T
            found = along(filter, levels, places, (index + 0.5) / 2.0**depth, 1 / 2.0**depth)
            apart = (places[:, None] - places) / DEVIATIONS[:, None, None]
            self.places.append(places)
            self.texels.append(found)
            self.blurred.append(np.exp(-0.5 * apart**2))
        between = [t @ k @ t.T for t, k in zip(self.texels, self.blurred, strict=True)]
        self.products = (between[0] * between[1]).sum(axis=0)

    def with_sample(self, x, y, f):
        """Inner products of a sample's filter with all texels' filters, and with itself."""
        width = oracle.filter_width(self.levels, f)
        sides, own = 1.0, 1.0
        for axis, center in enumerate((x, y)):
            sample = along(self.filters[1], self.levels, self.places[axis], [center], [width])[0]
            blurred = self.blurred[axis] @ sample
            sides = sides * (blurred @ self.texels[axis].T)
            own = own * (blurred @ sample)
        return np.sum(sides, axis=0), np.sum(own)

    def error(self, weights, x, y, f):
        """The mean squared error of a sample of such images."""
        sides, own = self.with_sample(x, y, f)
        return own - 2 * weights @ sides + weights @ self.products @ weights


class System(oracle.System):
    """Equation 6.4 for natural images."""

    def __init__(self, filter, target, part, offsets, panels, count):
        plane = Plane(filter, target, part.levels, offsets)
        self.products = plane.products
        self.moments = np.zeros((4, 4))
        self.right = np.zeros((len(offsets), 4))
        self.square = 0.0
        for x, y, f, weight in part.nodes(panels, count):
            sides, own = plane.with_sample(x, y, f)
            found = oracle.terms(1, x, y, f)
            self.right += weight * sides[:, None] * found
            self.moments += weight * found[:, None] * found
            self.square += weight * own


def parts_of(table, levels):
    grid, _, slices = table.subdomains
    return oracle.subdomains(grid, slices, levels)


@pytest.mark.parametrize("levels", LEVELS)
@pytest.mark.parametrize(
    ("filter", "target"),
    [*((filter, None) for filter in FILTERS), ("tent", "box"), ("lanczos2", "tent")],
)
def test_errors_are_double_integrals_over_the_plane(filter, target, levels):
    table = prefilter.SamplingTable.build(filter, target=target, **SMALL)
    assert (table.filter, table.target, table.spectrum) == (filter, target or filter, "natural")
    section = table.section(levels)
    (part,) = parts_of(table, levels)
    offsets, coefficients = section.offsets[0].tolist(), section.coefficients[0]
    plane = Plane(filter, table.target, levels, offsets)
    error = trilinear = 0.0
    # If there are fewer levels, sums have kinks where a texel comes into a filter's reach.
    panels, trilinear_nodes = (1, 2) if levels == 3 else (2, 3)
    for x, y, f, weight in part.nodes(panels, 4):
        error += weight * plane.error(coefficients @ oracle.terms(1, x, y, f), x, y, f)
    for x, y, f, weight in part.nodes(2, trilinear_nodes):
        texels, weights = oracle.trilinear_texels(levels, x, y, f)
        trilinear += weight * Plane(filter, table.target, levels, texels).error(weights, x, y, f)
    assert section.errors[0] == pytest.approx(error, rel=2e-2, abs=1e-6)
    assert section.trilinear_errors[0] == pytest.approx(trilinear, rel=2e-2, abs=1e-6)
    # No other weights are better.
    least = System(filter, table.target, part, offsets, panels, 4).solve(range(len(offsets)))[1]
    assert error <= least * (1 + 1e-2) + 1e-6


@pytest.mark.parametrize(
    ("filter", "target", "levels", "texels"),
    [("tent", None, 3, 2), ("box", None, 2, 3), ("tent", "box", 3, 2), ("lanczos2", None, 1, 3)],
)
def test_the_best_of_all_sets_is_found(filter, target, levels, texels):
    arguments = SMALL | {"texels": texels, "target": target}
    table = prefilter.SamplingTable.build(filter, **arguments)
    section = table.section(levels)
    (part,) = parts_of(table, levels)
    candidates = oracle.candidates(filter, part)
    least = System(filter, table.target, part, candidates, 2, 4).best_set(texels)[1]
    assert section.errors[0] == pytest.approx(least, rel=2e-2, abs=1e-6)


def natural(size, cell, channels):
    """Repeated images of noise whose correlation is the sum of Gaussians that tables know."""
    far = (np.arange(size) + size // 2) % size - size // 2
    along = np.exp(-0.5 * (far / cell / DEVIATIONS[:, None]) ** 2)
    correlation = np.einsum("sy,sx->yx", along, along)
    power = np.fft.rfft2(correlation).real.clip(0.0)
    noise = np.random.default_rng(0).normal(size=(channels, size, size))
    images = np.fft.irfft2(np.fft.rfft2(noise) * np.sqrt(power), s=(size, size))
    return np.moveaxis(images, 0, 2).astype(np.float32)


@pytest.mark.parametrize(
    ("filter", "target"), [("tent", None), ("lanczos2", None), ("tent", "box")]
)
def test_errors_of_samples_of_natural_images_are_those_of_the_table(filter, target):
    image = natural(256, 8, 6)
    levels = prefilter.sampling_levels(image, filter, wrap="repeat", premultiplied=True)
    table = prefilter.SamplingTable.standard(filter, 6, target=target)
    coordinates = np.random.default_rng(1).random((500, 2))
    squares = dict.fromkeys(("table", "trilinear"), 0.0)
    shares, weights = np.polynomial.legendre.leggauss(2)
    for slice, (share, weight) in product((0, 1), zip(shares, weights, strict=True)):
        scale = 2.0 ** (2 + (slice + (share + 1) / 2) / 2)
        expected = dense(image, table.target, coordinates, scale)
        for name, chosen in (("table", table), ("trilinear", "trilinear")):
            found = prefilter.sample(levels, chosen, coordinates, scale, wrap="repeat")
            squares[name] += weight / 4 * np.mean((found - expected) ** 2)
    section = table.section(3)
    # Texels of the image are an eighth of a cell: finer than the narrowest correlation.
    assert squares["table"] == pytest.approx(8 * section.errors.sum(), rel=0.15)
    assert squares["trilinear"] == pytest.approx(8 * section.trilinear_errors.sum(), rel=0.15)


def shapes(size):
    """Overlapping disks of random brightness, with edges one texel wide; and a gradient."""
    random = np.random.default_rng(5)
    y, x = np.mgrid[:size, :size] + 0.5
    image = 0.5 + 0.3 * x / size - 0.2 * y / size
    for _ in range(200):
        across = size * random.uniform(0.01, 0.12)
        center, value = random.uniform(0, size, 2), random.random()
        inside = np.clip(across - np.hypot(x - center[0], y - center[1]) + 0.5, 0.0, 1.0)
        image = image * (1 - inside) + inside * value
    return image[..., None].astype(np.float32)


def psnr(levels, table, coordinates, scales, image, target, bias=0.0):
    """Over scales, against the filter itself."""
    squares = []
    for scale in scales:
        found = prefilter.sample(levels, table, coordinates, scale * 2.0**bias, wrap="repeat")
        squares.append(np.mean((found - dense(image, target, coordinates, scale)) ** 2))
    return -10 * np.log10(np.mean(squares))


@pytest.mark.parametrize(
    ("filter", "target"), [("tent", None), ("lanczos2", None), ("box", None), ("tent", "box")]
)
def test_no_bias_of_trilinear_interpolation_is_as_close_on_edges_and_gradients(filter, target):
    image = shapes(256)
    levels = prefilter.sampling_levels(image, filter, wrap="repeat")
    table = prefilter.SamplingTable.standard(filter, 8, target=target)
    white = prefilter.SamplingTable.build(filter, target=target, spectrum="white")
    coordinates = np.random.default_rng(2).random((600, 2))
    rest = coordinates, 2.0 ** np.array([1.2, 1.7, 2.0, 2.4, 2.9]), image, table.target
    found = psnr(levels, table, *rest)
    biased = [psnr(levels, "trilinear", *rest, bias) for bias in np.arange(0, -1.6, -0.25)]
    assert found > max(biased) + 0.5
    assert found > psnr(levels, white, *rest) + 0.3


def test_files_of_before_there_was_a_choice_are_of_white_tables(tmp_path):
    path = tmp_path / "table.json"
    table = prefilter.SamplingTable.build("tent", target="box", **SMALL)
    table.save(path)
    again = prefilter.SamplingTable.load(path)
    assert (again.spectrum, again.target, repr(again)) == ("natural", "box", repr(table))
    members = json.loads(path.read_text())
    del members["spectrum"], members["target"]
    path.write_text(json.dumps(members))
    old = prefilter.SamplingTable.load(path)
    assert (old.spectrum, old.filter, old.target) == ("white", "tent", "tent")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"spectrum": "pink"}, "spectrum: 'pink' is not one of natural, white"),
        ({"target": "cubic"}, "target: 'cubic' is not one of box, tent"),
        ({"target": 3}, "target: 3"),
    ],
)
def test_what_is_no_spectrum_or_target_is_refused(arguments, message):
    with pytest.raises(ValueError, match=message):
        prefilter.SamplingTable.build("tent", **arguments)


def test_targets_without_a_standard_table_are_refused():
    with pytest.raises(ValueError, match="target: 'mitchell' with levels of 'tent'"):
        prefilter.SamplingTable.standard("tent", target="mitchell")


def test_shaders_name_the_target_and_the_filter_of_the_levels():
    table = prefilter.SamplingTable.standard("tent", 4, target="box")
    for source in (table.glsl(), table.hlsl(), table.osl()):
        assert '"box": 4 texels' in source
        assert 'filter="tent")' in source
