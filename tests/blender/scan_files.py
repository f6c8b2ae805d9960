# SPDX-License-Identifier: GPL-3.0-or-later

"""Files of the points of a torus, in each format that the add-on reads."""

import gzip
import io
from pathlib import Path

import clouds
import numpy as np
from e57_files import Floating, e57
from las_files import las

COUNT = 3000


def write(path: Path) -> Path:
    """Writes a file of COUNT points in the format that its extension names."""
    positions, normals = clouds.torus(COUNT)
    extension = "".join(path.suffixes).lower()
    if extension in {".las", ".laz"}:
        steps = np.round(positions * 1000).astype(int)
        contents = las([{"xyz": row} for row in steps.tolist()], 6)
        path.write_bytes(contents if extension == ".las" else packed_las(contents, COUNT))
    elif extension == ".e57":
        names = ("cartesianX", "cartesianY", "cartesianZ")
        fields = {n: Floating(v.tolist()) for n, v in zip(names, positions.T, strict=True)}
        path.write_bytes(e57([(fields, "")]))
    elif extension in {".ply", ".ply.gz"}:
        contents = _ply(positions, normals).encode()
        path.write_bytes(contents if extension == ".ply" else gzip.compress(contents))
    elif extension == ".pcd":
        path.write_text(_pcd(positions))
    elif extension == ".obj":
        path.write_text("".join(f"v {_line(row)}\n" for row in positions))
    elif extension == ".pts":
        path.write_text(f"{COUNT}\n" + "".join(f"{_line(row)} 100\n" for row in positions))
    elif extension == ".ptx":
        path.write_text(_ptx(positions))
    elif extension == ".csv":
        path.write_text("x,y,z\n" + "".join(f"{_line(row, ',')}\n" for row in positions))
    elif extension in {".xyz", ".xyzn", ".asc", ".txt"}:
        clouds.file(path, positions, normals)
    else:
        raise ValueError(f"scan_files.write has no files that end in {extension}")
    return path


def packed_las(contents: bytes, count: int) -> bytes:
    """Compresses a LAS file's points of format 6 for a LAZ file, with the extension's lazrs."""
    import lazrs

    record = lazrs.LazVlr.new_for_compression(6, 0)
    data = record.record_data()
    data = data.tobytes() if hasattr(data, "tobytes") else bytes(data)
    head = bytearray(contents[:375])
    head[104] |= 0x80
    listed = bytes(2) + b"laszip encoded".ljust(16, b"\0")
    listed += (22204).to_bytes(2, "little") + len(data).to_bytes(2, "little") + bytes(32) + data
    head[96:100] = (375 + len(listed)).to_bytes(4, "little")
    head[100:104] = (1).to_bytes(4, "little")
    target = io.BytesIO(bytes(head) + listed)
    target.seek(0, io.SEEK_END)
    compressor = lazrs.LasZipCompressor(target, record)
    compressor.compress_many(np.frombuffer(contents[375:], np.uint8))
    compressor.done()
    return target.getvalue()


def _line(row: clouds.Array, between: str = " ") -> str:
    return between.join(f"{value:.9g}" for value in row)


def _ply(positions: clouds.Array, normals: clouds.Array) -> str:
    names = ("x", "y", "z", "nx", "ny", "nz")
    head = ["ply", "format ascii 1.0", f"element vertex {len(positions)}"]
    head += [*(f"property float {name}" for name in names), "end_header"]
    rows = np.concatenate([positions, normals], axis=1)
    return "\n".join([*head, *(_line(row) for row in rows), ""])


def _pcd(positions: clouds.Array) -> str:
    count = len(positions)
    head = ["VERSION 0.7", "FIELDS x y z", "SIZE 4 4 4", "TYPE F F F", "COUNT 1 1 1"]
    head += [f"WIDTH {count}", "HEIGHT 1", "VIEWPOINT 0 0 0 1 0 0 0", f"POINTS {count}"]
    return "\n".join([*head, "DATA ascii", *(_line(row) for row in positions), ""])


def _ptx(positions: clouds.Array) -> str:
    pose = ["0 0 0", "1 0 0", "0 1 0", "0 0 1"]
    matrix = ["1 0 0 0", "0 1 0 0", "0 0 1 0", "0 0 0 1"]
    rows = [f"{_line(row)} 0.5" for row in positions]
    return "\n".join([str(len(positions)), "1", *pose, *matrix, *rows, ""])
