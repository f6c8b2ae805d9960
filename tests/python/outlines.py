# SPDX-License-Identifier: GPL-3.0-or-later

"""Images of shapes by quadrature over the true shape, row by row.

At a height y the outlines cross at some x; the winding number between crossings decides what to
fill. The integral along x comes from the kernel's antiderivative, the one along y from Gauss
quadrature between all heights where something changes: where a curve turns, begins, intersects
another one or crosses a line at a multiple of 1/2, where kernels have their seams.
"""

import functools
from dataclasses import dataclass

import numpy as np
import prefilter
from kernels import KERNELS as FORMULAS
from kernels import RADII
from numpy.polynomial import Chebyshev, Polynomial

REACH = 3.0  # the widest filter's
NODES = 24


@dataclass(frozen=True, eq=False)
class Segment:
    """A Bezier curve, or with a weight a conic."""

    points: np.ndarray  # (degree + 1, 2)
    weight: float | None = None

    def split(self, at):
        """Splits Bezier curves only, by de Casteljau's scheme."""
        points, left, right = self.points, [], []
        while len(points):
            left.append(points[0])
            right.append(points[-1])
            points = (1.0 - at) * points[:-1] + at * points[1:]
        return Segment(np.array(left)), Segment(np.array(right[::-1]))

    def elevated(self):
        """The same curve, a degree higher."""
        count = len(self.points)
        share = (np.arange(count + 1) / count)[:, None]
        before = np.concatenate([self.points[:1], self.points])
        behind = np.concatenate([self.points, self.points[-1:]])
        return Segment(share * before + (1.0 - share) * behind)

    def reversed(self):
        return Segment(self.points[::-1].copy(), self.weight)

    def mapped(self, matrix):
        matrix = np.asarray(matrix, float)
        return Segment(self.points @ matrix[:, :2].T + matrix[:, 2], self.weight)


Contour = list[Segment]


def to_shape(contours, **options):
    """The same as a Shape."""
    shape = prefilter.Shape(**options)
    for contour in contours:
        shape.move_to(*contour[0].points[0])
        for segment in contour:
            if segment.weight is not None:
                middle, end = segment.points[1:]
                shape.conic_to(*middle, segment.weight, *end)
            elif len(segment.points) == 2:
                shape.line_to(*segment.points[1])
            else:
                shape.curve_to(*segment.points[1:])
        shape.close()
    return shape


def mapped(contours, matrix):
    return [[segment.mapped(matrix) for segment in contour] for contour in contours]


def reversed_contours(contours):
    return [[segment.reversed() for segment in contour[::-1]] for contour in contours]


def polygon(points):
    points = np.asarray(points, float)
    return [
        Segment(np.array([begin, end]))
        for begin, end in zip(points, np.roll(points, -1, 0), strict=True)
    ]


def blob(degree, seed, low, high, count=5, weights=None):
    """A wavy closed curve around a center, of segments of a degree, without self-intersections."""
    random = np.random.default_rng(seed)
    low, high = np.asarray(low, float), np.asarray(high, float)
    center, size = 0.5 * (low + high), 0.5 * (high - low)
    steps = count * degree
    # Control points at rising angles: each segment stays in its own sector.
    angles = 2 * np.pi * (np.arange(steps) + random.uniform(-0.3, 0.3, steps)) / steps
    radii = random.uniform(0.55, 1.0, steps)
    ring = center + size * np.stack([radii * np.cos(angles), radii * np.sin(angles)], 1)
    points = np.concatenate([ring, ring[:1]])
    weights = [None] * count if weights is None else weights
    return [
        Segment(points[degree * k : degree * (k + 1) + 1].copy(), weights[k]) for k in range(count)
    ]


def circle(center, radius):
    """A circle of four conics."""
    corners = np.array([(1, 0), (0, 1), (-1, 0), (0, -1), (1, 0)], float)
    return [
        Segment(
            np.asarray(center, float)
            + radius * np.array([corners[k], corners[k] + corners[k + 1], corners[k + 1]]),
            np.sqrt(0.5),
        )
        for k in range(4)
    ]


