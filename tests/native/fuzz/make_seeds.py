# SPDX-License-Identifier: GPL-3.0-or-later

"""Writes the seeds of the fuzzer: small whole files, one for each way through a reader.

usage: scripts/run python3 tests/native/fuzz/make_seeds.py
"""

import struct
import sys
import tempfile
from pathlib import Path

import numpy as np

TESTS = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(TESTS / "python"))

import prefilter  # noqa: E402
from prefilter import _native  # noqa: E402
from scan_writers import FORMATS, NORMALS, POINTS, pcd, ply  # noqa: E402

SEEDS = Path(__file__).with_name("seeds")
XYZ = [("float", name) for name in "xyz"]
INDICES = ("uchar", "int", "vertex_indices")
SPLATS = ("f_dc_0", "f_dc_1", "f_dc_2", "opacity", "scale_0", "scale_1", "scale_2")
SPLATS += ("rot_0", "rot_1", "rot_2", "rot_3")
PATHS = (
    "M1 2L3,4h5v-6H7V8z",
    "m1 1c1 2 3 4 5 6s1 2 3 4q1 2 3 4t5-6C1 2 3 4 5 6S1 2 3 4Q1 2 3 4T5 6",
    "M2 2a5 3 30 1 0 9 9A1.5e1.5 5 0 0120 20zM.5.5-.5-.5",
    "M0 0L20 20 0 20 20 0zM5 5h9v9h-9z",
    "M1e300 1e-300L-1e308 1e308 nan",
)


def _ply_seeds() -> dict[str, bytes]:
    points = POINTS.tolist()
    normals = np.hstack([POINTS, NORMALS]).tolist()
    grid = ("range_grid", [INDICES], [([0],), ([],), ([2],), ([1],)])
    sized = ("obj_info num_rows 2", "obj_info num_cols 2")
    names = [("double", n) for n in ("x", "y", "z", "nx", "ny", "nz")]
    seeds = {f"{form}": ply(form, [("vertex", XYZ, points)]) for form in FORMATS}
    for form in FORMATS:
        faces = ("face", [INDICES], [([0, 1, 2],), ([2, 1, 0, 1],)])
        seeds[f"faces-{form}"] = ply(form, [("vertex", names, normals), faces])
        seeds[f"grid-{form}"] = ply(form, [("vertex", XYZ, points), grid], lines=sized)
    splats = [row + [0.1] * len(SPLATS) for row in points]
    kinds = XYZ + [("float", name) for name in SPLATS]
    seeds["splats"] = ply("binary_little_endian", [("vertex", kinds, splats)])
    return seeds


def _pcd_seeds() -> dict[str, bytes]:
    fields = [("x", "f4", 1), ("y", "f4", 1), ("z", "f4", 1), ("rgb", "u4", 1), ("other", "i2", 2)]
    rows = [(*row, k, [k, -k]) for k, row in enumerate(POINTS.tolist())]
    return {data: pcd(data, fields, rows) for data in ("ascii", "binary", "binary_compressed")}


def _text_seeds() -> dict[str, dict[str, bytes]]:
    rows = "".join(" ".join(map(str, row)) + "\n" for row in POINTS.tolist())
    head = "1\n2\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"
    return {
        "text": {
            "xyz": rows.encode(),
            "named": ("x,y,z,nx,ny,nz,intensity\n" + "1,2,3,0,0,1,.5\n" * 3).encode(),
            "counted": ("3\n" + rows).encode(),
        },
        "ptx": {"ptx": (head + "1 2 3 0.5\n0 0 0 0\n").encode()},
        "obj": {"obj": b"# o\nv 1 2 3\nv 4 5 6 .1 .2 .3\nvn 0 0 1\nf 1//1 2//1 1//1\n"},
    }


def _levels() -> list[np.ndarray]:
    values = np.random.default_rng(1).integers(0, 255, (8, 8, 4), np.uint8)
    return [values[: 8 >> i, : 8 >> i].copy() for i in range(4)]


def _block_seeds() -> dict[str, bytes]:
    chance = np.random.default_rng(2)
    seeds = {}
    for number, (name, layout) in enumerate(_native.block_layouts().items()):
        columns, rows, size, _ = layout
        count = -(-8 // columns) * -(-8 // rows)
        seeds[name] = bytes([number, 8, 8]) + chance.bytes(count * size)
    return seeds


def _etc1s_seed(folder: Path) -> bytes:
    path = folder / "a.ktx2"
    prefilter.write_ktx2(path, _levels(), format="etc1s")
    data = path.read_bytes()
    # KTX 2.0, sections 3.1 and 4.1.
    level_count = struct.unpack_from("<I", data, 40)[0]
    global_at, global_size = struct.unpack_from("<2Q", data, 64)
    level_at = struct.unpack_from("<Q", data, 80)[0]
    book = data[global_at : global_at + global_size]
    endpoints, selectors, *sizes = struct.unpack_from("<2H4I", book)
    image = struct.unpack_from("<5I", book, 20)
    at, parts = 20 + 20 * level_count, []
    for size in sizes[:3]:
        parts.append(book[at : at + size])
        at += size
    level = data[level_at:]
    parts.append(level[image[1] : image[1] + image[2]])
    alpha = level[image[3] : image[3] + image[4]]
    head = struct.pack("<6H", endpoints, selectors, *map(len, parts)) + bytes([8, 8])
    return head + b"".join(parts) + alpha


def _zstd_seed() -> bytes:
    data = bytes(range(64)) * 8
    return struct.pack("<I", len(data)) + bytes(_native.supercompress(data, None))


def main() -> None:
    """Writes all seeds."""
    with tempfile.TemporaryDirectory() as name:
        etc1s = _etc1s_seed(Path(name))
    paths = {str(k): path.encode() for k, path in enumerate(PATHS)}
    drawn = {
        f"{k}-{bits}": bytes([bits]) + path
        for k, path in paths.items()
        for bits in (0x00, 0x07, 0x83, 0xB4, 0xC1)
    }
    seeds = {
        "ply": _ply_seeds(),
        "pcd": _pcd_seeds(),
        **_text_seeds(),
        "blocks": _block_seeds(),
        "etc1s": {"etc1s": etc1s},
        "zstd": {"zstd": _zstd_seed()},
        "path": paths,
        "drawn_path": drawn,
    }
    for target, files in seeds.items():
        folder = SEEDS / target
        folder.mkdir(parents=True, exist_ok=True)
        for file, data in files.items():
            (folder / file).write_bytes(data)


if __name__ == "__main__":
    main()
