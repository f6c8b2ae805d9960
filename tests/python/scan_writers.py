"""Writers of scan files that share nothing with the library, and what they write."""

import struct
from pathlib import Path

import numpy as np

TYPES = {
    "char": "b",
    "int8": "b",
    "uchar": "B",
    "uint8": "B",
    "short": "h",
    "int16": "h",
    "ushort": "H",
    "uint16": "H",
    "int": "i",
    "int32": "i",
    "uint": "I",
    "uint32": "I",
    "float": "f",
    "float32": "f",
    "double": "d",
    "float64": "d",
}
FORMATS = ("ascii", "binary_little_endian", "binary_big_endian")


def ply(form, elements, *, lines=(), newline="\n"):
    """The bytes of a PLY file.

    `elements` are (name, properties, rows); a property is (type, name), or (type of the length,
    type, name) of a list; a row has a value, or a list, for each.
    """
    header = ["ply", f"format {form} 1.0", *lines]
    body = []
    order = ">" if form == "binary_big_endian" else "<"
    for name, properties, rows in elements:
        header.append(f"element {name} {len(rows)}")
        for each in properties:
            header.append("property " + ("list " if len(each) == 3 else "") + " ".join(each))
        for row in rows:
            words = []
            for each, value in zip(properties, row, strict=True):
                if len(each) == 3:
                    words += [(each[0], len(value)), *((each[1], one) for one in value)]
                else:
                    words.append((each[0], value))
            if form == "ascii":
                body.append(" ".join(repr(value) for _, value in words).encode() + newline.encode())
            else:
                body += [struct.pack(order + TYPES[kind], value) for kind, value in words]
    header.append("end_header")
    return "".join(line + newline for line in header).encode() + b"".join(body)


def write(folder: Path, name: str, contents: bytes) -> Path:
    path = folder / name
    path.write_bytes(contents)
    return path


def random_rows(types, count, seed=0):
    """Rows of values that each of the types holds exactly."""
    random = np.random.default_rng(seed)
    columns = []
    for kind in types:
        code = np.dtype(TYPES[kind])
        if code.kind == "f":
            columns.append(random.normal(size=count).astype(code).tolist())
        else:
            info = np.iinfo(code)
            columns.append(random.integers(info.min, info.max, count, endpoint=True).tolist())
    return list(zip(*columns, strict=True))