def _power_basis(values):
    """A polynomial in Bernstein's basis by powers of t."""
    degree = len(values) - 1
    one_less = Polynomial([1.0, -1.0])
    binomial, total = 1.0, Polynomial([0.0])
    for k, value in enumerate(values):
        total = total + value * binomial * one_less ** (degree - k) * Polynomial([0.0, 1.0]) ** k
        binomial = binomial * (degree - k) / (k + 1)
    return total


def _horner(coefficients, t):
    value = coefficients[-1]
    for coefficient in coefficients[-2::-1]:
        value = value * t + coefficient
    return value + 0.0 * t


class _Curve:
    """A segment as a ratio of polynomials."""

    def __init__(self, segment):
        points = segment.points
        weights = np.ones(len(points))
        if segment.weight is not None:
            weights[1] = segment.weight
        self.below = _power_basis(weights)
        self.above = [_power_basis(weights * points[:, axis]) for axis in (0, 1)]
        self._is_conic = segment.weight is not None

    def at(self, axis, t):
        above = _horner(self.above[axis].coef, t)
        return above / _horner(self.below.coef, t) if self._is_conic else above

    def _roots(self, polynomial):
        coefficients = np.trim_zeros(polynomial.coef, "b")
        if len(coefficients) < 2:
            return np.zeros(0)
        roots = Polynomial(coefficients).roots()
        # A double root may come as a pair that is slightly complex.
        roots = roots.real[np.abs(roots.imag) < 1e-6]
        return np.sort(roots[(roots > 0.0) & (roots < 1.0)])

    def turns(self, axis):
        above, below = self.above[axis], self.below
        return self._roots(above.deriv() * below - above * below.deriv())

    def passes(self, axis, value):
        return self._roots(self.above[axis] - value * self.below)


def _is_mixed(x, order):
    """Whether x decreases anywhere along axis 0 by more than rounding."""
    x = np.clip(np.take_along_axis(x, order, 0), None, 1e9)
    return (np.diff(x, axis=0) < -1e-9).any(0)


