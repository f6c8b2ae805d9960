# SPDX-License-Identifier: GPL-3.0-or-later

"""Closed triangle meshes whose edges are known, for tests and benchmarks of sharp contours.

All are generated except fandisk, which is read. They fit into a cube of side 2 around the origin
and are rotated, each in its own way, unless the unrotated shape is asked for.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from . import meshes

Floats = NDArray[np.float64]
Loop = list[int]
SHARP_DEGREES = 30.0


@dataclass(frozen=True)
class Shape:
    """A closed mesh, oriented outward; `corners` are points where edges or tips have their ends."""

    name: str
    positions: Floats
    triangles: NDArray[np.int64]

    def moved(self, matrix: Floats, offset: Floats | float = 0.0) -> "Shape":
        """Turned and scaled, then moved."""
        return Shape(self.name, self.positions @ np.asarray(matrix).T + offset, self.triangles)


@dataclass
class Solid:
    """Builds a closed mesh of plane faces with holes, and of strips between loops of vertices."""

    points: list[Floats] = field(default_factory=list)
    triangles: list[tuple[int, int, int]] = field(default_factory=list)

    def loop(self, points: Floats) -> Loop:
        """Adds vertices, (n, 3)."""
        first = len(self.points)
        self.points.extend(np.asarray(points, float))
        return list(range(first, len(self.points)))

    def face(self, outer: Loop, holes: Sequence[Loop] = ()) -> None:
        """Adds a plane face; seen from outside `outer` is counterclockwise, `holes` clockwise."""
        corners = np.array([self.points[i] for i in outer])
        normal = np.cross(corners, np.roll(corners, -1, axis=0)).sum(axis=0)
        across = np.cross(np.eye(3)[np.abs(normal).argmin()], normal)
        axes = np.stack([across, np.cross(normal, across)])
        axes /= np.linalg.norm(axes, axis=1, keepdims=True)
        flat = {i: axes @ self.points[i] for ring in (outer, *holes) for i in ring}
        self.triangles.extend(_clip_ears(_bridged(list(outer), holes, flat), flat))

    def strip(self, low: Loop, high: Loop) -> None:
        """Joins loops of as many vertices; seen from outside, both run right, `high` above."""
        for k in range(len(low)):
            a, b = low[k], low[(k + 1) % len(low)]
            d, c = high[k], high[(k + 1) % len(low)]
            self.triangles += [(a, b, c), (a, c, d)]

    def prism(self, outline: Floats, low: float, high: float, holes: Sequence[Floats] = ()) -> None:
        """Adds an outline in x and y, counterclockwise, from one z to another; holes too."""
        rings = [np.asarray(ring, float) for ring in (outline, *(h[::-1] for h in holes))]
        bottom = [self.loop(at_height(ring, low)) for ring in rings]
        top = [self.loop(at_height(ring, high)) for ring in rings]
        for below, above in zip(bottom, top, strict=True):
            self.strip(below, above)
        self.face(top[0], top[1:])
        self.face(bottom[0][::-1], [ring[::-1] for ring in bottom[1:]])

    def named(self, name: str) -> Shape:
        """Returns the mesh, scaled and moved into a cube of side 2."""
        points = np.array(self.points)
        low, high = points.min(axis=0), points.max(axis=0)
        points = (points - (low + high) / 2) * (2 / (high - low).max())
        return Shape(name, points, np.array(self.triangles, np.int64))


def at_height(outline: Floats, z: float) -> Floats:
    """Points in the plane of x and y, lifted to z."""
    return np.column_stack([outline, np.full(len(outline), z)])


def circle(radius: float, count: int, x: float = 0.0, y: float = 0.0) -> Floats:
    """Points of a circle, counterclockwise."""
    angles = 2 * np.pi * np.arange(count) / count
    return np.column_stack([x + radius * np.cos(angles), y + radius * np.sin(angles)])


def _cross(a: Floats, b: Floats) -> Floats:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def _bridged(outer: Loop, holes: Sequence[Loop], flat: dict[int, Floats]) -> Loop:
    """Joins holes to the outline, each by a bridge that is passed both ways."""
    rest = [list(hole) for hole in holes]
    while rest:
        # The nearest pair of vertices of an open hole and the outline sees each other: only another
        # hole could be between, and it would be nearer.
        best = None
        ring = np.array([flat[i] for i in outer])
        for which, hole in enumerate(rest):
            points = np.array([flat[i] for i in hole])
            apart = ((ring[:, None] - points[None]) ** 2).sum(axis=-1)
            at, start = np.unravel_index(apart.argmin(), apart.shape)
            if best is None or apart[at, start] < best[0]:
                best = (apart[at, start], which, int(at), int(start))
        assert best is not None
        _, which, at, start = best
        hole = rest.pop(which)
        around = hole[start:] + hole[: start + 1]
        outer = outer[: at + 1] + around + outer[at:]
    return outer


def _clip_ears(ring: Loop, flat: dict[int, Floats]) -> list[tuple[int, int, int]]:
    made = []
    names = np.array(ring)
    points = np.array([flat[i] for i in ring])
    while len(names) > 3:
        before, after = np.roll(points, 1, axis=0), np.roll(points, -1, axis=0)
        turn = _cross(points - before, after - points)
        longest = np.zeros(len(points))
        for side in (points - before, after - points, before - after):
            longest = np.maximum(longest, (side**2).sum(axis=1))
        shape = np.where(turn > 1e-12, turn / (longest + 1e-300), -1.0)
        # The ears of the best shape first.
        for k in np.argsort(-shape):
            if shape[k] <= 0:
                raise ValueError("an outline crosses itself")
            own = np.roll(np.arange(len(names)), 1 - k)[:3]
            a, b, c = points[own]
            inside = ~np.isin(names, names[own])
            for first, second in ((a, b), (b, c), (c, a)):
                inside &= _cross(second - first, points - first) >= -1e-12
            if not inside.any():
                made.append(tuple(int(i) for i in names[own]))
                names, points = np.delete(names, k), np.delete(points, k, axis=0)
                break
        else:
            raise ValueError("an outline has no ear")
    made.append(tuple(int(i) for i in names))
    return made


def cube() -> Shape:
    """Twelve triangles."""
    solid = Solid()
    solid.prism(np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]), -1, 1)
    return solid.named("cube")


def _fan(solid: Solid, ring: Loop, middle: Sequence[float]) -> None:
    (tip,) = solid.loop(np.array([middle]))
    for a, b in zip(ring, ring[1:] + ring[:1], strict=True):
        solid.triangles.append((a, b, tip))


def cylinder(facets: int = 720) -> Shape:
    """Two circles as edges."""
    solid = Solid()
    low, high = (solid.loop(at_height(circle(0.8, facets), z)) for z in (-1, 1))
    solid.strip(low, high)
    _fan(solid, high, (0, 0, 1))
    _fan(solid, low[::-1], (0, 0, -1))
    return solid.named("cylinder")


def cone(facets: int = 720) -> Shape:
    """A circle as an edge, and a tip."""
    solid = Solid()
    ring = solid.loop(at_height(circle(0.8, facets), -1))
    _fan(solid, ring, (0, 0, 1))
    _fan(solid, ring[::-1], (0, 0, -1))
    return solid.named("cone")


def fandisk() -> Shape:
    """The model of that name, gathered beside the checkout.

    Raises:
        OSError: It is not there.
    """
    read = meshes.read(meshes.DATA / "fandisk.obj")
    solid = Solid(list(read.positions))
    shape = solid_of(solid, read.triangles, "fandisk")
    volume = np.linalg.det(shape.positions[shape.triangles]).sum()
    return shape if volume > 0 else Shape(shape.name, shape.positions, shape.triangles[:, ::-1])


def solid_of(solid: Solid, triangles: NDArray[np.int64], name: str) -> Shape:
    """Returns a solid with other triangles."""
    solid.triangles = [(int(a), int(b), int(c)) for a, b, c in triangles]
    return solid.named(name)


def joint(fingers: int = 6, slot: float = 0.06, facets: int = 128) -> Shape:
    """Fingers with slots between them, thin as two or three cells of 128, and two pins below."""
    solid = Solid()
    pitch = 2.0 / fingers
    comb = [(-1.0, -0.5)]
    for k in range(fingers):
        right = 1 - k * pitch
        left = right - pitch + (slot if k < fingers - 1 else 0)
        comb += [(right, 0.7), (left, 0.7)]
        if k < fingers - 1:
            comb += [(left, -0.1), (left - slot, -0.1)]
    comb.insert(1, (1.0, -0.5))
    outline = np.array(comb)
    front, back = (
        solid.loop(np.column_stack([outline[:, 0], np.full(len(outline), y), outline[:, 1]]))
        for y in (-0.6, 0.6)
    )
    pins = [circle(0.22, facets, x) for x in (-0.5, 0.45)]
    base = [solid.loop(at_height(pin, -0.5)) for pin in pins]
    ends = [solid.loop(at_height(pin, -0.95)) for pin in pins]
    for k in range(1, len(outline)):
        a, b = front[k], front[(k + 1) % len(outline)]
        c, d = back[(k + 1) % len(outline)], back[k]
        solid.face([b, a, d, c])
    solid.face([back[0], back[1], front[1], front[0]], base)
    for top, bottom in zip(base, ends, strict=True):
        solid.strip(bottom, top)
        solid.face(bottom[::-1])
    solid.face(front)
    solid.face(back[::-1])
    return solid.named("joint")


def bracket(facets: int = 96) -> Shape:
    """An L with bevels, two holes through one leg and a large one through the other."""
    solid = Solid()
    x = (-0.85, 1, 1, 0.9, -0.55, -0.7, -0.7, -0.8, -1, -1)
    z = (-1, -1, -0.8, -0.7, -0.7, -0.55, 0.9, 1, 1, -0.85)
    outline = np.column_stack([x, z])
    front, back = (
        solid.loop(np.column_stack([outline[:, 0], np.full(len(outline), y), outline[:, 1]]))
        for y in (-0.7, 0.7)
    )
    through = [circle(0.16, facets, 0.35, y) for y in (-0.35, 0.35)]
    lower = [solid.loop(at_height(hole, -1)) for hole in through]
    upper = [solid.loop(at_height(hole, -0.7)) for hole in through]
    large = circle(0.3, facets, 0, 0.25)
    left = solid.loop(np.insert(large, 0, -1, axis=1))
    right = solid.loop(np.insert(large, 0, -0.7, axis=1))
    # Keyed by side of the outline: the loops of its holes, clockwise as seen from outside.
    holes = {
        0: lower,
        3: [ring[::-1] for ring in upper],
        5: [right[::-1]],
        8: [left],
    }
    for k in range(len(outline)):
        a, b = front[k], front[(k + 1) % len(outline)]
        c, d = back[(k + 1) % len(outline)], back[k]
        solid.face([b, a, d, c], holes.get(k, ()))
    for low, high in zip(lower, upper, strict=True):
        solid.strip(low[::-1], high[::-1])
    solid.strip(left[::-1], right[::-1])
    solid.face(front)
    solid.face(back[::-1])
    return solid.named("bracket")


def gear(teeth: int = 18, facets: int = 96) -> Shape:
    """Trapezoid teeth around a bore with a groove for a key."""
    solid = Solid()
    profile = []
    for k in range(teeth):
        for share, radius in ((-0.27, 0.78), (-0.14, 1.0), (0.14, 1.0), (0.27, 0.78)):
            angle = 2 * np.pi * (k + share) / teeth
            profile.append((radius * np.cos(angle), radius * np.sin(angle)))
    solid.prism(np.array(profile), -0.25, 0.25, [_grooved(0.3, 0.42, 0.08, facets)])
    return solid.named("gear")


def _grooved(radius: float, end: float, half: float, facets: int) -> Floats:
    """A circle, counterclockwise, with a groove around the x axis that ends at x = `end`."""
    start = np.arcsin(half / radius)
    angles = np.linspace(start, 2 * np.pi - start, facets)
    ring = radius * np.column_stack([np.cos(angles), np.sin(angles)])
    return np.concatenate([ring, [(end, -half), (end, half)]])


def shaft(facets: int = 180) -> Shape:
    """Three steps, a bevel at each end, and a groove for a key along the widest."""
    solid = Solid()
    rings = [
        solid.loop(at_height(circle(radius, facets), z))
        for radius, z in ((0.24, -1), (0.3, -0.94), (0.3, -0.4))
    ]
    notched = _grooved(0.55, 0.4, 0.09, facets)
    low, high = (solid.loop(at_height(notched, z)) for z in (-0.4, 0.15))
    upper = [
        solid.loop(at_height(circle(radius, facets), z))
        for radius, z in ((0.36, 0.15), (0.36, 0.7), (0.2, 0.7), (0.2, 0.92), (0.12, 1))
    ]
    solid.face(rings[0][::-1])
    solid.strip(rings[0], rings[1])
    solid.strip(rings[1], rings[2])
    solid.face(low[::-1], [rings[2]])
    solid.strip(low, high)
    solid.face(high, [upper[0][::-1]])
    solid.strip(upper[0], upper[1])
    solid.face(upper[1], [upper[2][::-1]])
    solid.strip(upper[2], upper[3])
    solid.strip(upper[3], upper[4])
    solid.face(upper[4])
    return solid.named("shaft")


def plate(facets: int = 128) -> Shape:
    """A plate with bevelled sides and four countersunk holes."""
    solid = Solid()
    places = [(x, y) for x in (-0.6, 0.6) for y in (-0.35, 0.35)]
    sizes = ((-0.18, (1.0, 0.7)), (0.1, (1.0, 0.7)), (0.18, (0.92, 0.62)))
    levels = [
        solid.loop(at_height(np.array([(-x, -y), (x, -y), (x, y), (-x, y)]), z))
        for z, (x, y) in sizes
    ]
    holes = [
        [
            solid.loop(at_height(circle(radius, facets, x, y), z))
            for radius, z in ((0.1, -0.18), (0.1, 0.05), (0.2, 0.18))
        ]
        for x, y in places
    ]
    solid.strip(levels[0], levels[1])
    solid.strip(levels[1], levels[2])
    for bottom, neck, top in holes:
        solid.strip(bottom[::-1], neck[::-1])
        solid.strip(neck[::-1], top[::-1])
    solid.face(levels[2], [hole[2][::-1] for hole in holes])
    solid.face(levels[0][::-1], [hole[0] for hole in holes])
    return solid.named("plate")


def rotation(seed: int) -> Floats:
    """A turn that is the same for the same number."""
    turn, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    return turn * np.linalg.det(turn)


MAKERS: dict[str, Callable[[], Shape]] = {
    "cube": cube,
    "cylinder": cylinder,
    "cone": cone,
    "fandisk": fandisk,
    "joint": joint,
    "bracket": bracket,
    "gear": gear,
    "shaft": shaft,
    "plate": plate,
}


ROUND: dict[str, Callable[[int], Shape]] = {"cylinder": cylinder, "cone": cone}


def shape(name: str, *, turned: bool = True) -> Shape:
    """One of `MAKERS`, turned in its own way."""
    made = MAKERS[name]()
    return made.moved(rotation(list(MAKERS).index(name) + 1)) if turned else made


# Pairs and a number that places them so that hardly anything in union, intersection and difference
# is thinner than three cells of 128, or that close to something else, except beside edges.
PAIRS = (
    ("cube", "cube", 5),
    ("cube", "cylinder", 1),
    ("cylinder", "cone", 2),
    ("cylinder", "cylinder", 5),
    ("bracket", "cylinder", 3),
    ("fandisk", "cube", 0),
    ("gear", "cone", 1),
)


def pair(first: str, second: str, number: int = 0) -> tuple[Shape, Shape]:
    """Two of `MAKERS` that cut each other, turned and moved by a number."""
    random = np.random.default_rng([number, *map(list(MAKERS).index, (first, second))])
    placed = []
    for name, size in ((first, 1.0), (second, 0.7)):
        seed = int(random.integers(1 << 30))
        offset = random.uniform(-0.35, 0.35, 3)
        placed.append(MAKERS[name]().moved(size * rotation(seed), offset))
    return placed[0], placed[1]
