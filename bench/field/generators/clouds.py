# SPDX-License-Identifier: GPL-3.0-or-later

"""Points of known shapes as scanners and cameras write them, with their sentinels and axes."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bench.field.shapes import Shape

Floats = NDArray[np.float64]
_PLY_TYPES = {"<": "binary_little_endian", ">": "binary_big_endian"}


def write(stem: Path, random: np.random.Generator) -> Mapping[str, Any]:
    """Writes a cloud as PLY, XYZ, PCD or PTS."""
    kind = str(random.choice(["sphere", "torus", "room"]))
    sizes = {
        "sphere": (random.uniform(0.5, 2),),
        "torus": (1.0, random.uniform(0.25, 0.5)),
        "room": tuple(random.uniform(1, 4, 3)),
    }[kind]
    scale = float(random.choice([1, 1, 1, 0.001, 1000]))
    sizes = tuple(scale * size for size in sizes)
    # A room is seen from its middle, which is the origin.
    is_far = kind != "room" and scale >= 1 and random.random() < 0.3
    center = np.array([4.2e5, 5.4e6, 300.0]) if is_far else np.zeros(3)
    if kind != "room" and not is_far:
        center = scale * random.choice([0, 3, -5], 3)
    shape = Shape(kind, tuple(map(float, center)), sizes)
    count = int(random.integers(4_000, 30_000))
    points = shape.sample(count, random)
    spacing = float(np.sqrt(shape.area() / count))
    noise = float(random.choice([0, 0, 0.2])) * spacing
    points = points + noise * random.normal(size=points.shape)
    normals, must_say = _normals(shape, points, random)
    points, normals, more = _with_faults(points, normals, random)
    _write_file(stem, points, normals, random)
    return {
        "must_work": True,
        "must_say": [*must_say, *more],
        **{"shape": shape.written(), "spacing": spacing, "noise": noise},
    }


def _normals(
    shape: Shape, points: Floats, random: np.random.Generator
) -> tuple[Floats | None, list[str]]:
    normals = shape.outward(points)
    how = str(random.choice(["right", "right", "none", "zero", "partly zero", "long", "mixed"]))
    if how == "none":
        return None, []
    if how == "zero":
        return np.zeros_like(normals), [r"normal"]
    if how == "partly zero":
        normals[random.random(len(normals)) < 0.4] = 0
        return normals, [r"normal"]
    if how == "long":
        return 127 * normals, []
    if how == "mixed":
        return normals * np.where(random.random(len(normals)) < 0.5, 1, -1)[:, None], [r"normal"]
    return normals, []


def _with_faults(
    points: Floats, normals: Floats | None, random: np.random.Generator
) -> tuple[Floats, Floats | None, list[str]]:
    """Adds invalid points, or all points again as in a second scan."""
    fault = str(random.choice(["no", "no", "origin", "nan", "huge", "twice"]))
    count = len(points) // int(random.choice([3, 10, 100]))
    if fault == "no":
        return points, normals, []
    if fault == "twice":
        both = np.concatenate([points, points])
        return both, None if normals is None else np.concatenate([normals, normals]), []
    value = {"origin": 0.0, "nan": np.nan, "huge": 1e30}[fault]
    bad = np.full((count, 3), value)
    order = random.permutation(len(points) + count)
    points = np.concatenate([points, bad])[order]
    if normals is not None:
        normals = np.concatenate([normals, np.tile([0.0, 0, 1], (count, 1))])[order]
    return points, normals, [rf"\b{count:,}\b|\b{count}\b"]


def _write_file(
    stem: Path, points: Floats, normals: Floats | None, random: np.random.Generator
) -> None:
    rows = points if normals is None else np.hstack([points, normals])
    extension = str(random.choice([".ply", ".ply", ".xyz", ".pcd"]))
    if extension == ".ply":
        _write_ply(stem.with_suffix(".ply"), rows, random)
    elif extension == ".pcd":
        _write_pcd(stem.with_suffix(".pcd"), rows)
    else:
        np.savetxt(stem.with_suffix(".xyz"), rows, "%.12g")


def _write_ply(path: Path, rows: Floats, random: np.random.Generator) -> None:
    names = ("x", "y", "z", "nx", "ny", "nz")[: rows.shape[1]]
    order = str(random.choice(["<", ">", "ascii"]))
    form = _PLY_TYPES.get(order, "ascii")
    properties = "".join(f"property double {name}\n" for name in names)
    head = f"ply\nformat {form} 1.0\nelement vertex {len(rows)}\n{properties}end_header\n"
    with path.open("wb") as file:
        file.write(head.encode())
        if order == "ascii":
            np.savetxt(file, rows, "%.12g")
        else:
            file.write(rows.astype(f"{order}f8").tobytes())


def _write_pcd(path: Path, rows: Floats) -> None:
    names = ["x", "y", "z", "normal_x", "normal_y", "normal_z"][: rows.shape[1]]
    head = "\n".join(
        [
            "VERSION 0.7",
            f"FIELDS {' '.join(names)}",
            f"SIZE {' '.join(['8'] * len(names))}",
            f"TYPE {' '.join(['F'] * len(names))}",
            f"COUNT {' '.join(['1'] * len(names))}",
            f"WIDTH {len(rows)}",
            "HEIGHT 1",
            "VIEWPOINT 0 0 0 1 0 0 0",
            f"POINTS {len(rows)}",
            "DATA binary\n",
        ]
    )
    path.write_bytes(head.encode() + rows.astype("<f8").tobytes())