class Rows:
    """Crossings of contours with rows of nodes, for an image of a size and all filters.

    Attributes:
        y: (nodes,), heights.
        weights: (nodes,), the weights of the quadrature along y.
        x: (nodes, crossings), rising, and infinite behind the last one.
        winding: (contours, nodes, crossings), winding numbers to the right of each crossing.
    """

    def __init__(self, contours, width, height, nodes=NODES):
        self._pieces = []  # contour, curve, t range, y range
        cuts = set(np.arange(-REACH, height + REACH + 0.25, 0.5))
        low, high = -REACH, height + REACH
        segments = [(k, segment) for k, contour in enumerate(contours) for segment in contour]
        for contour, segment in segments:
            curve = _Curve(segment)
            places = [0.0, *curve.turns(1), 1.0]
            heights = [segment.points[0, 1], *curve.at(1, np.array(places[1:-1])), 0.0]
            heights[-1] = segment.points[-1, 1]
            for t0, t1, y0, y1 in zip(places, places[1:], heights, heights[1:], strict=False):
                if y0 != y1:
                    self._pieces.append((contour, curve, t0, t1, y0, y1))
            cuts.update(heights)
            if segment.weight is not None:
                # Heavy ones are quick near both ends, and turn as sharply as their control points.
                steps = np.arange(-2, np.log2(segment.weight) + 2)
                cuts.update(curve.at(1, 1 / (1 + 2.0 ** np.concatenate([steps, -steps]))))
            across = segment.points[:, 0]
            first, last = np.clip([across.min(), across.max()], -REACH, width + REACH)
            for line in np.arange(np.ceil(2 * first), np.floor(2 * last) + 1) / 2:
                cuts.update(curve.at(1, curve.passes(0, line)))
        cuts = np.array(sorted(cut for cut in cuts if low <= cut <= high))
        cuts = cuts[np.concatenate([[True], np.diff(cuts) > 1e-13])]
        cuts = self._with_meetings(cuts)
        # The square root of a height, and its cube root, become smooth: y - y0 is like s^6.
        points, weights = np.polynomial.legendre.leggauss(nodes)
        density = Polynomial([0, 0, 0, 0, 0, 1]) * Polynomial([1, -1]) ** 5 * 2772
        place, share = density.integ()(0.5 + 0.5 * points), density(0.5 + 0.5 * points)
        lengths = np.diff(cuts)[:, None]
        self.y = (cuts[:-1, None] + lengths * place).ravel()
        self.weights = (0.5 * lengths * weights * share).ravel()
        self.x, self.winding = self._crossings(self.y, len(contours))

    def _raw_crossings(self, y):
        x = np.full((len(self._pieces), len(y)), np.inf)
        for k, (_, curve, t0, t1, y0, y1) in enumerate(self._pieces):
            inside = (y > min(y0, y1)) & (y < max(y0, y1))
            heights = y[inside]
            low, high = np.full(len(heights), t0), np.full(len(heights), t1)
            for _ in range(45 if len(heights) else 0):
                middle = 0.5 * (low + high)
                is_low = (curve.at(1, middle) < heights) == (y1 > y0)
                low, high = np.where(is_low, middle, low), np.where(is_low, high, middle)
            x[k, inside] = curve.at(0, 0.5 * (low + high))
        return x

    def _with_meetings(self, cuts, samples=15):
        """Adds the heights where crossings change order."""
        share = (np.arange(samples) + 0.5) / samples
        y = cuts[:-1, None] + np.diff(cuts)[:, None] * share
        x = self._raw_crossings(y.ravel()).reshape(-1, *y.shape)
        order = np.argsort(x, axis=0, kind="stable")
        interval, k = np.nonzero(_is_mixed(x[..., 1:], order[..., :-1]))
        low, high, order = y[interval, k], y[interval, k + 1], order[:, interval, k]
        for _ in range(25 if len(low) else 0):
            middle = 0.5 * (low + high)
            is_high = _is_mixed(self._raw_crossings(middle), order)
            low, high = np.where(is_high, low, middle), np.where(is_high, middle, high)
        return np.unique(np.concatenate([cuts, low]))

    def _crossings(self, y, contours):
        x = self._raw_crossings(y)
        # The interior of a counter-clockwise contour ends at a rising piece.
        step = np.array([-1 if y1 > y0 else 1 for *_, y0, y1 in self._pieces], int)
        owner = np.array([contour for contour, *_ in self._pieces], int)
        order = np.argsort(x, axis=0, kind="stable")
        x = np.take_along_axis(x, order, 0)
        steps = np.where(np.isfinite(x), step[order], 0)
        most = max(1, int(np.isfinite(x).sum(0).max(initial=0)))
        x, steps, order = x[:most], steps[:most], order[:most]
        winding = [np.cumsum(steps * (owner[order] == k), axis=0).T for k in range(contours)]
        return x.T, np.array(winding)

    def inside(self, fill_rule="nonzero"):
        """(nodes, crossings), 1 where the span to the right of a crossing is filled, else 0."""
        whole = self.winding.sum(0)
        return (whole % 2 if fill_rule == "evenodd" else whole != 0).astype(float)


# Formula inside the support, and radius.
KERNELS = {"box": (np.ones_like, RADII["box"])} | {
    name: (formula, RADII[name]) for name, (formula, _) in FORMULAS.items()
}


class Kernel:
    """A kernel with an integral of 1; its integrals are accurate piecewise polynomials."""

    def __init__(self, name):
        self._formula, self.radius = KERNELS[name]
        # Integrals of the kernel and of x times the kernel: coefficients per piece, in powers of
        # the distance from the piece's start.
        self._integrals = []
        sums = np.zeros(2)
        for begin in np.arange(-self.radius, self.radius, 0.5):
            # Formulas have seams at multiples of 1/2; all but the box's are continuous there.
            value = Chebyshev.interpolate(lambda t, low=begin: self._formula(low + t), 14, [0, 0.5])
            value = value.convert(kind=Polynomial)
            both = [value.integ(k=sums[0]), (value * Polynomial([begin, 1])).integ(k=sums[1])]
            self._integrals.append([np.pad(it.coef, (0, 17 - len(it.coef))) for it in both])
            sums = np.array([it(0.5) for it in both])
        self._integrals.append([np.eye(17)[0] * total for total in sums])
        self._integrals = np.array(self._integrals) / sums[0]
        self.total = sums[0]

    def __call__(self, x):
        inside = np.abs(x) < self.radius
        return np.where(inside, self._formula(np.where(inside, x, 0.0)), 0.0) / self.total

    def integral(self, x, power=0):
        """The integral of u^power times the kernel, from -infinity to x."""
        behind = np.clip(2 * (np.asarray(x, float) + self.radius), 0, len(self._integrals) - 1)
        piece = behind.astype(int)
        return _horner(self._integrals[:, power].T[:, piece], 0.5 * (behind - piece))


