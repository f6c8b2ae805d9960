# SPDX-License-Identifier: GPL-3.0-or-later

"""Makes the pictures of docs/sampling.md: figures 6.1, 6.9, 6.11 and 6.12 of the dissertation.

usage: python3 sampling.py FOLDER        (with the package prefilter importable)

Leaves FOLDER/downsampled.png, zone_plate.png, checkerboard.png and probes.png, and prints how far
the pictures are from those of exact filters.
"""

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
import prefilter
from numpy.typing import NDArray
from resize import drawn
from sheets import encoded, sheet

Array = NDArray[np.floating]

SIDE = 1024
PLANE = 400, 240  # Pixels of figure 6.11.
PROBES = 280, 150  # Pixels of figure 6.12.


class Figure(NamedTuple):
    """Pictures in linear light, row 0 at the bottom, by method."""

    exact: Array
    approximate: dict[str, Array]

    def psnr(self, name: str) -> float:
        """The PSNR of a picture against the exact one, in dB."""
        return psnr(self.approximate[name], self.exact)


def psnr(found: Array, exact: Array) -> float:
    """The ratio of 1 to the root mean square difference, in dB."""
    difference = np.asarray(found, np.float64) - exact
    return float(-10 * np.log10(np.mean(difference**2)))


def main(folder: Path) -> None:
    """Makes all pictures."""
    image = drawn(SIDE)
    figure = downsampled(image, 89)
    cells = cells_of(figure, ["exact", "8 texels", "trilinear"], 4)
    small = prefilter.resize(image, 356, 356, filter="lanczos3")
    page(folder, "downsampled", [(shown(small), f"{SIDE} x {SIDE} pixels"), *cells], 2)

    figure = downsampled(zone_plate(SIDE), 300)
    names = ["trilinear", "4 texels", "8 texels", "exact"]
    page(folder, "zone_plate", cells_of(figure, names, 1), 2)

    names = ["exact", "one pixel of the image", "trilinear", "8 texels", "6 texels", "4 texels"]
    page(folder, "checkerboard", cells_of(checkerboard(), names, 1), 2)

    figure = probes(image)
    page(folder, "probes", cells_of(figure, ["exact", "trilinear", "8 texels"], 2), 1)


def page(folder: Path, name: str, cells: Sequence[tuple[Array, str]], columns: int) -> None:
    """Saves one picture, and prints its notes."""
    sheet(cells, columns).save(folder / f"{name}.png")
    print(f"{name}: {'; '.join(note for _, note in cells)}")


def cells_of(figure: Figure, names: Sequence[str], magnified: int) -> list[tuple[Array, str]]:
    """Pictures of a figure with their notes."""
    cells = []
    for name in names:
        picture = figure.exact if name == "exact" else figure.approximate[name]
        note = name if name == "exact" else f"{name}: {figure.psnr(name):.1f} dB"
        pixels = shown(picture)
        large = np.repeat(np.repeat(pixels, magnified, axis=0), magnified, axis=1)
        cells.append((large, note))
    return cells


def shown(light: Array) -> Array:
    """Encoded, three channels, rows from the top."""
    pixels = encoded(light)[::-1]
    return np.repeat(pixels, 3, axis=2) if pixels.shape[2] == 1 else pixels


def tables(filter: str) -> dict[str, prefilter.SamplingTable | str]:
    """Trilinear interpolation, and the standard tables."""
    found = {f"{n} texels": prefilter.SamplingTable.standard(filter, n) for n in (8, 6, 4)}
    return {"trilinear": "trilinear", **found}


def moved(
    image: Array, transform: Array, size: tuple[int, int], filter: str, wrap: str = "clamp"
) -> Figure:
    """An image by the filter itself, by tables and by trilinear interpolation."""
    approximate = {
        name: prefilter.resample(image, transform, *size, table=table, filter=filter, wrap=wrap)
        for name, table in tables(filter).items()
    }
    exact = prefilter.resample(image, transform, *size, exact=True, filter=filter, wrap=wrap)
    return Figure(exact, approximate)


def downsampled(image: Array, side: int, filter: str = "lanczos2") -> Figure:
    """Figures 6.1 and 6.9: a square image made smaller."""
    factor = image.shape[1] / side
    return moved(image, np.diag([factor, factor, 1.0]), (side, side), filter)


def zone_plate(side: int) -> Array:
    """Rings whose frequency grows with their radius, to a quarter of a cycle a texel at a side."""
    at = np.arange(side) + 0.5 - side / 2
    square = at**2 + at[:, None] ** 2
    return (0.5 + 0.5 * np.cos(np.pi * square / (2 * side)))[..., None].astype(np.float32)


def plane(texels: float, focal: float, size: tuple[int, int]) -> Array:
    """The transform of a plane that runs to the horizon, a little above the picture.

    Args:
        texels: How many a pixel of the lowest row spans, along the direction of view.
        focal: How far the eye is from the picture, in pixels.
        size: Of the picture, in pixels.
    """
    horizon = 1.05 * size[1]
    height = texels * horizon**2 / focal
    return np.array(
        [[height, 0, -height * size[0] / 2], [0, 0, height * focal], [0, -1, horizon]], np.float64
    )


def squares(side: int, count: int) -> Array:
    """A checkerboard; texels at edges have the means over them."""
    fine = (np.arange(side * count) // side % 2).astype(np.float64)
    stripes = 2 * fine.reshape(side, count).mean(axis=1) - 1
    return (0.5 + 0.5 * stripes * stripes[:, None])[..., None].astype(np.float32)


def checkerboard() -> Figure:
    """Figure 6.11: ten squares a side, repeated to the horizon, by isotropic tents."""
    image, transform = squares(SIDE, 10), plane(1.0, 300.0, PLANE)
    figure = moved(image, transform, PLANE, "tent", "repeat")
    nearest = places_of(transform, PLANE)[0].astype(int) % SIDE
    picked = image[nearest[:, 1], nearest[:, 0]].reshape(figure.exact.shape)
    return Figure(figure.exact, {"one pixel of the image": picked, **figure.approximate})


def places_of(transform: Array, size: tuple[int, int]) -> tuple[Array, Array]:
    """For each pixel, row by row: the position of its center, in texels, and the Jacobian."""
    x, y = np.meshgrid(np.arange(size[0]) + 0.5, np.arange(size[1]) + 0.5)
    homogeneous = np.stack([x.ravel(), y.ravel(), np.ones(x.size)], axis=1) @ transform.T
    depth = homogeneous[:, 2:]
    places = homogeneous[:, :2] / depth
    slopes = transform[None, :2, :2] - places[:, :, None] * transform[None, 2:, :2]
    return places, slopes / depth[:, :, None]


def probes(image: Array) -> Figure:
    """Figure 6.12: Feline, whose probes are Gaussians by trilinear interpolation or by tables."""
    places, jacobians = places_of(plane(5.0, 300.0, PROBES), PROBES)
    uvs = places / (image.shape[1], image.shape[0])
    levels = prefilter.sampling_levels(image, "gaussian", wrap="repeat")
    shape = (PROBES[1], PROBES[0], image.shape[2])
    approximate = {
        name: prefilter.sample_anisotropic(
            levels, table, uvs, jacobians, max_probes=16, wrap="repeat"
        ).reshape(shape)
        for name, table in tables("gaussian").items()
    }
    exact = prefilter.sample_ewa(image, uvs, jacobians, wrap="repeat")
    return Figure(exact.reshape(shape), approximate)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