@functools.cache
def kernel(name):
    return Kernel(name)


def _changes(values):
    """The negated step of the values at each crossing: integrals begin on the left."""
    return np.diff(values, axis=1, prepend=0.0) * -1.0


def image_of_rows(rows, width, height, name, values=None, color=(1.0, 0.0, 0.0)):
    """An image, (height, width), by a separable filter.

    Args:
        values: (nodes, crossings), values right of each crossing; None for `rows.inside()`.
        color: (c0, c_x, c_y): values are multiplied by c0 + c_x x + c_y y.
    """
    k = kernel(name)
    x_of, y_of = np.arange(width) + 0.5, np.arange(height) + 0.5
    change = _changes(rows.inside() if values is None else values)
    away = np.clip(rows.x, -1e6, 1e6)[:, :, None] - x_of
    level = np.einsum("qk,qki->qi", change, k.integral(away))
    by_y = k(rows.y[:, None] - y_of) * rows.weights[:, None]
    c0, c_x, c_y = color
    image = (by_y * c0).T @ level
    if c_y:
        image += (by_y * (c_y * rows.y[:, None])).T @ level
    if c_x:
        slope = np.einsum("qk,qki->qi", change, k.integral(away, 1)) + level * x_of
        image += (by_y * c_x).T @ slope
    return image


@functools.cache
def radial_kernel(radius):
    """The windowed jinc by the squared distance, with an integral of 1; J1 by Bessel's integral."""

    def value(square):
        r = np.sqrt(square)
        t = np.pi * (np.arange(2048) + 0.5) / 2048
        bessel = np.cos(t - np.pi * r[:, None] * np.sin(t)).mean(1)
        return bessel / (np.pi * r) * np.sinc(r / radius)

    fit = Chebyshev.interpolate(value, 30, [0.0, radius**2])
    return fit / (np.pi * fit.integ(lbnd=0.0)(radius**2))


def radial_values(rows, pixels, radius):
    """Means by a radial filter around pixels (x, y), (pixels,)."""
    value = radial_kernel(radius)
    change = _changes(rows.inside())
    points, weights = np.polynomial.legendre.leggauss(24)
    means = []
    for column, row in pixels:
        y = rows.y - (row + 0.5)
        near = np.abs(y) < radius
        y = y[near, None]
        half = np.sqrt(radius**2 - y**2)
        lengths = np.clip(rows.x[near] - (column + 0.5), -half, half) + half
        x = -half[..., None] + lengths[..., None] * (0.5 + 0.5 * points)
        along = 0.5 * lengths * (value(x**2 + y[..., None] ** 2) @ weights)
        means.append((change[near] * along).sum(1) @ rows.weights[near])
    return np.array(means)


def image_of_colors(rows, width, height, name, values, color, nodes=8):
    """An image, (height, width), of values times color(x, y), by a separable filter.

    The color must be smooth between the contours of `rows`.
    """
    k = kernel(name)
    lines = np.arange(-REACH, width + REACH + 0.25, 0.5)
    crossings = np.clip(rows.x, -REACH, width + REACH)
    breaks = np.sort(np.concatenate([crossings, np.tile(lines, (len(rows.y), 1))], 1), axis=1)
    lengths = np.diff(breaks)
    # The number of crossings to the left of each interval's middle.
    left = (rows.x[:, None, :] < (breaks[:, :-1] + 0.5 * lengths)[..., None]).sum(2)
    padded = np.concatenate([np.zeros((len(rows.y), 1)), values], 1)
    points, weights = np.polynomial.legendre.leggauss(nodes)
    x = breaks[:, :-1, None] + lengths[..., None] * (0.5 + 0.5 * points)
    y = np.broadcast_to(rows.y[:, None, None], x.shape)
    samples = np.take_along_axis(padded, left, 1)[..., None] * color(x, y)
    samples *= 0.5 * lengths[..., None] * weights
    by_y = k(rows.y[:, None] - (np.arange(height) + 0.5)) * rows.weights[:, None]
    columns = [(samples * k(x - (i + 0.5))).sum((1, 2)) for i in range(width)]
    return by_y.T @ np.stack(columns, 1)
